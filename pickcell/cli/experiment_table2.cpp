/// experiment table2: time and accuracy by template size, as in Tables I and II of the paper.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <ostream>

#include "pickcell/cli/bench_plots.hpp"
#include "pickcell/cli/bench_run.hpp"
#include "pickcell/cli/experiment.hpp"
#include "pickcell/cli/paper_pictures.hpp"
#include "pickcell/cli/yardstick.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/core/statistics.hpp"
#include "pickcell/image/codec.hpp"

namespace pickcell::cli {
namespace {

namespace fs = std::filesystem;
using core::Json;

constexpr int kTemplates = 40, kImagesEach = 5;
constexpr std::array<const char*, 3> kSizes = {"small", "medium", "large"};
/// Table I: 6, 17 and 7 templates; its text says 40, in the same proportion 8, 23 and 9.
constexpr std::array<int, 3> kTableOne = {6, 17, 7}, kAll = {8, 23, 9};
constexpr std::array<const char*, 3> kEngines = {"erst", "rst", "best"};

struct PaperRow {
  double erst_s, rst_s, erst_pct, rst_pct;
};
constexpr std::array<PaperRow, 3> kPaper = {
    {{1.113, 0.302, 90.0, 93.3}, {1.739, 0.176, 88.8, 89.4}, {19.940, 2.204, 91.4, 94.3}}};

/// Which size the i-th of n templates has, in the proportion of 8, 23 and 9.
std::size_t size_of(int i, int n) {
  const double at = (i + 0.5) * kTemplates / n;
  return at < kAll[0] ? 0 : at < kAll[0] + kAll[1] ? 1 : 2;
}

std::string text(const char* format, double a, double b = 0, double c = 0, double d = 0) {
  char out[160];
  std::snprintf(out, sizeof out, format, a, b, c, d);
  return out;
}

class Generator {
 public:
  Generator(std::vector<SourcePicture> sources, const ExperimentOptions& options, int templates)
      : sources_(std::move(sources)), folder_(options.out / "set"), random_(options.seed), count_(templates) {}

  core::Result<fs::path> write() {
    std::error_code problem;
    for (const char* sub : {"templates", "images"}) fs::create_directories(folder_ / sub, problem);
    if (problem)
      return core::failure(core::ErrorCode::unreadable, folder_.string(), problem.message(),
                           "name a folder that can be written");
    for (int i = 0; i < count_; ++i)
      if (auto done = one(i); !done) return core::forward(done);
    Json truth = Json::object().set("name", "table2").set("templates", std::move(templates_));
    truth.set("images", std::move(images_));
    if (auto done = core::write_file_atomically(folder_ / "truth.json", truth.dump(1)); !done)
      return core::forward(done);
    return folder_;
  }

 private:
  static constexpr int kWidth = 640, kHeight = 480;

  core::Status one(int i) {
    static constexpr std::array<std::pair<int, int>, 3> kRange = {{{40, 99}, {100, 199}, {200, 260}}};
    const std::size_t size = size_of(i, count_);
    const SourcePicture& source = of_category(static_cast<std::size_t>(i) % kPaperCategories.size());
    const int w = std::min(random_.integer(kRange[size].first, kRange[size].second), source.picture.width());
    const int h = std::min(random_.integer(kRange[size].first, kRange[size].second), source.picture.height());
    const image::Image part = cut_template(source, w, h, random_);
    const std::string id = std::string(kSizes[size]) + "_" + std::to_string(i);
    const std::string file = "templates/" + id + ".png";
    if (auto done = image::save_png(folder_ / file, part.view()); !done) return done;
    templates_.push(Json::object()
                        .set("id", id)
                        .set("file", file)
                        .set("category", kPaperCategories[source.category])
                        .set("source", source.name)
                        .set("size", kSizes[size])
                        .set("w", w)
                        .set("h", h));
    for (int k = 0; k < kImagesEach; ++k)
      if (auto done = scene(id, part, k); !done) return done;
    return {};
  }

