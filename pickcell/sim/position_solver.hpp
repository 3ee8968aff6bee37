#pragma once
/// From position data (pulse or cartesian in some frame) to joints and tool poses of the arm as it stands.

#include <optional>
#include <variant>

#include "pickcell/sim/controller_state.hpp"

namespace pickcell::sim {

/// The tool pose a position means; empty when its frame is unknown or not taught.
[[nodiscard]] std::optional<ToolPose> tool_pose(const ControllerState& state, const Position& position);

/// Joints for a position: pulses as they are, cartesian in the position's form. Or why not.
[[nodiscard]] std::variant<Joints, MoveFault> joints_for(const ControllerState& state, const Position& position);

/// A joint move from where the arm is. fraction of the greatest speeds, (0, 1].
[[nodiscard]] std::variant<Move, MoveFault> plan_joint_move(const ControllerState& state, const Position& target,
                                                            double fraction);
/// A straight line from where the arm is; the target must be reachable in the arm's present form.
[[nodiscard]] std::variant<Move, MoveFault> plan_line(const ControllerState& state, const Position& target,
                                                      double speed_m_s, double turn_speed_rad_s);

/// Where the tool is, in a frame that exists and is taught; form and tool number included.
[[nodiscard]] Position present_position(const ControllerState& state, int frame);

}  // namespace pickcell::sim
