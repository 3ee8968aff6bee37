#include "pickcell/sim/motoros_door.hpp"

#include <utility>

#include "pickcell/sim/controller_contacts.hpp"
#include "pickcell/sim/motoros_io.hpp"

namespace pickcell::sim {

namespace moto = robot::moto;
using robot::MotoFrame;

namespace {

/// Bits and groups may come to the motion port too.
bool io_for_the_motion_port(const MotoFrame& message) {
  return message.type >= moto::kReadBit && message.type <= moto::kWriteGroupReply;
}

}  // namespace

MotoRosDoor::MotoRosDoor(MotoRosDoorSettings settings, MotoRosSettings motion, WithState with_state,
                         Commanded commanded, AnswerFaults& faults)
    : with_state_(std::move(with_state)),
      commanded_(std::move(commanded)),
      motion_(motion),
      server_(std::move(settings), *this, faults) {}

MotoRosAnswer MotoRosDoor::motion(const MotoFrame& message) {
  MotoRosAnswer answer;
  with_state_([&](ControllerState& state) {
    answer = io_for_the_motion_port(message) ? MotoRosAnswer{execute_motoros_io(state, message), false, false}
                                             : motion_.handle(state, message);
    commanded_(state, motoros_command_name(message));
  });
  return answer;
}

MotoFrame MotoRosDoor::io(const MotoFrame& message) {
  MotoFrame answer;
  with_state_([&](ControllerState& state) {
    answer = execute_motoros_io(state, message);
    commanded_(state, motoros_command_name(message));
  });
  return answer;
}

std::optional<MotoFrame> MotoRosDoor::waited() {
  std::optional<MotoFrame> answer;
  with_state_([&](ControllerState& state) { answer = motion_.waited(state); });
  return answer;
}

bool MotoRosDoor::holds_motion() {
  bool holds = false;
  with_state_([&](ControllerState&) { holds = motion_.holds_motion(); });
  return holds;
}

void MotoRosDoor::motion_host_left() {
  with_state_([&](ControllerState&) { motion_.host_left(); });
}

std::array<MotoFrame, 2> MotoRosDoor::state() {
  std::array<MotoFrame, 2> pair;
  with_state_([&](ControllerState& state) {
    pair = {moto_frame(MotoRosMotion::feedback(state)), moto_frame(motion_.status(state))};
  });
  return pair;
}

void MotoRosDoor::connected(const std::array<int, 3>& hosts) {
  with_state_([&](ControllerState& state) {
    set_output(state, kMotoRosInitDone, true);
    set_output(state, kMotoRosServing, true);
    set_output(state, kMotoRosMotionConnected, hosts[0] > 0);
    set_output(state, kMotoRosStateConnected, hosts[1] > 0);
    set_output(state, kMotoRosIoConnected, hosts[2] > 0);
  });
}

}  // namespace pickcell::sim
