/// experiment table3: ten samples with the paper's template sizes, found, grasped and placed by the simulated cell.

#include "pickcell/cli/experiment/paper_sample.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <ostream>

#include "pickcell/cli/bench/plots.hpp"
#include "pickcell/cli/experiment/experiment.hpp"
#include "pickcell/cli/experiment/paper_grounds.hpp"
#include "pickcell/cli/machine.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"

namespace pickcell::cli {

const std::array<Sample, 10> kSamples = {{
    {"SP1", "gear_12", "turned metal", 80, 86, 0.169},
    {"SP2", "washer_notch", "turned metal", 86, 89, 0.227},
    {"SP3", "wooden_washer_tab", "wood", 88, 98, 0.136},
    {"SP4", "wooden_bracket_t", "wood", 140, 138, 0.263},
    {"SP5", "cam_disc", "turned metal", 98, 86, 0.074},
    {"SP6", "wrench_open", "brushed metal, long", 148, 151, 1.060},
    {"SP7", "wooden_lever_arm", "wood", 152, 143, 0.309},
    {"SP8", "metal_gear_24", "brushed metal", 130, 122, 0.558},
    {"SP9", "bracket_l", "brushed metal", 119, 122, 0.123},
    {"SP10", "wooden_hook_plate", "wood", 134, 130, 0.110},
}};

namespace {

using core::Json;
using Outcomes = std::map<std::string, std::vector<SampleOutcome>>;  ///< by engine, in the order of the samples

constexpr std::array<const char*, 2> kEngines = {"rst", "best"};

template <class... Args>
std::string text(const char* format, Args... args) {
  char out[200];
  std::snprintf(out, sizeof out, format, args...);
  return out;
}

std::string grasp_words(const SampleOutcome& o) {
  if (!o.placed || !o.place_mm)
    return text("not placed in %lld looks: ", static_cast<long long>(o.looks)) + o.end.substr(0, 80);
  return text("placed, %.2f mm, %.2f deg", *o.place_mm, o.place_deg.value_or(0));
}

const matches::StageReport* stage(const SampleOutcome& o, const std::string& name) {
  for (const auto& s : o.stages)
    if (s.stage == name) return &s;
  return nullptr;
}

std::string sample_table(const Outcomes& all, std::size_t count) {
  std::string out =
      "| sample | template | part | look | RST ms | RST grasp and place | best ms | best grasp and place | paper s |\n"
      "|---|---|---|---|---|---|---|---|---|\n";
  double rst = 0, best = 0, paper = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Sample& s = kSamples[i];
    const SampleOutcome &r = all.at("rst")[i], &b = all.at("best")[i];
    out += text("| %s | %dx%d | %s | %s", s.name, s.w, s.h, s.kind, s.look);
    out += text(" | %.2f | ", r.search_ms) + grasp_words(r) + text(" | %.2f | ", b.search_ms) + grasp_words(b);
    out += text(" | %.3f |\n", s.paper_s);
    rst += r.search_ms / static_cast<double>(count);
    best += b.search_ms / static_cast<double>(count);
    paper += s.paper_s / static_cast<double>(count);
  }
  return out + text("| mean | | | | %.2f | | %.2f | | %.4f |\n\n", rst, best, paper);
}

/// Where the time of each sample goes, relative to the mean of all: why SP6 is or is not slow.
std::string stage_words(const Outcomes& all, std::size_t count) {
  std::string out =
      "| sample | RST time / mean | candidates of RST into step 2 | 3 | 4 | survivors of 4 | paper's time / mean |\n"
      "|---|---|---|---|---|---|---|\n";
  double mean = 0, paper = 0;
  for (std::size_t i = 0; i < count; ++i) {
    mean += all.at("rst")[i].search_ms / static_cast<double>(count);
    paper += kSamples[i].paper_s / static_cast<double>(count);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const SampleOutcome& o = all.at("rst")[i];
    out += text("| %s | %.2f", kSamples[i].name, mean > 0 ? o.search_ms / mean : 0);
    for (const char* name : {"radial", "template", "robust", "merge"}) {
      const auto* s = stage(o, name);
      out += text(" | %lld", static_cast<long long>(s ? s->population : 0));
    }
    out += text(" | %.2f |\n", kSamples[i].paper_s / paper);
  }
  return out + "\n";
}

/// Bars of one figure per sample and engine.
NamedPlot plot_of(const std::string& file, const std::string& title, const std::string& subtitle,
                  const std::string& y_label, const Outcomes& all, std::size_t count,
                  double (*value)(const SampleOutcome&)) {
  Plot plot;
  plot.title = title;
  plot.subtitle = subtitle;
  plot.x = {"sample", -0.5, static_cast<double>(count) - 0.5, false, {}};
  for (std::size_t i = 0; i < count; ++i) plot.x.categories.emplace_back(kSamples[i].name);
  double hi = 0;
  for (std::size_t e = 0; e < kEngines.size(); ++e) {
    PlotSeries series{kEngines[e], {}, {}};
    for (std::size_t i = 0; i < count; ++i) {
      const double v = value(all.at(kEngines[e])[i]);
      const double x = static_cast<double>(i) - 0.4 + 0.4 * static_cast<double>(e);
      series.bars.push_back({x, x + 0.36, v, text("%.2f", v)});
      hi = std::max(hi, v);
    }
    plot.series.push_back(std::move(series));
  }
  plot.y = {y_label, 0, hi > 0 ? 1.15 * hi : 1, false, {}};
  return {file, plot};
}

core::Status write_all(const ExperimentOptions& options, const Outcomes& all, const std::string& report,
                       std::size_t count) {
  if (auto done = core::write_file_atomically(options.out / "table3.md", report); !done) return done;
  return write_plots(
      options.out,
      {plot_of("table3_time.svg", "Matching time of each sample", "one search of a 752 x 580 picture, one thread",
               "CPU ms", all, count, [](const SampleOutcome& o) { return o.search_ms; }),
       plot_of("table3_place.svg", "Place error of each sample", "the placed part against the truth; 0: not placed",
               "mm", all, count, [](const SampleOutcome& o) { return o.placed ? o.place_mm.value_or(0) : 0; }),
       plot_of("table3_turn.svg", "Turn error of each sample", "the placed part against the truth; 0: not placed",
               "degrees", all, count, [](const SampleOutcome& o) { return o.placed ? o.place_deg.value_or(0) : 0; })});
}

core::Result<int> run(const ExperimentOptions& options, Io& io) {
  const auto count = static_cast<std::size_t>(std::clamp(options.n.value_or(10), 1, 10));
  Outcomes all;
  Json json = Json::array();
  std::size_t placed = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Json row = Json::object().set("sample", kSamples[i].name).set("part", kSamples[i].kind);
    for (const char* engine : kEngines) {
      const bool paper = std::string_view(engine) == "rst";
      auto outcome =
          pick_sample(kSamples[i], engine, paper ? matches::Settings{{"scales", "0.9,1,1.1"}} : matches::Settings{},
                      options.out, options.seed + i);
      if (!outcome) return core::forward(outcome);
      placed += outcome->placed ? 1 : 0;
      Json one = Json::object().set("search_ms", outcome->search_ms).set("placed", outcome->placed);
      one.set("looks", outcome->looks).set("end", outcome->end);
      if (outcome->place_mm) one.set("place_mm", *outcome->place_mm).set("place_deg", outcome->place_deg.value_or(0));
      row.set(engine, std::move(one));
      all[engine].push_back(std::move(*outcome));
    }
    json.push(std::move(row));
  }
  const std::size_t asked = kEngines.size() * count;
  const std::string report = "Measured on " + machine() + ".\n\n" + sample_table(all, count) +
                             text("Placed %zu of %zu.\n\n", placed, asked) + stage_words(all, count);
  if (auto done = write_all(options, all, report, count); !done) return core::forward(done);
  std::string grounds;
  if (count == kSamples.size()) {  // a comparison of all of them
    auto searched = search_on_grounds(count, options.seed);
    if (!searched) return core::forward(searched);
    grounds = ground_table(*searched);
    if (auto done = core::write_file_atomically(options.out / "table3_grounds.md", grounds); !done)
      return core::forward(done);
  }
  io.out << (options.json ? json.dump() + "\n" : report + grounds);
  return placed == asked ? 0 : 1;
}

const ExperimentRegistration registered({"table3",
                                         "ten samples found, grasped and placed by the cell; --n: samples (10)", false,
                                         run});

}  // namespace
}  // namespace pickcell::cli
