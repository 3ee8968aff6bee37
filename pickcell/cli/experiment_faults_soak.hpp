#pragma once
/// The fault soak: the arm's driver with its journal against the simulated controller on a real socket, every fault of
/// the list injected at random, a person who puts things right. Vision is left out: the parts lie where they are known
/// to lie, so that thousands of picks take minutes.

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"

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

enum class SoakProtocols { tcp80, hses, both };

struct FaultSoakOptions {
  int picks = 10'000;
  std::uint64_t seed = 1;
  SoakProtocols protocols = SoakProtocols::both;  ///< both: chosen anew at every start of the PC
  std::filesystem::path folder;                   ///< the journal lies there; one of an earlier run is removed
  /// Wall time that the driver waits for an answer. Small: every lost answer costs it.
  std::chrono::milliseconds answer_timeout{60};
  double fault_rate = 0.6;            ///< share of the picks that get a fault
  double outside_rate = 0.03;         ///< share that is preceded by a pick outside the box, which must be refused
  std::function<void(int)> progress;  ///< called now and then with the number of parts dealt with; may be empty
};

/// What happened. The four numbers that must be 0: twice, lost, forbidden_motions, stops - stops_explained.
struct FaultSoakReport {
  int parts = 0;      ///< dealt with: done, refused or unknown
  int submitted = 0;  ///< hand-overs begun; more than parts, because a withdrawn pick is tried again
  int over_hses = 0;  ///< of them; the others over TCP 80
  int done = 0, refused = 0, unknown = 0, withdrawn = 0;
  std::array<int, kSoakFaults> injected{};
  int outside_refused = 0;  ///< picks outside the box: refused before a byte was sent
  int stops = 0, stops_explained = 0;
  int pc_starts = 0;
  int executed_twice = 0;
  int lost = 0;  ///< grips that no row accounts for, rows left open, done without a grip, void with one, told twice
  int forbidden_motions = 0;          ///< motion after a refusal or a stop, or of the tool outside the box
  std::vector<std::string> findings;  ///< one line for each of the above, at most 20
  double simulated_s = 0, wall_s = 0;

  [[nodiscard]] bool holds() const {
    return executed_twice == 0 && lost == 0 && forbidden_motions == 0 && stops == stops_explained;
  }
};

/// Errors: unreadable (journal folder), link (no port), timeout (the cell does not come out of a stop).
[[nodiscard]] core::Result<FaultSoakReport> run_fault_soak(const FaultSoakOptions& options);

}  // namespace pickcell::cli
