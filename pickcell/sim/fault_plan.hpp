#pragma once
/// Faults that a scenario file orders (docs/interfaces.md, `pickcell sim --scenario`).

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pickcell/core/config.hpp"
#include "pickcell/core/result.hpp"

namespace pickcell::sim {

enum class Fault {
  drop,
  twice,
  late,
  truncate,
  half_line,
  reset_after_ok,  // of answers
  alarm,
  estop,
  teach,
  hold,
  servo_off,  // of the controller
  busy        // HSES: refused with D8F1 (files E444) and not carried out
};
[[nodiscard]] std::optional<Fault> fault(std::string_view name);
/// True when the fault is one of an answer on the wire.
[[nodiscard]] bool of_answer(Fault fault);

/// One `[[event]]`. Due at a time or after commands; `at_s` counts from the start of the controller on its clock.
struct FaultEvent {
  Fault fault = Fault::drop;
  std::optional<double> at_s;
  std::string after_command;  ///< `after_command = "START"`: with such a command, `count` times
  int after_commands = 0;     ///< `after_command = 12`: with the 12th command of any kind, `count` in a row
  int count = 1;              ///< how often: answers spoilt, or times the event happens
  bool mid_move = false;      ///< when due, wait until the arm moves
  double delay_s = 2;         ///< of a late answer
  int code = 4107;            ///< of an alarm
};

/// Commands go by the names of TCP 80; FILE, HSES numbers without such a name (0x89) and MotoROS messages besides.
[[nodiscard]] bool is_scenario_command(std::string_view name);

/// Errors: unknown faults, commands and keys, events without a time, times before 0.
[[nodiscard]] core::Result<std::vector<FaultEvent>> parse_scenario(core::Config& config);

/// Which events are due. Not thread-safe.
class FaultPlan {
 public:
  explicit FaultPlan(std::vector<FaultEvent> events) : events_(std::move(events)) {}
  void add_for_next_move(FaultEvent event) { waiting_for_a_move_.push_back(std::move(event)); }
  [[nodiscard]] std::vector<FaultEvent> due(double elapsed_s, bool moving);
  /// To be asked once per command. An event of an answer applies to this command's own.
  [[nodiscard]] std::vector<FaultEvent> after(std::string_view command);

 private:
  std::vector<FaultEvent> events_;
  std::vector<FaultEvent> waiting_for_a_move_;
  int commands_ = 0;
};

}  // namespace pickcell::sim
