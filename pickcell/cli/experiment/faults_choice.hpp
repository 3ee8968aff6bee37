#pragma once
/// What the fault soak injects, and whether the cell's words name it.

#include <initializer_list>
#include <optional>
#include <random>
#include <string>

#include "pickcell/sim/fault_plan.hpp"

namespace pickcell::cli {

/// What is injected. The first eleven are those of a scenario file.
enum class SoakFault {
  drop,
  twice,
  late,
  truncate,
  half_line,
  reset_after_ok,
  alarm,
  estop,
  teach,
  hold,
  servo_off,
  power_loss,         ///< the controller loses power at any moment
  pc_restart,         ///< the PC's process ends at any moment between two of its calls
  pc_dies_at_journal  ///< the PC's process ends right before or after a commit of its journal
};
constexpr int kSoakFaults = 14;
[[nodiscard]] const char* name(SoakFault fault);

/// What stopped the cell, in its words.
struct Stop {
  std::string code, why, remedy;
};
[[nodiscard]] bool explains(const Stop& stop, SoakFault fault);

/// Random numbers that are the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  int below(int n) { return static_cast<int>(random_() % static_cast<std::uint64_t>(n)); }
  double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  bool chance(double p) { return unit() < p; }

 private:
  std::mt19937_64 random_;
};

/// The fault as a scenario's event, some time within the next pick; empty for those that are none.
[[nodiscard]] std::optional<sim::FaultEvent> scenario_event(SoakFault fault, Dice& dice);
/// A pick takes about so long, and so many commands.
constexpr double kPickLength_s = 4;
constexpr int kCommandsOfAPick = 150;

}  // namespace pickcell::cli
