// pickcell experiment faults: thousands of picks with every fault of the list injected at random.

#include <cstdio>
#include <ostream>
#include <sstream>

#include "pickcell/cli/experiment/experiment.hpp"
#include "pickcell/cli/experiment/faults_soak.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"

namespace pickcell::cli {

namespace {

std::string fault_words(int i) {
  return i == kSoakFaults ? "none (that of the pick before struck late)" : name(static_cast<SoakFault>(i));
}

std::string table(const FaultSoakReport& r) {
  std::ostringstream out;
  const auto line = [&](const std::string& what, int count) {
    char text[64];
    std::snprintf(text, sizeof text, "%8d  ", count);
    out << text << what << '\n';
  };
  line("parts dealt with", r.parts);
  line("hand-overs begun (a withdrawn pick is tried again)", r.submitted);
  line("  over TCP 80", r.submitted - r.over_hses);
  line("  over HSES", r.over_hses);
  line("  done", r.done);
  line("  refused by the job (nothing gripped, lost on the way)", r.refused);
  line("  unknown: a person was asked to look", r.unknown);
  line("  withdrawn before the arm took them", r.withdrawn);
  out << "unknown, by the fault of the pick:\n";
  for (int i = 0; i <= kSoakFaults; ++i) line("  " + fault_words(i), r.unknown_after[static_cast<std::size_t>(i)]);
  out << "unknown, by what truly happened:\n";
  line("  not gripped yet", r.unknown_untouched);
  line("  gripped and not placed", r.unknown_in_between);
  line("  placed", r.unknown_placed);
  line("pictures searched", r.looks);
  line("picks outside the box, refused before a byte was sent", r.outside_refused);
  line("starts of the PC", r.pc_starts);
  out << "faults injected:\n";
  for (int i = 0; i < kSoakFaults; ++i)
    line("  " + std::string(name(static_cast<SoakFault>(i))), r.injected[static_cast<std::size_t>(i)]);
  out << "stops explained: " << r.stops_explained << " of " << r.stops << '\n';
  out << "picks executed twice: " << r.executed_twice << '\n';
  out << "lost from the record: " << r.lost << '\n';
  out << "motions after a refusal or outside the box: " << r.forbidden_motions << '\n';
  for (const std::string& finding : r.findings) out << "  ! " << finding << '\n';
  char text[96];
  std::snprintf(text, sizeof text, "%.1f h of the cell's time in %.0f s\n", r.simulated_s / 3600, r.wall_s);
  return out.str() + text;
}

std::string json(const FaultSoakReport& r, std::uint64_t seed) {
  core::Json injected = core::Json::object();
  for (int i = 0; i < kSoakFaults; ++i)
    injected.set(name(static_cast<SoakFault>(i)), r.injected[static_cast<std::size_t>(i)]);
  core::Json line = core::Json::object();
  line.set("experiment", "faults").set("seed", static_cast<std::int64_t>(seed)).set("parts", r.parts);
  line.set("submitted", r.submitted)
      .set("over_hses", r.over_hses)
      .set("done", r.done)
      .set("refused", r.refused)
      .set("unknown", r.unknown);
  core::Json unknown_after = core::Json::object();
  for (int i = 0; i <= kSoakFaults; ++i)
    unknown_after.set(i == kSoakFaults ? "none" : name(static_cast<SoakFault>(i)),
                      r.unknown_after[static_cast<std::size_t>(i)]);
  line.set("unknown_after", std::move(unknown_after))
      .set("unknown_untouched", r.unknown_untouched)
      .set("unknown_in_between", r.unknown_in_between)
      .set("unknown_placed", r.unknown_placed);
  line.set("withdrawn", r.withdrawn)
      .set("looks", r.looks)
      .set("outside_refused", r.outside_refused)
      .set("pc_starts", r.pc_starts);
  line.set("injected", std::move(injected)).set("stops", r.stops).set("stops_explained", r.stops_explained);
  line.set("executed_twice", r.executed_twice).set("lost", r.lost).set("forbidden_motions", r.forbidden_motions);
  line.set("findings", core::Json(r.findings)).set("simulated_s", r.simulated_s).set("wall_s", r.wall_s);
  return line.set("holds", r.holds()).dump();
}

core::Result<int> run(const ExperimentOptions& options, Io& io) {
  FaultSoakOptions soak;
  soak.picks = options.n.value_or(soak.picks);
  soak.seed = options.seed;
  soak.folder = options.out;
  soak.progress = [&io](int n) {
    if (n % 1000 == 0) io.err << "pickcell: faults: " << n << " parts" << std::endl;
  };
  auto report = run_fault_soak(soak);
  if (!report) return core::forward(report);
  const std::string text = table(*report), record = json(*report, options.seed);
  if (auto written = core::write_file_atomically(options.out / "faults.txt", text); !written)
    return core::forward(written);
  if (auto written = core::write_file_atomically(options.out / "faults.json", record + "\n"); !written)
    return core::forward(written);
  io.out << (options.json ? record + "\n" : text);
  return report->holds() ? 0 : 1;
}

const ExperimentRegistration registered({"faults", "picks with every fault injected at random; --n parts (10000)",
                                         false, run});

}  // namespace

}  // namespace pickcell::cli
