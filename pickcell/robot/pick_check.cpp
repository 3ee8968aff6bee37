#include "pickcell/robot/pick_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "pickcell/core/units.hpp"

namespace pickcell::robot {

using core::ErrorCode;

namespace {

std::string tenths(double value) {
  char text[64];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

auto unsafe(const char* which, std::string why, std::string remedy) {
  return core::failure(ErrorCode::safety, std::string(which) + " pose", std::move(why), std::move(remedy));
}

core::Status check_pose(const char* which, const core::Transform<core::Base, core::Tool>& T_base_tool,
                        const PickLimits& limits) {
  const Eigen::Matrix3d r = T_base_tool.rotation();
  const Eigen::Vector3d t_mm = T_base_tool.translation_m() * 1e3;
  if (!t_mm.allFinite() || !r.allFinite()) return unsafe(which, "not finite", "check calibration and recipe");
  if ((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() > 1e-6 || r.determinant() < 0)
    return unsafe(which, "not a rotation", "check calibration and recipe");
  const double tilt_deg = core::deg_from_rad(std::acos(std::clamp(-r(2, 2), -1.0, 1.0)));
  if (tilt_deg > limits.max_tilt_deg)
    return unsafe(which,
                  "the tool is tilted by " + tenths(tilt_deg) + " deg, allowed are " + tenths(limits.max_tilt_deg),
                  "check the calibration of the work plane");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double lowest = t_mm(static_cast<Eigen::Index>(axis));
    const double highest = axis == 2 ? lowest + limits.approach_mm : lowest;
    if (lowest < limits.box_min_mm[axis] || highest > limits.box_max_mm[axis]) {
      const std::string approach = axis == 2 ? " (with the approach up to " + tenths(highest) + ")" : "";
      return unsafe(which,
                    std::string(1, "xyz"[axis]) + " = " + tenths(lowest) + " mm" + approach + " is outside " +
                        tenths(limits.box_min_mm[axis]) + " .. " + tenths(limits.box_max_mm[axis]) + " mm",
                    "check recipe and workspace box");
    }
  }
  return {};
}

}  // namespace

core::Status check_pick(const picks::Pick& pick, const PickLimits& limits) {
  using Limits = std::numeric_limits<std::int16_t>;
  if (pick.part_class < Limits::min() || pick.part_class > Limits::max())
    return core::failure(ErrorCode::usage, "part class " + std::to_string(pick.part_class), "outside -32768 .. 32767");
  if (auto grasp = check_pose("grasp", pick.T_base_grasp, limits); !grasp) return grasp;
  return check_pose("place", pick.T_base_place, limits);
}

}  // namespace pickcell::robot
