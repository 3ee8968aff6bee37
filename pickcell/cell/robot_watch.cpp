#include "pickcell/cell/robot_watch.hpp"

namespace pickcell::cell {

using robot::RobotState;

std::optional<Hindrance> hindrance_to_start(const RobotState& state) {
  if (state.teach || !state.play)
    return Hindrance{"ROBOT_TEACH", "the arm is in teach mode", "turn the pendant's key to PLAY, then press Reset"};
  if (!state.remote)
    return Hindrance{"ROBOT_NOT_REMOTE", "command remote is not set on the controller",
                     "turn the key to REMOTE and allow command remote, then press Reset"};
  if (state.hold_pendant)
    return Hindrance{"ROBOT_HELD", "the arm is held from the pendant", "release HOLD on the pendant, then press Reset"};
  if (state.hold_external)
    return Hindrance{"ROBOT_HELD", "the arm is held by an external signal",
                     "find what asks for the hold (gate, light curtain), release it, then press Reset"};
  if (state.hold_command)
    return Hindrance{"ROBOT_HELD", "the arm is held by command", "press Reset: it takes back the hold"};
  if (state.alarm)
    return Hindrance{"ROBOT_ALARM", "the controller is in alarm",
                     "remove the cause (see the alarm text), then press Reset; major alarms are reset at the pendant"};
  if (state.error)
    return Hindrance{"ROBOT_ERROR", "the controller reports an error", "press Reset; see the pendant for its text"};
  if (state.step)
    return Hindrance{"ROBOT_STEP", "the controller is in step mode", "choose the automatic cycle, then press Reset"};
  return std::nullopt;
}

std::optional<Hindrance> hindrance_to_run(const RobotState& state) {
  if (auto found = hindrance_to_start(state)) return found;
  if (!state.servo)
    return Hindrance{"ROBOT_SERVO_OFF", "servo power is off (emergency stop, door or power)",
                     "release the emergency stop, close the door, then press Reset and Start"};
  if (!state.running)
    return Hindrance{"ROBOT_STOPPED", "the job on the controller does not run", "press Reset, then Start"};
  return std::nullopt;
}

std::string words(const RobotState& state) {
  std::string out = state.teach ? "teach" : state.play ? "play" : "no mode";
  out += state.remote ? ", remote" : ", local";
  out += state.servo ? ", servo on" : ", servo off";
  if (state.running) out += ", running";
  if (state.hold_pendant) out += ", held from the pendant";
  if (state.hold_external) out += ", held by an external signal";
  if (state.hold_command) out += ", held by command";
  if (state.alarm) out += ", alarm";
  if (state.error) out += ", error";
  if (state.step) out += ", step";
  if (state.speed_limited) out += ", speed limited";
  return out;
}

RobotView view_of(const RobotState& state, const std::string& link) {
  RobotView view;
  view.connected = true;
  view.link = link;
  view.words = words(state);
  view.running = state.running;
  view.servo = state.servo;
  view.remote = state.remote;
  view.held = state.held();
  view.alarm = state.alarm || state.error;
  view.teach = state.teach;
  return view;
}

std::string words(const std::vector<robot::Alarm>& alarms) {
  std::string out;
  for (const robot::Alarm& alarm : alarms) {
    if (!out.empty()) out += ", ";
    out += std::to_string(alarm.code);
    if (!alarm.text.empty()) out += " (" + alarm.text + ")";
  }
  return out;
}

}  // namespace pickcell::cell
