#pragma once
/// The truth of the fault soak: a table of numbered parts, a gripper with its sensor, and who was gripped how often.

#include <Eigen/Core>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/core/transform.hpp"
#include "pickcell/sim/plant.hpp"

namespace pickcell::cli {

/// Part n lies on a lattice, so that a grip's place says which part it was.
struct SoakTable {
  static constexpr int kColumns = 200;
  static constexpr double kPitch_mm = 0.5;
  static constexpr int kMost = 200 * 200;

  [[nodiscard]] static Eigen::Vector3d place_mm(int part) {
    return {380 + kPitch_mm * (part % kColumns), -200 + kPitch_mm * (part / kColumns), -50};
  }
  /// -1: nothing lies there.
  [[nodiscard]] static int part_at(const Eigen::Vector3d& tool_mm);
  [[nodiscard]] static core::Transform<core::Base, core::Tool> above(const Eigen::Vector3d& place_mm);
};

/// Thread-safe.
class SoakWorld final : public sim::Plant {
 public:
  explicit SoakWorld(int parts) : gripped_(static_cast<std::size_t>(parts), 0) {}

  void output_changed(int n, bool on, const core::Transform<core::Base, core::Tool>& T_base_tool,
                      core::TimePoint t) override;
  [[nodiscard]] bool input(int n, core::TimePoint t) override;
  void contact_written(int, bool, core::TimePoint) override {}

  /// This part is not there: the grip will be empty.
  void take_away(int part);
  /// The person takes what is in the gripper.
  void empty_the_gripper();
  /// How often the gripper closed where this part lay.
  [[nodiscard]] std::vector<int> grips() const;
  /// Grips where nothing ever lay.
  [[nodiscard]] int strays() const;

 private:
  mutable std::mutex mutex_;
  std::vector<int> gripped_;
  std::vector<int> away_;
  int strays_ = 0;
  bool holds_ = false;
};

}  // namespace pickcell::cli
