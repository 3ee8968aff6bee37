#include "pickcell/cli/cell/run.hpp"

#include <chrono>
#include <ostream>

#include "pickcell/cli/cell/report.hpp"
#include "pickcell/cli/process.hpp"
#ifdef PICKCELL_WITH_SERVER
#include "pickcell/server/server.hpp"
#endif

namespace pickcell::cli {

using core::ErrorCode;
using core::failure;

namespace {

/// 1: everything works, and the picks failed all the same; 3: a device or link failed.
int exit_code_of(const std::string& fault) {
  for (const char* failed_picks : {"REFUSED_IN_ROW", "OUTCOME_UNKNOWN", "CALIBRATION"})
    if (fault == failed_picks) return 1;
  return 3;
}

core::Result<int> run_for_picks(const CellRun& run, Io& io) {
  auto setup = set_up_cell(run.file, {run.picks});
  if (!setup) return core::forward(setup);
  const auto wall_start = std::chrono::steady_clock::now();
  const core::TimePoint start = setup->clock->now();
  setup->cell->open();
  setup->cell->wait_until_done();
  const core::TimePoint end = setup->clock->now();
  setup->cell->close();

  CellReport report;
  report.asked = run.picks;
  const cell::Snapshot last = setup->cell->snapshot();
  report.counters = last.counters;
  report.match_ms = setup->cell->ledger().match_ms();
  report.cycle_s = setup->cell->ledger().cycle_s();
  report.sim_seconds = core::seconds(end - start);
  report.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start).count();
  report.limit_mm = run.file.cell.limits.place_mm;
  report.limit_deg = run.file.cell.limits.place_deg;
  report.end = last.reason;
  report.run = setup->cell->ledger().run_folder().string();
  if (setup->plant && setup->plant->controller)
    report.places = judge_places(setup->plant->world, end, setup->cell->settings().planner);
  io.out << (run.json ? report.json().dump() + "\n" : report.words());
  io.out.flush();
  if (last.mode == cell::Mode::fault) return exit_code_of(last.reason_code);  // the cell's log has said why
  return report.good() ? 0 : 1;
}

core::Result<int> run_with_page([[maybe_unused]] const CellRun& run, [[maybe_unused]] Io& io) {
#ifdef PICKCELL_WITH_SERVER
  const StopSignals signals;
  auto setup = set_up_cell(run.file, {});
  if (!setup) return core::forward(setup);
  server::ServerSettings settings;
  settings.listen = run.listen.value_or(run.file.cell.listen);
  settings.web_root = run.web_root;
  server::Server server(settings, *setup->cell);
  if (auto started = server.start(); !started) return core::forward(started);
  setup->cell->open();
  if (run.file.cell.record_frames)
    io.err << "pickcell: recording into " << setup->cell->ledger().run_folder().string() << std::endl;
  io.err << "pickcell: ready at " << server.url() << " (Ctrl-C ends)" << std::endl;
  signals.wait();
  server.stop();
  setup->cell->close();
  return 0;
#else
  return failure(ErrorCode::usage, "serve", "this build has no HMI server",
                 "give --picks N, or build with PICKCELL_WITH_SERVER");
#endif
}

}  // namespace

core::Status check_page_or_picks(std::int64_t picks, bool json, const std::string& listen,
                                 const std::string& web_root) {
  if (json && picks == 0)
    return failure(ErrorCode::usage, "--json", "there is a report with --picks only", "give --picks N too");
  if (picks > 0 && !(listen.empty() && web_root.empty()))
    return failure(ErrorCode::usage, listen.empty() ? "--web-root" : "--listen", "with --picks there is no page",
                   "leave one of the two out");
  return {};
}

core::Result<int> run_cell(const CellRun& run, Io& io) {
  const LogOnErr log(io.err);
  return run.picks > 0 ? run_for_picks(run, io) : run_with_page(run, io);
}

}  // namespace pickcell::cli
