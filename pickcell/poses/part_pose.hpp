#pragma once
/// A part in the robot's frame.

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "pickcell/core/clock.hpp"
#include "pickcell/core/transform.hpp"

namespace pickcell::poses {

/// A grasp of this part, tool Z down (Rx = 180, Ry = 0).
struct GraspPose {
  core::Transform<core::Base, core::Tool> T_base_tool;
  /// T_part_tool: where the gripper sits on the part; the place pose of the part turns it into a place pose of the
  /// tool.
  core::Transform<core::Part, core::Tool> T_part_tool;
  bool sym180 = false;
};

struct PartPose {
  std::string model;
  int model_index = 0;
  core::Transform<core::Base, core::Part> T_base_part;
  std::vector<GraspPose> grasps;
  std::vector<Eigen::Vector2d> outline_m;  ///< the template's rectangle in base x, y; counter-clockwise or clockwise
  double score = 0;
  std::vector<double> ambiguous_deg;
  /// Of (x, y, rotation about the plane's normal) in base, m and rad: match and calibration together.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::uint64_t frame_sequence = 0;
  core::TimePoint exposed{};
  std::uint64_t detection_id = 0;  ///< unique in a run; ties the HMI's overlay, the pick and its record together
};

}  // namespace pickcell::poses
