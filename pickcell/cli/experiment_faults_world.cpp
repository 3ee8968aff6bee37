#include "pickcell/cli/experiment_faults_world.hpp"

#include <algorithm>
#include <cmath>

namespace pickcell::cli {

int SoakTable::part_at(const Eigen::Vector3d& tool_mm) {
  const Eigen::Vector3d from = tool_mm - place_mm(0);
  const auto column = std::lround(from.x() / kPitch_mm), row = std::lround(from.y() / kPitch_mm);
  if (column < 0 || column >= kColumns || row < 0 || row >= kMost / kColumns) return -1;
  const int part = static_cast<int>(row) * kColumns + static_cast<int>(column);
  constexpr double kNear_mm = 0.1;
  return (tool_mm - place_mm(part)).norm() < kNear_mm ? part : -1;
}

core::Transform<core::Base, core::Tool> SoakTable::above(const Eigen::Vector3d& place_mm) {
  Eigen::Matrix3d down;
  down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  return {down, place_mm * 1e-3};
}

void SoakWorld::output_changed(int n, bool on, const core::Transform<core::Base, core::Tool>& T_base_tool,
                               core::TimePoint) {
  if (n != sim::kGripperOutput) return;
  const std::lock_guard lock(mutex_);
  if (!on) {
    holds_ = false;
    return;
  }
  const int part = SoakTable::part_at(T_base_tool.translation_m() * 1e3);
  if (part < 0 || static_cast<std::size_t>(part) >= gripped_.size()) {
    ++strays_;
    return;
  }
  const bool there = std::find(away_.begin(), away_.end(), part) == away_.end();
  holds_ = there && gripped_[static_cast<std::size_t>(part)] == 0;
  ++gripped_[static_cast<std::size_t>(part)];
}

bool SoakWorld::input(int n, core::TimePoint) {
  const std::lock_guard lock(mutex_);
  return n == sim::kGripSensorInput && holds_;
}

void SoakWorld::take_away(int part) {
  const std::lock_guard lock(mutex_);
  away_.push_back(part);
}

void SoakWorld::empty_the_gripper() {
  const std::lock_guard lock(mutex_);
  holds_ = false;
}

std::vector<int> SoakWorld::grips() const {
  const std::lock_guard lock(mutex_);
  return gripped_;
}

int SoakWorld::strays() const {
  const std::lock_guard lock(mutex_);
  return strays_;
}

}  // namespace pickcell::cli
