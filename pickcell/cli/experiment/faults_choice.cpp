#include "pickcell/cli/experiment/faults_choice.hpp"

#include <array>

namespace pickcell::cli {

namespace {

bool mentions(const Stop& stop, std::initializer_list<const char*> words) {
  for (const char* word : words)
    if (stop.why.find(word) != std::string::npos || stop.code == word) return true;
  return false;
}

bool of_the_answer(SoakFault fault) { return fault <= SoakFault::reset_after_ok; }
bool of_the_state(SoakFault fault) { return fault >= SoakFault::alarm && fault <= SoakFault::servo_off; }

}  // namespace

const char* name(SoakFault fault) {
  static constexpr std::array<const char*, kSoakFaults> kNames = {
      "drop",  "double", "late", "truncate",  "half_line",  "reset_after_ok", "alarm",
      "estop", "teach",  "hold", "servo_off", "power_loss", "pc_restart",     "pc_dies_at_journal"};
  return kNames[static_cast<std::size_t>(fault)];
}

bool explains(const Stop& stop, SoakFault fault) {
  const bool link = stop.code == "LINK_LOST" || stop.code == "LINK_TIMEOUT";
  switch (fault) {
    case SoakFault::alarm:
      return mentions(stop, {"ROBOT_ALARM", "2060", "alarm"});
    case SoakFault::estop:
    case SoakFault::servo_off:
      return mentions(stop, {"ROBOT_SERVO_OFF", "3010", "2070", "3450"});
    case SoakFault::teach:
      return mentions(stop, {"ROBOT_TEACH", "2100", "2080", "TEACH"});
    case SoakFault::hold:
      return mentions(stop, {"ROBOT_HELD", "2020", "held"});
    case SoakFault::power_loss:
    case SoakFault::pc_restart:
    case SoakFault::pc_dies_at_journal:
      return link || mentions(stop, {"OUTCOME_UNKNOWN", "unknown", "ROBOT_STOPPED", "ROBOT_SERVO_OFF"});
    default:
      return link;
  }
}

std::optional<sim::FaultEvent> scenario_event(SoakFault fault, Dice& dice) {
  if (!of_the_answer(fault) && !of_the_state(fault)) return std::nullopt;
  sim::FaultEvent event;
  event.fault = static_cast<sim::Fault>(fault);
  event.delay_s = 0.005 + 0.3 * dice.unit();
  if (of_the_state(fault) && dice.chance(0.5)) {
    event.at_s = dice.unit() * kPickLength_s;
    event.mid_move = dice.chance(0.5);
  } else {
    event.after_commands = 1 + dice.below(kCommandsOfAPick);
  }
  return event;
}

}  // namespace pickcell::cli
