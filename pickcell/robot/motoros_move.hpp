#pragma once
/// Moves over MotoROS: planned on the PC, checked as a whole before the first byte is sent, streamed point by point.
/// For commissioning; picks go through the taught job. Source: docs/yaskawa-protocols.md 3.2.

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "pickcell/core/clock.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/robot/arm_geometry.hpp"
#include "pickcell/robot/motoros_client.hpp"

namespace pickcell::robot {

/// What no trajectory may leave. Limits of the axes come from the arm.
struct MotoRosLimits {
  const ArmGeometry* arm = nullptr;  ///< must be set
  core::Transform<core::Flange, core::Tool> T_flange_tool;
  std::array<double, 3> box_min_mm{}, box_max_mm{};  ///< tool centre point in the base frame, all the way
  double speed_fraction = 0.05;                      ///< of the greatest speeds of the axes
  double line_speed_mm_s = 50;                       ///< of the tool centre point
};

/// Rest to rest, all axes together: 10 u^3 - 15 u^4 + 6 u^5, a point every 0.1 s, no axis faster than the fraction.
[[nodiscard]] std::vector<MotoTrajectoryPoint> plan_joint_move(const ArmGeometry& arm, const ArmJoints& from,
                                                               const ArmJoints& to, double speed_fraction);

/// The tool centre goes straight and turns evenly. safety: no joints for a place on the way, or the axes would jump.
[[nodiscard]] core::Result<std::vector<MotoTrajectoryPoint>> plan_line(const MotoRosLimits& limits,
                                                                       const ArmJoints& from,
                                                                       const FlangeInBase& T_base_flange,
                                                                       double speed_mm_s);

/// The whole way, also between the points where the controller follows a cubic: limits and speeds of the axes, speed of
/// the tool centre, box, times that increase, a start and an end at rest. Errors: safety, naming point, value and
/// limit. Throws std::invalid_argument without an arm.
[[nodiscard]] core::Status check_trajectory(const std::vector<MotoTrajectoryPoint>& points,
                                            const MotoRosLimits& limits);

/// Checks, looks whether the arm stands at the start, starts the trajectory mode, sends the points (again while the
/// controller is busy), waits for the end, leaves the trajectory mode. Sleeps on the seat between repeats. Any failure
/// after the first point ends in a stop command and an error; no point is ever sent again that may have been taken.
/// stop_asked is looked at between messages (at most 25 ms apart); it may be empty.
[[nodiscard]] core::Status run_trajectory(MotoRosClient& client, const std::vector<MotoTrajectoryPoint>& points,
                                          const MotoRosLimits& limits, core::Seat& seat,
                                          const std::function<bool()>& stop_asked = {});

/// The first six joints.
[[nodiscard]] ArmJoints arm_joints(const MotoJoints& joints);

}  // namespace pickcell::robot
