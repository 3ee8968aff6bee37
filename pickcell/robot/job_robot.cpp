#include "pickcell/robot/job_robot.hpp"

#include <array>
#include <stdexcept>
#include <utility>

#include "pickcell/core/log.hpp"
#include "pickcell/robot/pose_angles.hpp"
#include "pickcell/robot/readiness.hpp"
#include "pickcell/robot/tcp80_codec.hpp"  // positions as text, for the journal's readers

namespace pickcell::robot {

using core::ErrorCode;

namespace {

struct Variable {
  VariableType type;
  int offset;  ///< from the first variable
};

constexpr std::array<Variable, kRegisters> kVariables = {{
    {VariableType::byte, 0},            // command
    {VariableType::byte, 1},            // reason
    {VariableType::byte, 2},            // clear_of_camera
    {VariableType::byte, 3},            // result
    {VariableType::integer, 0},         // part_class
    {VariableType::integer, 1},         // epoch
    {VariableType::integer, 2},         // epoch_ack
    {VariableType::integer, 3},         // command_epoch
    {VariableType::integer, 4},         // held_epoch
    {VariableType::double_integer, 0},  // sequence
    {VariableType::double_integer, 1},  // done
    {VariableType::double_integer, 2},  // accepted
    {VariableType::double_integer, 3},  // sequence_copy
}};

Variable variable(Register which) { return kVariables[static_cast<std::size_t>(which)]; }
int offset(PoseRegister which) { return which == PoseRegister::grasp ? 0 : 1; }

constexpr core::Duration kServoTimeout = std::chrono::seconds(5);

core::Status not_ready(std::string why, std::string remedy) {
  return core::failure(ErrorCode::refused, "robot", std::move(why), std::move(remedy));
}

}  // namespace

core::Result<std::int32_t> VariableRegisters::read(Register which) {
  return link_.read_integer(variable(which).type, first_ + variable(which).offset);
}

core::Status VariableRegisters::write(Register which, std::int32_t value) {
  return link_.write_integer(variable(which).type, first_ + variable(which).offset, value);
}

core::Result<VariablePosition> VariableRegisters::read_pose(PoseRegister which) {
  return link_.read_position_variable(first_ + offset(which));
}

core::Status VariableRegisters::write_pose(PoseRegister which, const CartesianPosition& position) {
  return link_.write_position_variable(first_ + offset(which), position);
}

JobRobot::JobRobot(JobRobotSettings settings, std::unique_ptr<ControllerLink> link, Journal& journal,
                   const core::Clock& clock)
    : settings_(std::move(settings)),
      link_(std::move(link)),
      registers_(*link_, settings_.first_variable),
      session_(registers_, journal, clock) {
  if (settings_.tool < 0 || settings_.tool > kMaxTool) throw std::invalid_argument("tool number outside 0..63");
  if (settings_.frame < 0 || settings_.frame > 65) throw std::invalid_argument("frame number outside 0..65");
  if (settings_.first_variable < 1 || settings_.first_variable > 86)
    throw std::invalid_argument("first variable outside 1..86");
}

core::Status JobRobot::connect(core::Seat& seat) {
  session_.lost();
  if (auto opened = link_->connect(); !opened) return opened;
  if (auto read_back = session_.connect(); !read_back) return read_back;
  return settle(seat);
}

void JobRobot::disconnect() {
  session_.lost();
  link_->disconnect();
}

/// Waits for the job where it runs; where it stands, start() will.
core::Status JobRobot::settle(core::Seat& seat) {
  auto running = job_runs();
  if (!running) return core::forward(running);
  if (!*running) return {};
  return session_.settle(seat, [this] { return job_runs(); });
}

core::Result<bool> JobRobot::job_runs() {
  auto status = link_->read_status();
  if (!status) return core::forward(status);
  if (!status->running) return false;
  auto job = link_->read_job();
  if (!job) return core::forward(job);
  return job->name == settings_.job;
}

core::Result<RobotState> JobRobot::state() {
  auto status = link_->read_status();
  if (!status) return status;
  auto clear = registers_.read(Register::clear_of_camera);
  if (!clear) return core::forward(clear);
  status->clear_of_camera = *clear == 1;
  return status;
}

core::Result<std::vector<Alarm>> JobRobot::alarms() { return link_->read_alarms(); }

core::Result<core::Transform<core::Base, core::Tool>> JobRobot::pose() {
  auto position = link_->read_position(kBaseFrame);
  if (!position) return core::forward(position);
  if (position->tool != settings_.tool)
    return core::failure(ErrorCode::refused, "robot",
                         "tool " + std::to_string(position->tool) + " is selected, and the cell works with tool " +
                             std::to_string(settings_.tool),
                         "select it at the controller, or correct tool in [robot]");
  return transform_from(*position);
}

core::Status JobRobot::may_start(const RobotState& state) {
  const std::vector<Hindrance> found = hindrances(state);
  if (found.empty()) return {};
  std::string why = found.front().what;
  if (state.alarm || state.error) {
    std::string which;
    if (auto list = link_->read_alarms()) {
      for (const Alarm& alarm : *list) which += (which.empty() ? ": " : ", ") + alarm.text;
    }
    why += which;
  }
  return not_ready(std::move(why), found.front().remedy);
}

core::Status JobRobot::servo_on(core::Seat& seat) {
  if (auto on = link_->servo(true); !on) return on;
  const core::TimePoint deadline = seat.now() + kServoTimeout;
  for (;;) {
    auto status = link_->read_status();
    if (!status) return core::forward(status);
    if (status->servo) return {};
    const core::TimePoint before = seat.now();
    if (before >= deadline) {
      return core::failure(ErrorCode::timeout, "robot", "the servo does not come on",
                           "check emergency stops, doors and the bridge of the external-servo-on input");
    }
    seat.sleep_for(PickSession::kPoll);
    if (seat.now() == before) return core::failure(ErrorCode::timeout, "robot", "stopped while waiting for the servo");
  }
}

core::Status JobRobot::start_job(core::Seat& seat) {
  // The fence first: the job, restarted at its first line, drops whatever stands in its variables.
  if (auto fenced = session_.fence(); !fenced) return fenced;
  auto started = link_->start_job(settings_.job);
  if (!started && (started.error().code == ErrorCode::timeout || started.error().code == ErrorCode::link)) {
    // Nobody knows whether it runs. Never again blindly: hold, and let the operator look.
    session_.lost();
    if (link_->connect() && link_->hold(true)) started.error().remedy = "the arm is held; look at it, then Reset";
    return started;
  }
  if (!started) return started;
  seat.sleep_for(PickSession::kPoll);  // so that the flags of the job's last run are gone
  return {};
}

core::Status JobRobot::start(core::Seat& seat) {
  auto status = link_->read_status();
  if (!status) return core::forward(status);
  if (auto may = may_start(*status); !may) return may;
  if (session_.phase() == HandOverPhase::lost) {
    if (auto read_back = session_.connect(); !read_back && session_.phase() != HandOverPhase::held) return read_back;
  }
  if (session_.phase() == HandOverPhase::journal_missing) return session_.settle(seat, nullptr);
  if (!status->servo) {
    if (auto on = servo_on(seat); !on) return on;
  }
  auto running = job_runs();
  if (!running) return core::forward(running);
  if (!*running && status->running)
    return not_ready("another job than " + settings_.job + " is running", "stop it, then start again");
  if (!*running) {
    if (auto started = start_job(seat); !started) return started;
  }
  if (auto settled = session_.settle(seat, [this] { return job_runs(); }); !settled) return settled;
  if (session_.phase() == HandOverPhase::ready) return {};
  auto now = link_->read_status();
  if (!now) return core::forward(now);
  if (auto may = may_start(*now); !may) return may;
  return not_ready("the job " + settings_.job + " has stopped", "see the message on the pendant");
}

core::Status JobRobot::confirm(core::Seat& seat) {
  if (session_.phase() == HandOverPhase::lost) return not_ready("not connected", "connect first");
  if (auto confirmed = session_.confirm(); !confirmed) return confirmed;
  return settle(seat);
}

core::Result<std::int32_t> JobRobot::submit(const picks::Pick& pick) {
  if (auto safe = check_pick(pick, settings_.limits); !safe) return core::forward(safe);
  PickCommand command;
  command.grasp = position_from(pick.T_base_grasp);
  command.place = position_from(pick.T_base_place);
  for (CartesianPosition* p : {&command.grasp, &command.place}) {
    p->frame = settings_.frame;
    p->tool = settings_.tool;
    p->form = settings_.form;
  }
  command.part_class = pick.part_class;
  command.row.detection_id = pick.detection_id;
  command.row.place_slot = pick.place_slot;
  command.row.model = pick.model;
  command.row.payload =
      "grasp " + tcp80_position_fields(command.grasp) + " place " + tcp80_position_fields(command.place);
  return session_.submit(command);
}

core::Result<std::optional<Outcome>> JobRobot::outcome() { return session_.outcome(); }

core::Status JobRobot::hold(bool on) {
  if (on && !link_->connected())
    if (auto opened = link_->connect(); !opened) return opened;
  return link_->hold(on);
}

core::Status JobRobot::reset() {
  if (auto released = link_->hold(false); !released) return released;
  if (auto cleared = link_->reset_alarm(); !cleared) return cleared;
  return link_->cancel_error();
}

core::Status JobRobot::write_contact(int contact, bool on) {
  const int first = contact / 10 * 10, bit = contact % 10;
  if (contact < 0 || bit > 7) throw std::invalid_argument("contact numbers end in 0..7");
  auto group = link_->read_contacts(first, 1);
  if (!group) return core::forward(group);
  const int mask = 1 << bit;
  (*group)[0] = static_cast<std::uint8_t>(on ? (*group)[0] | mask : (*group)[0] & ~mask);
  return link_->write_contacts(first, *group);
}

core::Result<bool> JobRobot::read_contact(int contact) {
  const int bit = contact % 10;
  if (contact < 0 || bit > 7) throw std::invalid_argument("contact numbers end in 0..7");
  auto group = link_->read_contacts(contact / 10 * 10, 1);
  if (!group) return core::forward(group);
  return ((*group)[0] >> bit & 1) != 0;
}

}  // namespace pickcell::robot
