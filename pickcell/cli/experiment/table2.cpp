/// experiment table2: time and accuracy by template size, as in Tables I and II of the paper.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ostream>

#include "pickcell/cli/bench/plots.hpp"
#include "pickcell/cli/experiment/experiment.hpp"
#include "pickcell/cli/experiment/paper_set.hpp"
#include "pickcell/cli/experiment/paper_table.hpp"
#include "pickcell/cli/machine.hpp"
#include "pickcell/cli/yardstick.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/core/statistics.hpp"

namespace pickcell::cli {
namespace {

namespace fs = std::filesystem;
using core::Json;

std::string number(const char* format, double v) {
  char out[40];
  std::snprintf(out, sizeof out, format, v);
  return out;
}

NamedPlot plot_of(const std::string& file, const std::string& title, const PaperTable& table) {
  Plot plot;
  plot.title = title;
  plot.subtitle = "mean time of one search, one thread";
  plot.x = {"template size", -0.5, 2.5, false, {kPaperSizes.begin(), kPaperSizes.end()}};
  double lo = 1e9, hi = 0;
  for (std::size_t e = 0; e < kPaperEngines.size(); ++e) {
    PlotSeries series{kPaperEngines[e], {}, {}};
    const auto figures = table.all.find(kPaperEngines[e]);
    for (std::size_t s = 0; figures != table.all.end() && s < kPaperSizes.size(); ++s) {
      const double ms = figures->second[s].mean_ms();
      if (ms <= 0) continue;
      const double x = static_cast<double>(s) - 0.36 + 0.25 * static_cast<double>(e);
      series.bars.push_back({x, x + 0.22, ms, number("%.1f", ms)});
      lo = std::min(lo, ms);
      hi = std::max(hi, ms);
    }
    plot.series.push_back(std::move(series));
  }
  plot.y = {"ms (log)", lo / 2, hi * 2, true, {}};
  return {file, plot};
}

/// The data set that stands beside the checkout, or in PICKCELL_DATA; nothing when it is not there.
std::optional<fs::path> shared_set() {
  std::vector<fs::path> places{"../shared/data/rst200"};
  if (const char* named = std::getenv("PICKCELL_DATA")) places.insert(places.begin(), fs::path(named) / "rst200");
  for (const fs::path& p : places)
    if (fs::exists(p / "truth.json")) return p;
  return {};
}

/// Measures one set and writes its tables and its plot: KEY.md, KEY_variants.md, KEY_stages.md, KEY_misses.md,
/// KEY_time.svg.
class Report {
 public:
  explicit Report(const ExperimentOptions& options) : options_(options) {}

  core::Status add(const fs::path& folder, const std::string& key, const std::string& title, bool own_split) {
    auto set = load_dataset(folder);
    if (!set) return core::forward(set);
    auto table = measure_paper_table(*set);
    if (!table) return core::forward(table);
    const auto y = core::median(table->yardstick_ms);
    std::string times = "Measured on " + machine() +
                        (y ? number(", yardstick %.2f ms", *y) : std::string(", built without the yardstick")) +
                        ".\n\n";
    times += "All pictures:\n\n" + time_table(table->all);
    if (!own_split) times += "The 6, 17 and 7 templates of Table I:\n\n" + time_table(table->split);
    times += kind_table(*table);
    std::string variants;
    if (own_split) {
      auto made = variant_table(*set, *table);
      if (!made) return core::forward(made);
      variants = std::move(*made);
    }
    const std::string stages = stage_table(table->all);
    const std::string misses = miss_counts(*table), list = miss_list(*table);
    words_ += "### " + title + "\n\n" + times + variants + stages + misses + list;
    json_.set(key, to_json(*table));
    json_.set(key + "_yardstick_ms", y ? Json(*y) : Json());
    for (const auto& [name, content] : {std::pair{".md", times},
                                        {"_variants.md", variants},
                                        {"_stages.md", stages},
                                        {"_misses.md", misses},
                                        {"_miss_list.md", list}}) {
      if (content.empty()) continue;
      if (auto done = core::write_file_atomically(options_.out / (key + name), content); !done) return done;
    }
    return write_plots(options_.out, {plot_of(key + "_time.svg", title, *table)});
  }

  [[nodiscard]] std::string words() const { return options_.json ? json_.dump() + "\n" : words_; }

 private:
  const ExperimentOptions& options_;
  std::string words_;
  Json json_ = Json::object();
};

core::Result<int> run(const ExperimentOptions& options, Io& io) {
  keep_freed_memory();
  const int templates = options.n.value_or(kFortyTemplates[0] + kFortyTemplates[1] + kFortyTemplates[2]);
  const fs::path folder = options.out / "set";
  auto sources = paper_sources(options.photos, options.seed);
  if (!sources) return core::forward(sources);
  if (auto done = write_paper_set(folder, std::move(*sources), templates, options.seed); !done)
    return core::forward(done);
  Report report(options);
  const char* title = options.photos ? "templates from own photographs" : "rendered templates";
  if (auto done = report.add(folder, "table2", title, false); !done) return core::forward(done);
  if (const auto rst200 = shared_set(); rst200 && !options.n)
    if (auto done = report.add(*rst200, "rst200", "rst200, its own 14 / 16 / 10 templates", true); !done)
      return core::forward(done);
  io.out << report.words();
  return 0;
}

const ExperimentRegistration registered({"table2", "time and accuracy by template size; --n: templates (40)", true,
                                         run});

}  // namespace
}  // namespace pickcell::cli
