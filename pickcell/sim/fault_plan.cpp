#include "pickcell/sim/fault_plan.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <utility>

#include "pickcell/sim/tcp80_commands.hpp"

namespace pickcell::sim {

namespace {

constexpr std::array<std::pair<std::string_view, Fault>, 12> kFaults{{{"drop", Fault::drop},
                                                                      {"double", Fault::twice},
                                                                      {"late", Fault::late},
                                                                      {"truncate", Fault::truncate},
                                                                      {"half_line", Fault::half_line},
                                                                      {"reset_after_ok", Fault::reset_after_ok},
                                                                      {"alarm", Fault::alarm},
                                                                      {"estop", Fault::estop},
                                                                      {"teach", Fault::teach},
                                                                      {"hold", Fault::hold},
                                                                      {"servo_off", Fault::servo_off},
                                                                      {"busy", Fault::busy}}};

void read_command(core::Config& table, FaultEvent& event) {
  const std::string given = table.text("after_command");
  const auto [end, error] = std::from_chars(given.data(), given.data() + given.size(), event.after_commands);
  if (error == std::errc{} && end == given.data() + given.size() && event.after_commands >= 1) return;
  event.after_commands = 0;
  event.after_command = given;
  if (!is_scenario_command(given))
    table.problem("after_command", "'" + given + "' is no command such as \"START\", and no number of commands");
}

FaultEvent read_event(core::Config& table) {
  FaultEvent event;
  const std::string name = table.string("fault");
  if (const auto known = fault(name))
    event.fault = *known;
  else
    table.problem("fault",
                  "is none of drop, double, late, truncate, half_line, reset_after_ok, alarm, estop, teach, "
                  "hold, servo_off, busy");
  if (table.has("at_s")) event.at_s = table.number("at_s");
  if (table.has("after_command")) read_command(table, event);
  if (event.at_s.has_value() == table.has("after_command"))
    table.problem("fault", "needs either at_s or after_command");
  event.count = static_cast<int>(table.integer_or("count", 1));
  event.mid_move = table.boolean_or("mid_move", false);
  event.delay_s = table.number_or("delay_s", event.delay_s);
  event.code = static_cast<int>(table.integer_or("code", event.code));
  constexpr double kLongest_s = 1e9;
  if (event.at_s && !(*event.at_s >= 0 && *event.at_s <= kLongest_s))
    table.problem("at_s", "must be between 0 and 1e9");
  if (event.count < 1 || event.count > 1'000'000) table.problem("count", "must be 1 or more");
  if (event.delay_s < 0 || event.delay_s > 3600) table.problem("delay_s", "must be between 0 and 3600");
  if (event.code < 1 || event.code > 9999) table.problem("code", "must be an alarm number 1-9999");
  return event;
}

}  // namespace

std::optional<Fault> fault(std::string_view name) {
  for (const auto& [known, value] : kFaults)
    if (known == name) return value;
  return std::nullopt;
}

bool is_scenario_command(std::string_view name) {
  // HSES commands that have no counterpart, as hses_command_name() writes them.
  static constexpr std::array<std::string_view, 6> kNumbers{"0x71", "0x74", "0x76", "0x77", "0x88", "0x89"};
  static constexpr std::array<std::string_view, 5> kOthers{"FILE", "MOTIONCTRL", "JOINTTRAJPT", "MOTOROSIO", "MOTOROS"};
  return is_tcp80_command(name) || std::find(kNumbers.begin(), kNumbers.end(), name) != kNumbers.end() ||
         std::find(kOthers.begin(), kOthers.end(), name) != kOthers.end();
}

bool of_answer(Fault fault) { return fault <= Fault::reset_after_ok; }

core::Result<std::vector<FaultEvent>> parse_scenario(core::Config& config) {
  std::vector<FaultEvent> events;
  for (core::Config& table : config.tables("event")) events.push_back(read_event(table));
  if (auto status = config.finish(); !status) return core::forward(status);
  return events;
}

std::vector<FaultEvent> FaultPlan::due(double elapsed_s, bool moving) {
  std::vector<FaultEvent> found;
  for (FaultEvent& event : events_) {
    if (!event.at_s || elapsed_s < *event.at_s || event.count == 0) continue;
    (event.mid_move ? waiting_for_a_move_ : found).push_back(event);
    event.count = 0;
  }
  if (moving) {
    found.insert(found.end(), waiting_for_a_move_.begin(), waiting_for_a_move_.end());
    waiting_for_a_move_.clear();
  }
  return found;
}

std::vector<FaultEvent> FaultPlan::after(std::string_view command) {
  ++commands_;
  std::vector<FaultEvent> found;
  for (FaultEvent& event : events_) {
    const bool named = !event.after_command.empty() && event.after_command == command;
    const bool counted = event.after_commands > 0 && commands_ >= event.after_commands;
    if ((!named && !counted) || event.count == 0) continue;
    --event.count;
    FaultEvent now = event;
    now.count = 1;
    (event.mid_move ? waiting_for_a_move_ : found).push_back(now);
  }
  return found;
}

}  // namespace pickcell::sim
