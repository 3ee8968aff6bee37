/// experiment table3: ten samples with the paper's template sizes, found, grasped and placed by the simulated cell.

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <ostream>

#include "pickcell/cli/cell_report.hpp"
#include "pickcell/cli/cell_setup.hpp"
#include "pickcell/cli/experiment.hpp"
#include "pickcell/cli/start_demo.hpp"
#include "pickcell/core/clock.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/core/statistics.hpp"

namespace pickcell::cli {
namespace {

namespace fs = std::filesystem;

/// The paper's sample, the simulated part in its template, and the paper's time.
struct Sample {
  const char* name;
  const char* kind;
  int w, h;
  double paper_s;
};
constexpr std::array<Sample, 10> kSamples = {{
    {"SP1", "gear_12", 80, 86, 0.169},
    {"SP2", "washer_notch", 86, 89, 0.227},
    {"SP3", "washer_tab", 88, 98, 0.136},
    {"SP4", "bracket_t", 140, 138, 0.263},
    {"SP5", "cam_disc", 98, 86, 0.074},
    {"SP6", "wrench_open", 148, 151, 1.060},
    {"SP7", "lever_arm", 152, 143, 0.309},
    {"SP8", "gear_24", 130, 122, 0.558},
    {"SP9", "bracket_l", 119, 122, 0.123},
    {"SP10", "label_box", 134, 130, 0.110},
}};

struct Outcome {
  double match_ms = 0;
  std::int64_t placed = 0, frames = 0;
  std::optional<double> place_mm, place_deg;
  std::string end;
};

core::Result<Outcome> pick_one(const Sample& sample, const std::string& engine, const fs::path& out,
                               std::uint64_t seed) {
  const fs::path folder = out / (std::string(sample.name) + "_" + engine);
  std::error_code ignored;
  fs::remove_all(folder, ignored);  // a journal of an earlier run would resume it
  DemoOptions demo;
  demo.seed = seed;
  demo.now_unix_us = core::RealClock().unix_us();
  demo.kinds = {sample.kind};
  demo.camera_width_px = 752;
  demo.camera_height_px = 580;
  demo.parts_per_pitch = 1;
  demo.template_px = DemoOptions::TemplateSize{sample.w, sample.h};
  auto path = prepare_demo(folder, demo);
  if (!path) return core::forward(path);
  auto file = load_cell_file(*path);
  if (!file) return core::forward(file);
  CellRunOptions how;
  how.engine = engine;
  if (engine != "best") how.engine_settings = {{"scales", "0.9,1,1.1"}};
  how.stop_after_picks = 1;
  auto setup = set_up_cell(*file, how);
  if (!setup) return core::forward(setup);
  setup->cell->open();
  setup->cell->wait_until_done();
  const core::TimePoint end = setup->clock->now();
  setup->cell->close();
  Outcome result;
  const cell::Snapshot last = setup->cell->snapshot();
  result.placed = last.counters.placed;
  result.frames = last.counters.frames;
  result.match_ms = core::median(setup->cell->ledger().match_ms()).value_or(0);
  result.end = last.reason;
  const PlaceErrors places = judge_places(setup->plant->world, end, setup->cell->settings().planner);
  result.place_mm = core::median(places.mm);
  result.place_deg = core::median(places.deg);
  return result;
}

std::string row_of(const Outcome& o) {
  char out[120];
  if (o.placed > 0 && o.place_mm)
    std::snprintf(out, sizeof out, " | %.2f | placed, %.2f mm, %.2f deg", o.match_ms, *o.place_mm,
                  o.place_deg.value_or(0));
  else
    std::snprintf(out, sizeof out, " | %.2f | not placed (%s)", o.match_ms, o.end.substr(0, 60).c_str());
  return out;
}

core::Result<int> run(const ExperimentOptions& options, Io& io) {
  std::string report =
      "| sample | template | part | RST ms | RST grasp and place | best ms | best grasp and place | paper s |\n"
      "|---|---|---|---|---|---|---|---|\n";
  core::Json json = core::Json::array();
  int placed = 0, asked = 0;
  const auto count = static_cast<std::size_t>(std::clamp(options.n.value_or(10), 1, 10));
  for (std::size_t i = 0; i < count; ++i) {
    const Sample& s = kSamples[i];
    char head[120];
    std::snprintf(head, sizeof head, "| %s | %dx%d | %s", s.name, s.w, s.h, s.kind);
    report += head;
    core::Json row = core::Json::object().set("sample", s.name).set("part", s.kind);
    for (const char* engine : {"rst", "best"}) {
      auto outcome = pick_one(s, engine, options.out, options.seed + i);
      if (!outcome) return core::forward(outcome);
      ++asked;
      placed += outcome->placed > 0 ? 1 : 0;
      report += row_of(*outcome);
      core::Json one = core::Json::object().set("match_ms", outcome->match_ms).set("placed", outcome->placed > 0);
      one.set("frames", outcome->frames);
      if (outcome->place_mm) one.set("place_mm", *outcome->place_mm).set("place_deg", outcome->place_deg.value_or(0));
      row.set(engine, std::move(one));
    }
    char tail[40];
    std::snprintf(tail, sizeof tail, " | %.3f |\n", s.paper_s);
    report += tail;
    json.push(std::move(row));
  }
  report += "\nPlaced " + std::to_string(placed) + " of " + std::to_string(asked) + ".\n";
  if (auto done = core::write_file_atomically(options.out / "table3.md", report); !done) return core::forward(done);
  io.out << (options.json ? json.dump() + "\n" : report);
  return placed == asked ? 0 : 1;
}

const ExperimentRegistration registered({"table3",
                                         "ten samples found, grasped and placed by the cell; --n: samples (10)", false,
                                         run});

}  // namespace
}  // namespace pickcell::cli
