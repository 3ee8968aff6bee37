#pragma once
/// The fault soak: the whole demonstration cell (picture, match, pose, plan, hand-over, journal, driver) on a simulated
/// clock against the simulated controller on a real socket, every fault of the list injected at random, a person who
/// puts things right.

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pickcell/cli/experiment/faults_choice.hpp"
#include "pickcell/core/result.hpp"

namespace pickcell::cli {

enum class SoakProtocols { tcp80, hses, both };

struct FaultSoakOptions {
  int picks = 10'000;
  std::uint64_t seed = 1;
  SoakProtocols protocols = SoakProtocols::both;  ///< both: chosen anew at every start of the PC
  std::filesystem::path folder;                   ///< the cell is made anew in its subfolder "cell"
  /// Wall time that the driver waits for an answer. Small: every lost answer costs it.
  std::chrono::milliseconds answer_timeout{60};
  double fault_rate = 0.6;            ///< share of the picks that get a fault
  double blind_rate = 0.02;           ///< share whose grip sensor sees nothing: the job refuses them
  std::function<void(int)> progress;  ///< called now and then with the number of parts dealt with; may be empty
};

/// What happened. The four numbers that must be 0: twice, lost, forbidden_motions, stops - stops_explained.
struct FaultSoakReport {
  int parts = 0;      ///< dealt with: done, refused or unknown
  int submitted = 0;  ///< hand-overs begun; more than parts, because a withdrawn pick is tried again
  int looks = 0;      ///< pictures that were searched
  int over_hses = 0;  ///< of them; the others over TCP 80
  int done = 0, refused = 0, unknown = 0, withdrawn = 0;
  /// The unknown ones by the fault of their pick, last: without one (a fault of the pick before struck late).
  std::array<int, kSoakFaults + 1> unknown_after{};
  /// Of them by what truly happened: nothing gripped yet, gripped and not put down where it belongs, placed.
  int unknown_untouched = 0, unknown_in_between = 0, unknown_placed = 0;
  std::array<int, kSoakFaults> injected{};
  int outside_refused = 0;  ///< picks outside the box, one at every start of the PC: refused, nothing sent
  int stops = 0, stops_explained = 0;
  int pc_starts = 0;
  int executed_twice = 0;
  int lost = 0;               ///< grips that no row accounts for, rows left open, done without a grip, void with one
  int forbidden_motions = 0;  ///< motion after a refusal or a stop, of the tool outside the box, grips of nothing
  std::vector<std::string> findings;  ///< one line for each of the above, at most 20
  double simulated_s = 0, wall_s = 0;

  void note(const std::string& text) {
    constexpr std::size_t kMost = 20;
    if (findings.size() < kMost) findings.push_back(text);
  }
  void finding(int& count, const std::string& text) {
    ++count;
    note(text);
  }
  [[nodiscard]] bool holds() const {
    return executed_twice == 0 && lost == 0 && forbidden_motions == 0 && stops == stops_explained;
  }
};

/// Errors: unreadable (journal folder), link (no port), timeout (the cell does not come out of a stop).
[[nodiscard]] core::Result<FaultSoakReport> run_fault_soak(const FaultSoakOptions& options);

}  // namespace pickcell::cli