  core::Status scene(const std::string& id, const image::Image& part, int k) {
    const SourcePicture& ground =
        sources_[static_cast<std::size_t>(random_.integer(0, static_cast<int>(sources_.size()) - 1))];
    image::Image picture = scene_of(ground, kWidth, kHeight);
    std::optional<TruthPose> pose;
    while (!pose)
      pose = pose_inside(kWidth, kHeight, part.width(), part.height(), random_.uniform(0, 360),
                         random_.uniform(0.9, 1.1), random_);
    lay_template(picture, part.view(), *pose);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        picture.at(x, y) = static_cast<std::uint8_t>(std::clamp(picture.at(x, y) + random_.normal() + 0.5, 0.0, 255.0));
    const std::string file = "images/" + id + "_" + std::to_string(k) + ".png";
    images_.push(Json::object()
                     .set("file", file)
                     .set("template", id)
                     .set("kind", "clean")
                     .set("width", kWidth)
                     .set("height", kHeight)
                     .set("x", pose->x_px)
                     .set("y", pose->y_px)
                     .set("angle", pose->angle_deg)
                     .set("scale", pose->scale));
    return image::save_png(folder_ / file, picture.view());
  }

  const SourcePicture& of_category(std::size_t category) {
    std::vector<const SourcePicture*> fitting;
    for (const SourcePicture& s : sources_)
      if (s.category == category) fitting.push_back(&s);
    if (fitting.empty()) return sources_[category % sources_.size()];
    return *fitting[static_cast<std::size_t>(random_.integer(0, static_cast<int>(fitting.size()) - 1))];
  }

