#include "pickcell/robot/readiness.hpp"

namespace pickcell::robot {

std::vector<Hindrance> hindrances(const RobotState& state) {
  std::vector<Hindrance> found;
  if (state.alarm) found.push_back({"the controller is in alarm", "remove the cause, then Reset"});
  if (state.error) found.push_back({"the controller is in error", "remove the cause, then Reset"});
  if (state.teach || !state.play) found.push_back({"the key switch stands on TEACH", "turn it to REMOTE"});
  if (!state.remote)
    found.push_back(
        {"command remote is not on", "turn the key to REMOTE and select command remote (pseudo-input screen)"});
  if (state.hold_pendant) found.push_back({"held from the pendant", "release HOLD on the pendant"});
  if (state.hold_external) found.push_back({"held by an external signal", "release the external hold input"});
  if (state.hold_command) found.push_back({"held by command", "Reset releases the hold"});
  return found;
}

}  // namespace pickcell::robot
