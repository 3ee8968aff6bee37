#pragma once
/// What the cell remembers between pictures: which places of the trays are taken, which parts on the table it gave up
/// on, and which rejections were counted already. Pure bookkeeping.

#include <Eigen/Core>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace pickcell::cell {

/// Places of every kind's pattern. A place is reserved before its pick is handed over and freed only when it is certain
/// that nothing was put there.
class Tray {
 public:
  /// sizes: places of each kind's pattern, in the order of the recipe.
  explicit Tray(std::vector<int> sizes) : sizes_(std::move(sizes)), taken_(sizes_.size()) {}

  void take(std::size_t kind, int slot) { taken_.at(kind).insert(slot); }
  void free(std::size_t kind, int slot) { taken_.at(kind).erase(slot); }
  [[nodiscard]] bool full(std::size_t kind) const {
    return taken_.at(kind).size() >= static_cast<std::size_t>(sizes_.at(kind));
  }
  /// Empty trays stand where full ones stood: whoever starts the cell again has put them there.
  void empty_full_ones() {
    for (std::size_t kind = 0; kind < sizes_.size(); ++kind)
      if (full(kind)) taken_[kind].clear();
  }
  [[nodiscard]] const std::vector<std::set<int>>& taken() const { return taken_; }

 private:
  std::vector<int> sizes_;
  std::vector<std::set<int>> taken_;
};

/// Things that stay where they are while nothing moves.
class StandingParts {
 public:
  /// One more failed pick of this model at this place of the base frame.
  void note_attempt(const std::string& model, const Eigen::Vector2d& p_m);
  [[nodiscard]] int attempts(const std::string& model, const Eigen::Vector2d& p_m) const;
  /// True the first time: a part that is seen again in the next picture is not counted again.
  bool first_rejection(const std::string& model, const std::string& code, const Eigen::Vector2d& p_px);
  /// The belt moved: everything lies elsewhere.
  void forget() {
    attempts_.clear();
    rejected_.clear();
  }

 private:
  struct Place {
    Eigen::Vector2d p;
    int count = 0;
  };
  using Places = std::map<std::string, std::vector<Place>>;
  static Place& find(std::vector<Place>& places, const Eigen::Vector2d& p, double radius);

  Places attempts_;  ///< by model, metres
  Places rejected_;  ///< by model and code, pixels
};

}  // namespace pickcell::cell
