#pragma once
/// Which parts to take, in which order, and where to put them; and why not the others.

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "pickcell/core/transform.hpp"
#include "pickcell/picks/pick.hpp"
#include "pickcell/picks/place_pattern.hpp"
#include "pickcell/poses/part_pose.hpp"

namespace pickcell::picks {

/// Poses of the tool that the arm may be sent to, base frame.
struct WorkspaceBox {
  Eigen::Vector3d min_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d max_m = Eigen::Vector3d::Zero();
  [[nodiscard]] bool contains(const Eigen::Vector3d& p_base) const {
    return (p_base.array() >= min_m.array()).all() && (p_base.array() <= max_m.array()).all();
  }
};

/// One kind of part in the recipe.
struct PartPlan {
  std::string model;
  int part_class = 0;  ///< recipe number for the robot's job
  PlacePattern place;
};

struct PlannerSettings {
  std::vector<PartPlan> parts;  ///< in the order of the models that are searched for (PartPose::model_index)
  WorkspaceBox box;
  double grasp_tolerance_m = 0.003;     ///< the gripper still closes on the part within this
  double grasp_tolerance_rad = 0.0873;  ///< and within this (5 deg)
  double certainty = 3;                 ///< so many standard deviations must lie within the tolerance
  double merge_overlap = 0.5;           ///< outlines that share more than this part of the smaller one are one part
  double gripper_length_m = 0.0;        ///< footprint of the open gripper along the tool's X axis; 0: not checked
  double gripper_width_m = 0.0;         ///< and across
  double approach_m = 0.080;            ///< height above grasp and place that must lie inside the box too
};

enum class RefusalReason { duplicate, ambiguous, uncertain, no_grasp, box, clearance, pattern_full, unknown_part };
[[nodiscard]] const char* name(RefusalReason reason);

/// A part that is not picked from this picture, and why, in words with figures.
struct Refusal {
  std::uint64_t detection_id = 0;
  RefusalReason reason = RefusalReason::box;
  std::string why;
};

struct Plan {
  std::vector<Pick> picks;  ///< in the order they should be made: shortest way from grasp to place first
  std::vector<Refusal> refusals;
};

/// Pure function of the parts seen and the slots taken. taken[i] holds the taken slots of settings.parts[i].
/// A pick's place pose is the wanted pose of the part times the measured place of the grasp on the part, so an
/// off-centre grasp still puts the part where it belongs.
[[nodiscard]] Plan plan_picks(std::span<const poses::PartPose> parts, const PlannerSettings& settings,
                              const std::vector<std::set<int>>& taken);

}  // namespace pickcell::picks
