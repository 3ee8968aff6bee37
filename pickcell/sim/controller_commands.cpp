#include "pickcell/sim/controller_commands.hpp"

#include <utility>

#include "pickcell/core/units.hpp"
#include "pickcell/sim/position_solver.hpp"

namespace pickcell::sim {

namespace {

Refusal healthy(const ControllerState& s) {
  if (!s.remote) return Refusal::not_remote;
  return s.alarms.empty() && !s.error ? Refusal::none : Refusal::alarm_or_error;
}

/// Everything that keeps a job or a direct move from starting.
Refusal ready_to_move(const ControllerState& s) {
  if (const Refusal refusal = healthy(s); refusal != Refusal::none) return refusal;
  if (s.hold_pendant) return Refusal::held_by_pendant;
  if (s.hold_external) return Refusal::held_from_outside;
  if (s.hold_command) return Refusal::held_by_command;
  if (!s.play) return Refusal::wrong_mode;
  if (!s.servo) return Refusal::servo_off;
  return s.running() ? Refusal::moving : Refusal::none;
}

Refusal standing(const ControllerState& s) {
  if (!s.remote) return Refusal::not_remote;
  return s.running() ? Refusal::moving : Refusal::none;
}

void put_at(ControllerState& s, std::shared_ptr<const JobProgram> job, std::size_t line) {
  s.task = {};
  s.task.step = line > 0 ? job->step_at(line - 1) : 0;
  s.task.at = {std::move(job), line};
  s.move.reset();
}

Refusal begin_direct(ControllerState& s, std::variant<Move, MoveFault> planned, int tool) {
  if (std::holds_alternative<MoveFault>(planned)) return Refusal::position_missing;
  // A stopped job's move would start from elsewhere now: its line is begun anew.
  s.task.begun = false;
  s.move = std::get<Move>(std::move(planned));
  s.direct_move = true;
  s.tool = tool;
  return Refusal::none;
}

}  // namespace

Refusal may_write(const ControllerState& s) { return s.remote ? Refusal::none : Refusal::not_remote; }

Refusal set_hold(ControllerState& s, bool on) {
  if (!s.remote) return Refusal::not_remote;
  s.hold_command = on;
  if (on && s.running()) s.stopping = true;
  return Refusal::none;
}

Refusal reset_alarms(ControllerState& s) {
  if (!s.remote) return Refusal::not_remote;
  std::erase_if(s.alarms, [](const AlarmEntry& a) { return a.code >= kFirstMinorAlarm; });
  return Refusal::none;
}

Refusal cancel_error(ControllerState& s) {
  if (!s.remote) return Refusal::not_remote;
  s.error = false;
  return Refusal::none;
}

Refusal set_servo(ControllerState& s, bool on) {
  if (!s.remote) return Refusal::not_remote;
  if (on && !s.alarms.empty()) return Refusal::alarm_or_error;
  if (on && s.emergency_stop) return Refusal::servo_cannot_go_on;
  s.servo = on;
  return Refusal::none;
}

Refusal set_mode(ControllerState& s, bool play) {
  if (const Refusal refusal = standing(s); refusal != Refusal::none) return refusal;
  s.play = play;
  return Refusal::none;
}

Refusal set_cycle(ControllerState& s, CycleMode mode) {
  if (!s.remote) return Refusal::not_remote;
  s.cycle = mode;
  return Refusal::none;
}

Refusal set_pendant_lock(ControllerState& s, bool on) {
  if (!s.remote) return Refusal::not_remote;
  s.pendant_locked = on;
  return Refusal::none;
}

Refusal show_message(ControllerState& s, std::string_view text) {
  constexpr std::size_t kShown = 30;
  if (text.size() > kShown) return Refusal::operand_length;
  if (!s.remote) return Refusal::not_remote;
  s.pendant_message = std::string(text);
  return Refusal::none;
}

Refusal start(ControllerState& s, std::string_view job) {
  if (const Refusal refusal = ready_to_move(s); refusal != Refusal::none) return refusal;
  if (!job.empty()) {
    const auto found = s.jobs.find(job);
    if (found == s.jobs.end()) return Refusal::no_such_job;
    put_at(s, found->second, 0);
  } else if (!s.task.at.job) {
    return Refusal::no_job_set;
  }
  s.task.running = true;
  return Refusal::none;
}

Refusal select_job(ControllerState& s, std::string_view job, int line) {
  if (line < 0 || line > 9999) return Refusal::operand_range;
  if (const Refusal refusal = healthy(s); refusal != Refusal::none) return refusal;
  if (s.running()) return Refusal::moving;
  const auto found = s.jobs.find(job);
  if (found == s.jobs.end()) return Refusal::no_such_job;
  if (static_cast<std::size_t>(line) >= found->second->lines.size()) return Refusal::operand_range;
  put_at(s, found->second, static_cast<std::size_t>(line));
  return Refusal::none;
}

Refusal set_master_job(ControllerState& s, std::string_view job) {
  if (const Refusal refusal = standing(s); refusal != Refusal::none) return refusal;
  if (!s.jobs.contains(job)) return Refusal::no_such_job;
  s.master_job = std::string(job);
  return Refusal::none;
}

Refusal delete_job(ControllerState& s, std::string_view job) {
  if (const Refusal refusal = standing(s); refusal != Refusal::none) return refusal;
  if (job != "*" && !s.jobs.contains(job)) return Refusal::no_such_job;
  const auto gone = [&](std::string_view name) { return job == "*" || job == name; };
  std::erase_if(s.jobs, [&](const auto& entry) { return gone(entry.first); });
  if (gone(s.master_job)) s.master_job.clear();
  if (job == "*" || s.in_use(job)) {
    s.task = {};
    s.move.reset();
  }
  return Refusal::none;
}

Refusal move_joint(ControllerState& s, const Position& target, double fraction) {
  if (!target.pulse && !s.frame_exists(target.frame)) return Refusal::operand_range;
  if (const Refusal refusal = ready_to_move(s); refusal != Refusal::none) return refusal;
  if (!target.pulse && !s.frame(target.frame)) return Refusal::frame_not_taught;
  return begin_direct(s, plan_joint_move(s, target, fraction), target.tool);
}

Refusal move_line(ControllerState& s, const Position& target, LineSpeed speed) {
  if (!target.pulse && !s.frame_exists(target.frame)) return Refusal::operand_range;
  if (const Refusal refusal = ready_to_move(s); refusal != Refusal::none) return refusal;
  if (!target.pulse && !s.frame(target.frame)) return Refusal::frame_not_taught;
  constexpr double kNoLimit_m_s = 1e3;  // the turn alone sets the time
  return begin_direct(s,
                      plan_line(s, target, speed.turning ? kNoLimit_m_s : core::m_from_mm(speed.value),
                                speed.turning ? core::rad_from_deg(speed.value) : s.limits.turn_speed_rad_s),
                      target.tool);
}

std::optional<Position> from_tool_frame(const ControllerState& s, const Position& in_tool) {
  if (in_tool.pulse || in_tool.frame != kToolFrame) return std::nullopt;
  const ToolPose now = s.T_base_flange() * s.tools[static_cast<std::size_t>(in_tool.tool)];
  Position p = in_tool;
  p.frame = 0;
  p.axis = cartesian_from_pose(now.iso() * pose_from_cartesian(in_tool.axis));
  return p;
}

Refusal move_by(ControllerState& s, int frame, const Cartesian& difference, int tool, LineSpeed speed) {
  if (!s.frame_exists(frame)) return Refusal::operand_range;
  const auto T_base_frame = s.frame(frame);
  if (!T_base_frame) {
    const Refusal refusal = ready_to_move(s);
    return refusal != Refusal::none ? refusal : Refusal::frame_not_taught;
  }
  const ToolPose now = s.T_base_flange() * s.tools[static_cast<std::size_t>(tool)];
  const Eigen::Isometry3d by = pose_from_cartesian(difference);
  const Eigen::Matrix3d axes = T_base_frame->linear();
  Eigen::Isometry3d target = Eigen::Isometry3d::Identity();
  target.linear() = axes * by.linear() * axes.transpose() * now.rotation();
  target.translation() = now.translation_m() + axes * by.translation();
  Position p;
  p.axis = cartesian_from_pose(target);
  p.tool = tool;
  return move_line(s, p, speed);
}

}  // namespace pickcell::sim
