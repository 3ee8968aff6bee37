#pragma once
/// What the cell remembers between pictures: which places of the trays are taken, which parts on the table it gave up
/// on, and which rejections were counted already. Pure bookkeeping.

#include <Eigen/Core>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"

namespace pickcell::cell {

/// A place that holds a part, or may hold one.
struct FilledPlace {
  std::string model;
  int slot = 0;
};

/// What outlives the process of the trays. One thread at a time. Errors: unreadable (disk full, damaged).
class TrayRecord {
 public:
  virtual ~TrayRecord() = default;
  /// Places that were filled since the tray of that model was last exchanged; an unknown outcome and one that is open
  /// count as filled.
  [[nodiscard]] virtual core::Result<std::vector<FilledPlace>> filled() = 0;
  /// An empty tray stands there from now on.
  [[nodiscard]] virtual core::Status exchanged(const std::string& model) = 0;
};

/// Places of every kind's pattern. A place is reserved before its pick is handed over and freed only when it is certain
/// that nothing was put there.
class Tray {
 public:
  /// sizes: places of each kind's pattern, in the order of the recipe.
  explicit Tray(std::vector<int> sizes) : sizes_(std::move(sizes)), taken_(sizes_.size()) {}

  void take(std::size_t kind, int slot) { taken_.at(kind).insert(slot); }
  void free(std::size_t kind, int slot) { taken_.at(kind).erase(slot); }
  void forget() {
    for (auto& places : taken_) places.clear();
  }
  [[nodiscard]] bool full(std::size_t kind) const {
    return taken_.at(kind).size() >= static_cast<std::size_t>(sizes_.at(kind));
  }
  /// Empty trays stand where full ones stood: whoever starts the cell again has put them there. Says which.
  [[nodiscard]] std::vector<std::size_t> empty_full_ones() {
    std::vector<std::size_t> emptied;
    for (std::size_t kind = 0; kind < sizes_.size(); ++kind) {
      if (!full(kind)) continue;
      taken_[kind].clear();
      emptied.push_back(kind);
    }
    return emptied;
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