  std::vector<SourcePicture> sources_;
  fs::path folder_;
  sim::Random random_;
  int count_;
  Json templates_ = Json::array(), images_ = Json::array();
};

/// One engine on one size of one set.
struct Cell {
  std::vector<double> ms;
  int images = 0, loose = 0, correct = 0;
  double ncc = 0;
  [[nodiscard]] double accuracy_pct() const { return images > 0 ? 100.0 * loose / images : 0; }
  [[nodiscard]] double mean_ms() const { return core::mean(ms).value_or(0); }
  [[nodiscard]] double median_ms() const { return core::median(ms).value_or(0); }
};
using Table = std::map<std::string, std::array<Cell, 3>>;  ///< by engine

/// limit: how many templates of each size count, in the order of the set; 0: all.
core::Status measure(const Dataset& set, const char* engine, const std::array<int, 3>& limit, Table& all, Table& split,
                     std::vector<double>& yardstick) {
  BenchOptions options;
  options.engine = engine;
  auto run = run_bench(set, options);
  if (!run) return core::forward(run);
  yardstick.insert(yardstick.end(), run->yardstick_ms.begin(), run->yardstick_ms.end());
  std::vector<int> rank(set.templates.size());
  std::map<std::string, int> seen;
  for (std::size_t i = 0; i < rank.size(); ++i) rank[i] = seen[set.templates[i].size]++;
  for (const ImageOutcome& o : run->images) {
    const std::size_t part = set.images[o.image].template_index;
    const auto at = std::find(kSizes.begin(), kSizes.end(), set.templates[part].size);
    if (at == kSizes.end()) continue;
    const auto size = static_cast<std::size_t>(at - kSizes.begin());
    const auto add = [&](Cell& c) {
      ++c.images;
      c.loose += o.loose ? 1 : 0;
      c.correct += o.score.correct ? 1 : 0;
      c.ncc += static_cast<double>(o.ncc_count);
      if (o.ms) c.ms.push_back(*o.ms);
    };
    add(all[engine][size]);
    if (rank[part] < limit[size]) add(split[engine][size]);
  }
  return {};
}

std::string words(const std::string& title, Table& table) {
  std::string out = "### " + title +
                    "\n\n| size | images | e-RST mean (median) ms | RST mean (median) ms | best mean (median) ms | "
                    "time e-RST/RST mean (median) | NCC e-RST/RST | accuracy e-RST / RST / best % | within bench's "
                    "limits e-RST / RST "
                    "/ best | paper: s, ratio, % |\n|---|---|---|---|---|---|---|---|---|---|\n";
  for (std::size_t s = 0; s < 3; ++s) {
    const Cell &e = table["erst"][s], &r = table["rst"][s], &b = table["best"][s];
    if (e.images == 0) continue;
    const PaperRow& p = kPaper[s];
    out += "| " + std::string(kSizes[s]) + " | " + std::to_string(e.images);
    for (const Cell* c : {&e, &r, &b}) out += text(" | %.2f (%.2f)", c->mean_ms(), c->median_ms());
    out += text(" | %.1f (%.1f) | %.1f", e.mean_ms() / r.mean_ms(), e.median_ms() / r.median_ms(),
                r.ncc > 0 ? e.ncc / r.ncc : 0);
    out += text(" | %.1f / %.1f / %.1f", e.accuracy_pct(), r.accuracy_pct(), b.accuracy_pct());
    out += text(" | %.0f / %.0f / %.0f", e.correct, r.correct, b.correct);
    out += text(" | %.3f -> %.3f, %.1f, ", p.erst_s, p.rst_s, p.erst_s / p.rst_s) +
           text("%.1f -> %.1f |\n", p.erst_pct, p.rst_pct);
  }
  return out + "\n";
}

Json to_json(Table& table) {
  Json out = Json::object();
  for (const char* engine : kEngines) {
    Json rows = Json::object();
    for (std::size_t s = 0; s < 3; ++s) {
      const Cell& c = table[engine][s];
      if (c.images == 0) continue;
      rows.set(kSizes[s], Json::object()
                              .set("images", c.images)
                              .set("loose", c.loose)
                              .set("correct", c.correct)
                              .set("mean_ms", c.mean_ms())
                              .set("median_ms", c.median_ms())
                              .set("ncc_count", c.ncc));
    }
    out.set(engine, std::move(rows));
  }
  return out;
}

NamedPlot plot_of(const std::string& file, const std::string& title, Table& table) {
  Plot plot;
  plot.title = title;
  plot.subtitle = "mean time of one search, one thread";
  plot.x = {"template size", -0.5, 2.5, false, {kSizes.begin(), kSizes.end()}};
  double lo = 1e9, hi = 0;
  for (std::size_t e = 0; e < kEngines.size(); ++e) {
    PlotSeries series{kEngines[e], {}, {}};
    for (std::size_t s = 0; s < 3; ++s) {
      const double ms = table[kEngines[e]][s].mean_ms();
      if (ms <= 0) continue;
      const double x = static_cast<double>(s) - 0.36 + 0.25 * static_cast<double>(e);
      series.bars.push_back({x, x + 0.22, ms, text("%.1f", ms)});
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

core::Result<int> run(const ExperimentOptions& options, Io& io) {
  keep_freed_memory();
  auto sources = paper_sources(options.photos, options.seed);
  if (!sources) return core::forward(sources);
  auto folder = Generator(std::move(*sources), options, options.n.value_or(kTemplates)).write();
  if (!folder) return core::forward(folder);
  std::string report;
  std::vector<NamedPlot> plots;
  std::vector<double> yardstick;
  Json json = Json::object();
  const auto one_set = [&](const fs::path& path, const std::string& key, const std::string& title) -> core::Status {
    auto set = load_dataset(path);
    if (!set) return core::forward(set);
    Table all, split;
    for (const char* engine : kEngines)
      if (auto done = measure(*set, engine, kTableOne, all, split, yardstick); !done) return done;
    report += words(title + ", all its pictures", all);
    if (key == "table2") report += words(title + ", the 6/17/7 templates of Table I", split);
    json.set(key, to_json(all));
    plots.push_back(plot_of(key + "_time.svg", title, all));
    return {};
  };
  if (auto done = one_set(*folder, "table2", options.photos ? "templates from own photographs" : "rendered templates");
      !done)
    return core::forward(done);
  if (const auto rst200 = shared_set(); rst200 && !options.n)
    if (auto done = one_set(*rst200, "rst200", "rst200"); !done) return core::forward(done);
  const auto y = core::median(yardstick);
  report += y ? text("Yardstick of the run: %.2f ms.\n", *y) : "Built without the yardstick.\n";
  json.set("yardstick_ms", y ? Json(*y) : Json());
  if (auto done = core::write_file_atomically(options.out / "table2.md", report); !done) return core::forward(done);
  if (auto done = write_plots(options.out, plots); !done) return core::forward(done);
  io.out << (options.json ? json.dump() + "\n" : report);
  return 0;
}

const ExperimentRegistration registered({"table2", "time and accuracy by template size; --n: templates (40)", true,
                                         run});

}  // namespace
}  // namespace pickcell::cli
