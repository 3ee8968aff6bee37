#include "pickcell/cell/arm.hpp"

#include "pickcell/core/log.hpp"
#include "pickcell/core/units.hpp"

namespace pickcell::cell {

using core::ErrorCode;

tl::unexpected<Halt> Arm::failed(const core::Error& error, const std::string& doing) {
  Halt halt = halt_from(error, doing);
  // Refused with the link up: a person must look at the arm first (Robot::connect); the next Reset says so.
  halt.person_must_look = error.code == ErrorCode::refused && robot_.connected();
  if (!robot_.connected()) {
    view_ = RobotView{};
    view_.link = link_;
    view_.words = "not connected";
    hindrance_ = Hindrance{halt.code, halt.why, halt.remedy};
  }
  return tl::unexpected(std::move(halt));
}

Or<void> Arm::connect() {
  if (auto connected = robot_.connect(seat_); !connected) return failed(connected.error(), "connecting to the robot");
  if (auto state = poll(Need::nothing); !state) return tl::unexpected(state.error());
  return {};
}

Or<void> Arm::reset(bool person_looked) {
  const bool was_connected = robot_.connected();
  if (was_connected)
    if (auto cleared = clear(); !cleared) return tl::unexpected(cleared.error());
  auto connected = connect();
  if (!was_connected && robot_.connected()) {
    const auto cleared = clear();
    if (!cleared) return tl::unexpected(cleared.error());
    if (*cleared) connected = connect();
  }
  if (!connected && robot_.connected()) {
    // Outside of remote play a controller refuses what connecting writes: the mode is the reason then, not the refusal.
    if (auto ready = poll(Need::ready); !ready) return tl::unexpected(ready.error());
  }
  if (!connected && !(person_looked && connected.error().person_must_look)) return connected;
  if (person_looked)
    if (auto confirmed = robot_.confirm(seat_); !confirmed) return failed(confirmed.error(), "going on after a look");
  const auto state = poll(Need::ready);
  if (!state) return tl::unexpected(state.error());
  return {};
}

Or<bool> Arm::clear() {
  const auto state = robot_.state();
  if (!state) return false;  // connecting tells why
  const bool alarm = state->alarm || state->error;
  if (alarm)
    if (auto cleared = robot_.reset(); !cleared) return failed(cleared.error(), "clearing the alarm");
  if (state->hold_command)
    if (auto released = robot_.hold(false); !released) return failed(released.error(), "taking back the hold");
  return alarm || state->hold_command;
}

Or<void> Arm::start() {
  if (auto started = robot_.start(seat_); !started) return failed(started.error(), "starting the robot's job");
  return {};
}

Or<robot::RobotState> Arm::poll(Need need) {
  auto state = robot_.state();
  if (!state) return failed(state.error(), "reading the robot's state");
  auto pose = robot_.pose();
  // Refused: another tool is selected by hand. That hinders only who needs the place of this one, a camera on the arm.
  if (!pose && pose.error().code != core::ErrorCode::refused)
    return failed(pose.error(), "reading the robot's position");
  const auto last_mm = view_.tool_mm;
  view_ = view_of(*state, link_);
  view_.tool_mm = last_mm;
  for (int i = 0; pose && i < 3; ++i)
    view_.tool_mm[static_cast<std::size_t>(i)] = core::mm_from_m(pose->translation_m()(i));
  hindrance_ = hindrance_to_start(*state);
  const auto found = need == Need::nothing ? std::nullopt : need == Need::ready ? hindrance_ : hindrance_to_run(*state);
  if (found) return tl::unexpected(with_alarm_text(halt_from(*found)));
  return *state;
}

Halt Arm::with_alarm_text(Halt halt) {
  if (halt.code != "ROBOT_ALARM" && halt.code != "ROBOT_ERROR") return halt;
  const auto alarms = robot_.alarms();
  if (alarms && !alarms->empty()) halt.why += ": " + words(*alarms);
  return halt;
}

void Arm::hold() {
  if (auto held = robot_.hold(true); !held)
    core::log(core::LogLevel::warning, "cell", "the arm could not be told to hold: " + held.error().line());
}

}  // namespace pickcell::cell
