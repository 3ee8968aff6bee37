#include "pickcell/cli/experiment/paper_table.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "pickcell/core/statistics.hpp"

namespace pickcell::cli {
namespace {

using core::Json;

struct PaperRow {
  double erst_s, rst_s, erst_pct, rst_pct;
};
/// Table II.
constexpr std::array<PaperRow, 3> kPaper = {
    {{1.113, 0.302, 90.0, 93.3}, {1.739, 0.176, 88.8, 89.4}, {19.940, 2.204, 91.4, 94.3}}};
constexpr std::array<const char*, 2> kPaperMethods = {"erst", "rst"};
/// Steps 1 to 4, merging, and what a picture can be lost for otherwise.
constexpr std::array<const char*, 5> kStages = {"circular", "radial", "template", "robust", "merge"};

std::string text(const char* format, double a, double b = 0, double c = 0) {
  char out[160];
  std::snprintf(out, sizeof out, format, a, b, c);
  return out;
}

double ratio(double a, double b) { return b > 0 ? a / b : 0; }

/// The pictures of one template.
Dataset part_of(const Dataset& set, std::size_t part) {
  Dataset out = set;
  std::erase_if(out.images, [&](const DatasetImage& i) { return i.template_index != part; });
  return out;
}

int size_index(const std::string& size) {
  const auto at = std::find(kPaperSizes.begin(), kPaperSizes.end(), size);
  return at == kPaperSizes.end() ? -1 : static_cast<int>(at - kPaperSizes.begin());
}

double median(const std::vector<double>& v) { return core::median(v).value_or(0); }
double mean(const std::vector<double>& v) { return core::mean(v).value_or(0); }

}  // namespace

void EngineFigures::add(const ImageOutcome& o) {
  ++images;
  loose += o.loose ? 1 : 0;
  correct += o.score.correct ? 1 : 0;
  if (o.ms) ms.push_back(*o.ms);
  for (const auto& s : o.stages) {
    StageFigures& f = stages[s.stage];
    f.population.push_back(static_cast<double>(s.population));
    f.ms.push_back(s.ms);
    f.ncc += static_cast<double>(s.ncc_count);
    f.features += static_cast<double>(s.feature_count);
  }
}

double EngineFigures::mean_ms() const { return mean(ms); }
double EngineFigures::median_ms() const { return median(ms); }

double EngineFigures::ncc() const {
  double sum = 0;
  for (const auto& [name, s] : stages) sum += s.ncc;
  return sum;
}

core::Result<PaperTable> measure_paper_table(const Dataset& set, const matches::Settings& settings) {
  PaperTable table;
  std::array<int, 3> rank{};
  for (std::size_t part = 0; part < set.templates.size(); ++part) {
    const int size = size_index(set.templates[part].size);
    if (size < 0) continue;
    const auto at = static_cast<std::size_t>(size);
    const bool in_split = rank[at]++ < kTableOne[at];
    const Dataset own = part_of(set, part);
    if (own.images.empty()) continue;
    for (const char* engine : kPaperEngines) {
      const bool papers = std::string_view(engine) != "best";
      if (!papers && !settings.empty()) continue;
      BenchOptions options;
      options.engine = engine;
      options.settings = settings;
      options.explain = papers && settings.empty();
      auto run = run_bench(own, options);
      if (!run) return core::forward(run);
      table.yardstick_ms.insert(table.yardstick_ms.end(), run->yardstick_ms.begin(), run->yardstick_ms.end());
      for (const ImageOutcome& o : run->images) {
        table.all[engine][at].add(o);
        if (in_split) table.split[engine][at].add(o);
        const DatasetImage& image = own.images[o.image];
        KindFigures& kind = table.kinds[image.kind];
        ++kind.images[engine];
        kind.loose[engine] += o.loose ? 1 : 0;
        if (o.loose) continue;
        table.misses.push_back({engine, image.file.filename().string(), kPaperSizes[at], image.kind,
                                o.loss.value_or(Loss{"none", o.score.why})});
      }
    }
  }
  return table;
}

std::string time_table(std::map<std::string, SizeFigures> figures) {
  std::string out =
      "| size | images | e-RST mean (median) ms | RST mean (median) ms | best mean (median) ms | e-RST/RST: mean times "
      "(medians) | e-RST/RST: NCC counts | found loosely, e-RST / RST / best % | within bench's limits | paper: e-RST "
      "-> RST s, ratio, % |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n";
  for (std::size_t s = 0; s < kPaperSizes.size(); ++s) {
    const EngineFigures &e = figures["erst"][s], &r = figures["rst"][s], &b = figures["best"][s];
    if (e.images == 0) continue;
    const PaperRow& p = kPaper[s];
    out += "| " + std::string(kPaperSizes[s]) + " | " + std::to_string(e.images);
    for (const EngineFigures* c : {&e, &r, &b}) out += text(" | %.2f (%.2f)", c->mean_ms(), c->median_ms());
    out += text(" | %.1f (%.1f)", ratio(e.mean_ms(), r.mean_ms()), ratio(e.median_ms(), r.median_ms()));
    out += text(" | %.1f", ratio(e.ncc(), r.ncc()));
    out += text(" | %.1f / %.1f / %.1f", e.loose_pct(), r.loose_pct(), b.loose_pct());
    out += text(" | %.0f / %.0f / %.0f", e.correct, r.correct, b.correct);
    out += text(" | %.3f -> %.3f, %.1f, ", p.erst_s, p.rst_s, p.erst_s / p.rst_s) +
           text("%.1f -> %.1f |\n", p.erst_pct, p.rst_pct);
  }
  return out + "\n";
}

std::string kind_table(const PaperTable& table) {
  std::string out = "| condition | images | found loosely: e-RST % | RST % | best % |\n|---|---|---|---|---|\n";
  for (const auto& [name, kind] : table.kinds) {
    out += "| " + (name.empty() ? std::string("all") : name) + " | " + std::to_string(kind.images.at("erst"));
    for (const char* engine : kPaperEngines)
      out += text(" | %.1f", 100 * ratio(kind.loose.at(engine), kind.images.at(engine)));
    out += " |\n";
  }
  return out + "\n";
}

std::string stage_table(std::map<std::string, SizeFigures> figures) {
  std::string out =
      "| size | engine | candidates into steps 1, 2, 3, 4: mean (median into 4) | step 2: comparisons per candidate | "
      "NCC in step 3 | NCC in step 4 | step 4: NCC per candidate | CPU ms of steps 1, 2, 3, 4: mean | median |\n"
      "|---|---|---|---|---|---|---|---|---|\n";
  for (std::size_t s = 0; s < kPaperSizes.size(); ++s)
    for (const char* engine : kPaperMethods) {
      EngineFigures& e = figures[engine][s];
      if (e.images == 0) continue;
      const auto sum = [&](const char* stage) {
        return mean(e.stages[stage].population) * static_cast<double>(e.stages[stage].population.size());
      };
      out += "| " + std::string(kPaperSizes[s]) + " | " + engine + " | ";
      std::string means, medians;
      for (std::size_t k = 0; k < 4; ++k) {
        const StageFigures& f = e.stages[kStages[k]];
        out += text(k == 0 ? "%.0f" : ", %.0f", mean(f.population));
        means += text(k == 0 ? "%.2f" : ", %.2f", mean(f.ms));
        medians += text(k == 0 ? "%.2f" : ", %.2f", median(f.ms));
      }
      out += text(" (%.0f)", median(e.stages["robust"].population));
      out += text(" | %.0f", ratio(e.stages["radial"].features, sum("radial")));
      out += text(" | %.0f | %.0f", e.stages["template"].ncc, e.stages["robust"].ncc);
      out += text(" | %.1f", ratio(e.stages["robust"].ncc, sum("robust"))) + " | " + means + " | " + medians + " |\n";
    }
  return out + "\n";
}

std::string miss_counts(const PaperTable& table) {
  std::string out = "| size | engine | not found | lost at: ";
  for (const char* stage : kStages) out += std::string(stage == kStages[0] ? "" : " | ") + stage;
  out += " | no candidate |\n|---|---|---|---|---|---|---|---|---|\n";
  for (const char* size : kPaperSizes)
    for (const char* engine : kPaperMethods) {
      const auto count = [&](const char* stage) {
        return std::count_if(table.misses.begin(), table.misses.end(), [&](const Miss& m) {
          return m.engine == engine && m.size == size && (stage == nullptr || m.loss.stage == stage);
        });
      };
      out += "| " + std::string(size) + " | " + engine + " | " + std::to_string(count(nullptr));
      for (const char* stage : kStages) out += " | " + std::to_string(count(stage));
      out += " | " + std::to_string(count("none")) + " |\n";
    }
  return out + "\n";
}

std::string miss_list(const PaperTable& table) {
  std::string out = "| picture | condition | engine | lost at | why |\n|---|---|---|---|---|\n";
  for (const Miss& m : table.misses)
    if (m.engine != "best")
      out += "| " + m.image + " | " + m.kind + " | " + m.engine + " | " + m.loss.stage + " | " + m.loss.why + " |\n";
  return out + "\n";
}

namespace {

/// erst over rst, by size: of the mean and median times, and of the template's correlations of steps 3 and 4.
Json ratios(const PaperTable& table) {
  Json out = Json::object();
  const auto erst = table.all.find("erst"), rst = table.all.find("rst");
  if (erst == table.all.end() || rst == table.all.end()) return out;
  for (std::size_t s = 0; s < kPaperSizes.size(); ++s) {
    const EngineFigures &e = erst->second[s], &r = rst->second[s];
    if (e.images == 0) continue;
    out.set(kPaperSizes[s], Json::object()
                                .set("mean_ms", ratio(e.mean_ms(), r.mean_ms()))
                                .set("median_ms", ratio(e.median_ms(), r.median_ms()))
                                .set("ncc_count", ratio(e.ncc(), r.ncc())));
  }
  return out;
}

}  // namespace

core::Json to_json(const PaperTable& table) {
  Json out = Json::object();
  for (const auto& [engine, sizes] : table.all) {
    Json rows = Json::object();
    for (std::size_t s = 0; s < kPaperSizes.size(); ++s) {
      const EngineFigures& c = sizes[s];
      if (c.images == 0) continue;
      Json row = Json::object();
      row.set("images", c.images).set("loose", c.loose).set("correct", c.correct);
      row.set("mean_ms", c.mean_ms()).set("median_ms", c.median_ms()).set("ncc_count", c.ncc());
      for (const auto& [stage, f] : c.stages)
        row.set("stage_" + stage, Json::object()
                                      .set("population_mean", mean(f.population))
                                      .set("ncc_count", f.ncc)
                                      .set("feature_count", f.features)
                                      .set("median_ms", median(f.ms)));
      rows.set(kPaperSizes[s], std::move(row));
    }
    out.set(engine, std::move(rows));
  }
  out.set("erst_over_rst", ratios(table));
  return out;
}

}  // namespace pickcell::cli
