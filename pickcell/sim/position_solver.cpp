#include "pickcell/sim/position_solver.hpp"

namespace pickcell::sim {

std::optional<ToolPose> tool_pose(const ControllerState& state, const Position& position) {
  if (position.pulse)
    return forward(*state.arm, joints_from_pulses(*state.arm, position.axis)) *
           state.tools[static_cast<std::size_t>(position.tool)];
  const auto T_base_frame = state.frame(position.frame);
  if (!T_base_frame) return std::nullopt;
  return ToolPose(*T_base_frame * pose_from_cartesian(position.axis));
}

std::variant<Joints, MoveFault> joints_for(const ControllerState& state, const Position& position) {
  if (position.pulse) {
    const Joints q = joints_from_pulses(*state.arm, position.axis);
    if (!inside_limits(*state.arm, q)) return MoveFault::axis_limit;
    return q;
  }
  const auto T_base_tool = tool_pose(state, position);
  if (!T_base_tool) return MoveFault::out_of_reach;
  const ToolData& tool = state.tools[static_cast<std::size_t>(position.tool)];
  const auto q = inverse_in_form(*state.arm, *T_base_tool * tool.inverse(), Form::from_bits(position.form), state.q);
  if (!q) return MoveFault::out_of_reach;
  return *q;
}

std::variant<Move, MoveFault> plan_joint_move(const ControllerState& state, const Position& target, double fraction) {
  const auto to = joints_for(state, target);
  if (const auto* fault = std::get_if<MoveFault>(&to)) return *fault;
  return Move::joint(*state.arm, state.limits, state.q, std::get<Joints>(to), fraction);
}

std::variant<Move, MoveFault> plan_line(const ControllerState& state, const Position& target, double speed_m_s,
                                        double turn_speed_rad_s) {
  const auto T_base_tool = tool_pose(state, target);
  if (!T_base_tool) return MoveFault::out_of_reach;
  const ToolData& tool = state.tools[static_cast<std::size_t>(target.tool)];
  if (!inverse_continuing(*state.arm, *T_base_tool * tool.inverse(), state.q)) return MoveFault::out_of_reach;
  return Move::line(*state.arm, state.limits, state.q, tool, *T_base_tool, speed_m_s, turn_speed_rad_s);
}

Position present_position(const ControllerState& state, int frame) {
  const Eigen::Isometry3d T_base_frame = state.frame(frame).value_or(Eigen::Isometry3d::Identity());
  const ToolPose T_base_tool = state.T_base_flange() * state.tools[static_cast<std::size_t>(state.tool)];
  Position p;
  p.frame = frame;
  p.axis = cartesian_from_pose(T_base_frame.inverse(Eigen::Isometry) * T_base_tool.iso());
  p.form = form_of(*state.arm, state.q).bits();
  p.tool = state.tool;
  return p;
}

}  // namespace pickcell::sim
