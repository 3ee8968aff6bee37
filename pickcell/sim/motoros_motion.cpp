#include "pickcell/sim/motoros_motion.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "pickcell/sim/controller_commands.hpp"
#include "pickcell/sim/controller_contacts.hpp"
#include "pickcell/sim/dh_links.hpp"
#include "pickcell/sim/job_program.hpp"
#include "pickcell/sim/motoros_io.hpp"

namespace pickcell::sim {

namespace moto = robot::moto;
using robot::MotoCommand;
using robot::MotoFrame;
using robot::MotoReply;
using robot::MotoTrajectoryPoint;

namespace {

constexpr double kStartCheck_s = 0.05;
constexpr double kLongestTrajectory_s = 4 * 3600.0;
constexpr const char* kJobName = "INIT_ROS";

/// Our wording of the job that MotoROS needs: says that it waits, and waits to be told that motion is done.
JobProgram init_ros() {
  return *parse_job(
      "/JOB\r\n//NAME INIT_ROS\r\n//POS\r\n///NPOS 0,0,0,0,0,0\r\n//INST\r\n///DATE 2026/11/25 08:00\r\n"
      "///ATTR SC,RW\r\n///GROUP1 RB1\r\nNOP\r\nDOUT OT#(890) OFF\r\nDOUT OT#(889) OFF\r\nTIMER T=0.05\r\n"
      "DOUT OT#(889) ON\r\nWAIT OT#(890)=ON\r\nDOUT OT#(889) OFF\r\nDOUT OT#(890) OFF\r\nEND\r\n");
}

bool output(const ControllerState& s, int n) { return s.outputs[static_cast<std::size_t>(n)]; }

bool ready(const ControllerState& s) { return output(s, kMotoRosWaiting) && s.running() && s.remote; }

std::int32_t why_not_ready(const ControllerState& s) {
  if (!s.alarms.empty()) return moto::because_alarm;
  if (s.error) return moto::because_error;
  if (s.emergency_stop) return moto::because_emergency_stop;
  if (!s.play) return moto::because_not_play;
  if (!s.remote) return moto::because_not_remote;
  if (!s.servo) return moto::because_servo_off;
  if (s.held()) return moto::because_hold;
  if (!s.running()) return moto::because_not_started;
  if (!output(s, kMotoRosWaiting)) return moto::because_not_waiting;
  return moto::because_unspecified;
}

MotoReply with(MotoReply reply, std::int32_t result, std::int32_t subcode = 0) {
  reply.result = result;
  reply.subcode = subcode;
  return reply;
}

Joints joints(const robot::MotoJoints& values) {
  Joints q;
  for (int i = 0; i < 6; ++i) q[i] = static_cast<double>(values[static_cast<std::size_t>(i)]);
  return q;
}

/// Unknown types are told so and put out.
MotoRosAnswer unknown(const MotoFrame& message) {
  MotoReply reply;
  reply.group = reply.sequence = -1;
  reply.command = message.type;
  return {moto_frame(with(reply, moto::invalid, moto::type)), false, true};
}

MotoRosAnswer wrong_size(const MotoFrame& message) {
  MotoReply reply;
  reply.command = message.type;
  return {moto_frame(with(reply, moto::invalid, moto::size)), false, false};
}

/// Four groups of eight links of theta, d, a, alpha; what there is not is 0. The units are open: radians and
/// millimetres.
MotoFrame dh_parameters(const Arm& arm) {
  constexpr std::size_t kLinksOfAGroup = 8, kWordsOfALink = 4;
  MotoFrame frame{moto::kDhParameters, moto::kReply, moto::kSuccess,
                  std::vector<std::uint32_t>(moto::kGroups * kLinksOfAGroup * kWordsOfALink)};
  auto word = frame.body.begin();
  for (const DhLink& link : dh_links(arm))
    for (const double v : {link.theta_rad, link.d_m * 1e3, link.a_m * 1e3, link.alpha_rad})
      *word++ = std::bit_cast<std::uint32_t>(static_cast<float>(v));
  return frame;
}

}  // namespace

std::string_view motoros_command_name(const MotoFrame& message) {
  switch (message.type) {
    case moto::kTrajectoryPoint:
    case moto::kTrajectoryPointEx:
      return "JOINTTRAJPT";
    case moto::kMotionControl:
      return "MOTIONCTRL";
    default:
      return is_motoros_io(message) ? "MOTOROSIO" : "MOTOROS";
  }
}

Joints MotoRosMotion::Segment::at(double t_s) const {
  const double length_s = to_s - from_s;
  if (t_s >= to_s || length_s <= 0) return q1;
  const double u = (t_s - from_s) / length_s;
  const Joints c2 = 3 * (q1 - q0) - (2 * v0 + v1) * length_s;
  const Joints c3 = 2 * (q0 - q1) + (v0 + v1) * length_s;
  return q0 + u * (v0 * length_s + u * (c2 + u * c3));
}

MotoRosAnswer MotoRosMotion::handle(ControllerState& s, const MotoFrame& message) {
  switch (message.type) {
    case moto::kPing:
      return {MotoFrame{moto::kPing, moto::kReply, moto::kSuccess, {}}, false, false};
    case moto::kTrajectoryPoint: {
      const auto p = robot::parse_moto_point(message);
      return p ? MotoRosAnswer{moto_frame(point(s, *p)), false, false} : wrong_size(message);
    }
    case moto::kTrajectoryPointEx: {
      const auto ex = robot::parse_moto_point_ex(message);
      if (!ex) return wrong_size(message);
      const robot::MotoFeedback& part = ex->parts[0];
      MotoReply reply = with({}, moto::invalid, moto::group);  // one arm: one group
      if (ex->groups == 1)
        reply = point(
            s, {part.group, ex->sequence, part.valid, part.time_s, part.position, part.velocity, part.acceleration});
      reply.sequence = ex->sequence;
      reply.command = moto::kTrajectoryPointEx;
      return {moto_frame(reply), false, false};
    }
    case moto::kMotionControl: {
      const auto command = robot::parse_moto_command(message);
      return command ? control(s, *command) : wrong_size(message);
    }
    case moto::kSelectTool: {
      const auto select = robot::parse_moto_select_tool(message);
      return select ? MotoRosAnswer{moto_frame(select_tool(s, *select)), false, false} : wrong_size(message);
    }
    case moto::kDhParameters:
      return message.body.empty() ? MotoRosAnswer{dh_parameters(*s.arm), false, false} : wrong_size(message);
    default:
      return unknown(message);
  }
}

MotoReply MotoRosMotion::point(const ControllerState& s, const MotoTrajectoryPoint& p) {
  MotoReply reply;
  reply.group = p.group;
  reply.sequence = p.sequence;
  reply.command = moto::kTrajectoryPoint;
  if (!ready(s)) return with(reply, moto::not_ready, why_not_ready(s));
  if (p.group != 0) return with(reply, moto::invalid, moto::group);
  constexpr std::int32_t kNeeded = moto::kTimeValid | moto::kPositionValid | moto::kVelocityValid;
  if ((p.valid & kNeeded) != kNeeded) return with(reply, moto::invalid, moto::fields_missing);
  const Point next{static_cast<double>(p.time_s), joints(p.position), joints(p.velocity)};
  if (!std::isfinite(next.time_s) || !next.q.allFinite() || !next.v.allFinite())
    return with(reply, moto::invalid, moto::data);
  if (next.time_s >= kLongestTrajectory_s) return with(reply, moto::invalid, moto::time);
  if (p.sequence < 0) return with(reply, moto::invalid, moto::sequence);
  // Whoever cuts the point into increments looks for room once a period: it is through one period late.
  if (p.sequence > 0 && end_s_ > executed_s_ + (settings_.queue_increments - 1) * settings_.increment_s + 1e-9)
    return with(reply, moto::busy);
  if (p.sequence == 0) {
    const Joints off = ((next.q - s.q).array() * s.arm->pulses_per_rad.array()).abs();
    if ((off.array() > settings_.start_deviation_pulses).any()) return with(reply, moto::invalid, moto::start_position);
  }
  if ((next.v.cwiseAbs().array() > s.arm->max_speed.array()).any()) return with(reply, moto::invalid, moto::speed);
  if (next.time_s < (p.sequence == 0 ? 0 : last_.time_s)) return with(reply, moto::invalid, moto::time);
  p.sequence == 0 ? first_point(next) : add_point(next);
  return reply;
}

void MotoRosMotion::first_point(const Point& start) { last_ = start; }

void MotoRosMotion::add_point(const Point& next) {
  if (!holds_motion()) {
    segments_.clear();
    end_s_ = executed_s_;
  }
  const double to_s = end_s_ + (next.time_s - last_.time_s);
  segments_.push_back({end_s_, to_s, last_.q, last_.v, next.q, next.v});
  end_s_ = to_s;
  last_ = next;
}

void MotoRosMotion::clear() {
  segments_.clear();
  end_s_ = executed_s_;
  last_.v.setZero();
}

MotoReply MotoRosMotion::select_tool(ControllerState& s, const robot::MotoSelectTool& select) const {
  MotoReply reply;
  reply.group = select.group;
  reply.sequence = select.sequence;
  reply.command = moto::kSelectTool;
  if (select.group != 0) return with(reply, moto::invalid, moto::group);
  if (select.tool < 0 || select.tool >= static_cast<int>(s.tools.size())) return with(reply, moto::invalid, moto::tool);
  s.tool = select.tool;
  return reply;
}

MotoRosAnswer MotoRosMotion::control(ControllerState& s, const MotoCommand& c) {
  MotoReply reply;
  reply.group = c.group;
  reply.sequence = c.sequence;
  reply.command = c.command;
  const auto answer = [&](std::int32_t result, std::int32_t subcode = 0, bool close = false) {
    return MotoRosAnswer{moto_frame(with(reply, result, subcode)), false, close};
  };
  const auto done = [&](Refusal refusal) { return answer(refusal == Refusal::none ? moto::ok : moto::no); };
  switch (c.command) {
    case moto::kCheckReady:
      return ready(s) ? answer(moto::ok) : answer(moto::no, why_not_ready(s));
    case moto::kQueueCount: {
      const double queued_s = std::min(end_s_ - executed_s_, settings_.queue_increments * settings_.increment_s);
      return answer(moto::ok, static_cast<std::int32_t>(std::ceil(queued_s / settings_.increment_s - 1e-9)));
    }
    case moto::kStop:
      clear();
      return answer(moto::ok);
    case moto::kServoOn:
      return done(set_servo(s, true));
    case moto::kServoOff:
      clear();
      return done(set_servo(s, false));
    case moto::kResetAlarm: {
      const bool done_both = reset_alarms(s) == Refusal::none && cancel_error(s) == Refusal::none;
      return answer(done_both && s.alarms.empty() ? moto::ok : moto::no);
    }
    case moto::kStartTrajectoryMode:
      return start(s, reply);
    case moto::kStopTrajectoryMode:
    case moto::kDisconnect:
      if (holds_motion()) return answer(moto::no);
      set_output(s, kMotoRosDone, true);
      return answer(moto::ok, 0, c.command == moto::kDisconnect);
    default:
      return answer(moto::invalid, moto::command);
  }
}

MotoRosAnswer MotoRosMotion::start(ControllerState& s, MotoReply reply) {
  if (ready(s)) return {moto_frame(reply), false, false};
  if (!start_job(s)) return {moto_frame(with(reply, moto::not_ready, why_not_ready(s))), false, false};
  starting_ = Starting{reply, 5, kStartCheck_s, std::nullopt};
  return {std::nullopt, true, false};
}

/// What a person must do is refused; what can be put right from afar is.
bool MotoRosMotion::start_job(ControllerState& s) {
  if (s.running() || s.emergency_stop || s.held() || !s.remote) return false;
  if (cancel_error(s) != Refusal::none || reset_alarms(s) != Refusal::none || !s.alarms.empty()) return false;
  if (!s.servo && set_servo(s, true) != Refusal::none) return false;
  clear();
  // The application's own job is not among those that a host lists, unless somebody loaded one.
  const bool own = !s.jobs.contains(kJobName);
  if (own) s.load_job(init_ros());
  const bool started = sim::start(s, kJobName) == Refusal::none;
  if (own) s.jobs.erase(kJobName);
  return started;
}

std::optional<MotoFrame> MotoRosMotion::waited(const ControllerState& s) {
  if (!starting_ || !starting_->ready) return std::nullopt;
  MotoReply reply = starting_->reply;
  if (!*starting_->ready) reply = with(reply, moto::not_ready, why_not_ready(s));
  starting_.reset();
  return moto_frame(reply);
}

void MotoRosMotion::host_left() {
  clear();
  starting_.reset();
}

void MotoRosMotion::tick(ControllerState& s, double dt_s) {
  if (starting_ && !starting_->ready) {
    starting_->left_s -= dt_s;
    starting_->to_check_s -= dt_s;
    if (starting_->to_check_s < dt_s * 1e-6) {
      starting_->to_check_s += kStartCheck_s;
      if (ready(s) || starting_->left_s <= 0) starting_->ready = ready(s);
    }
  }
  if (!holds_motion()) return;
  if (!ready(s) || s.motion_blocked()) return clear();
  executed_s_ = std::min(executed_s_ + dt_s, end_s_);
  while (segments_.size() > 1 && segments_.front().to_s <= executed_s_) segments_.pop_front();
  const Joints q = segments_.front().at(executed_s_);
  const bool inside = inside_limits(*s.arm, q);
  const Joints farthest =
      s.arm->max_speed * dt_s * 1.05 + settings_.start_deviation_pulses * s.arm->pulses_per_rad.cwiseInverse();
  if (!inside || ((q - s.q).cwiseAbs().array() > farthest.array()).any()) {
    s.raise_alarm({inside ? kAlarmExcessiveSpeed : kAlarmPulseLimit, 0, inside ? "axis speed" : "axis limit"});
    return clear();
  }
  s.q = q;
}

robot::MotoStatus MotoRosMotion::status(const ControllerState& s) const {
  robot::MotoStatus status;
  status.drives_powered = s.servo;
  status.e_stopped = s.emergency_stop;
  status.error_code = s.alarms.empty() ? 0 : s.alarms.front().code;
  status.in_error = !s.alarms.empty() || s.error;
  status.in_motion = holds_motion() || s.move.has_value();
  status.mode = s.play ? 2 : 1;
  status.motion_possible = ready(s);
  return status;
}

robot::MotoFeedback MotoRosMotion::feedback(const ControllerState& s) {
  robot::MotoFeedback feedback;
  feedback.valid = moto::kPositionValid;
  // What the encoders say: whole pulses.
  const Joints q = joints_from_pulses(*s.arm, pulses_from_joints(*s.arm, s.q));
  for (int i = 0; i < 6; ++i) feedback.position[static_cast<std::size_t>(i)] = static_cast<float>(q[i]);
  return feedback;
}

}  // namespace pickcell::sim
