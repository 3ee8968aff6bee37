#include "pickcell/cli/bench/report.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <map>

#include "pickcell/core/statistics.hpp"

namespace pickcell::cli {

namespace {

using core::Json;

using OutcomeList = std::vector<const ImageOutcome*>;

ClassFigures figures_of(std::string name, const OutcomeList& outcomes) {
  ClassFigures out;
  out.name = std::move(name);
  out.images = outcomes.size();
  std::vector<double> times;
  for (const ImageOutcome* outcome : outcomes) {
    out.correct += outcome->score.correct ? 1 : 0;
    out.strict += outcome->score.strict ? 1 : 0;
    out.loose += outcome->loose ? 1 : 0;
    out.ncc_count += outcome->ncc_count;
    if (outcome->ms) times.push_back(*outcome->ms);
  }
  out.median_ms = core::median(times).value_or(0);
  out.mean_ms = core::mean(times).value_or(0);
  return out;
}

/// Figures of every class that has a name and a picture: those in `first` first, the others as they appear.
template <class ClassOf>
std::vector<ClassFigures> figures_by(const BenchRun& run, std::vector<std::string> first, const ClassOf& class_of) {
  std::vector<std::string> names = std::move(first);
  for (const ImageOutcome& outcome : run.images)
    if (std::find(names.begin(), names.end(), class_of(outcome)) == names.end()) names.push_back(class_of(outcome));
  std::vector<ClassFigures> out;
  for (const std::string& name : names) {
    OutcomeList members;
    for (const ImageOutcome& outcome : run.images)
      if (class_of(outcome) == name) members.push_back(&outcome);
    if (!name.empty() && !members.empty()) out.push_back(figures_of(name, members));
  }
  return out;
}

ErrorFigures error_figures(const BenchRun& run, double PoseError::* part) {
  std::vector<double> values;
  for (const ImageOutcome& outcome : run.images)
    for (const Hit& hit : outcome.score.hits) values.push_back(hit.error.*part);
  return {core::median(values), core::quantile(values, 0.95)};
}

InstanceFigures instance_figures(const Dataset& set, const BenchRun& run) {
  InstanceFigures out;
  for (const ImageOutcome& outcome : run.images) {
    if (!set.images[outcome.image].has_instances) continue;
    out.instances += outcome.score.truths;
    out.found += outcome.score.hits.size();
    out.reported += outcome.score.matches;
  }
  return out;
}

AbsentFigures absent_figures(const BenchRun& run) {
  AbsentFigures out;
  std::size_t at_threshold = 0;
  for (const ImageOutcome& outcome : run.images) {
    at_threshold += outcome.correct_at_threshold ? 1 : 0;
    out.images += outcome.false_accept ? 1 : 0;
    out.false_accepts += outcome.false_accept.value_or(false) ? 1 : 0;
  }
  out.recall_at_threshold = static_cast<double>(at_threshold) / static_cast<double>(run.images.size());
  return out;
}

Json number_or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json ratio(std::size_t part, std::size_t whole) {
  return whole == 0 ? Json() : Json(static_cast<double>(part) / static_cast<double>(whole));
}

Json classes_json(const std::vector<ClassFigures>& classes, bool loose) {
  Json out = Json::object();
  for (const ClassFigures& c : classes) {
    Json entry = Json::object();
    entry.set("images", c.images).set("correct", c.correct).set("strict_count", c.strict);
    entry.set("accuracy", c.accuracy()).set("strict", c.strict_rate());
    entry.set("median_ms", c.median_ms).set("mean_ms", c.mean_ms).set("ncc_count", c.ncc_count);
    if (loose) entry.set("loose_count", c.loose).set("loose", c.loose_rate());
    out.set(c.name, std::move(entry));
  }
  return out;
}

__attribute__((format(printf, 1, 2))) std::string format(const char* pattern, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

std::string in_yardsticks(double ms, const std::optional<double>& yardstick_ms) {
  return yardstick_ms ? format(" (%.2f Y)", ms / *yardstick_ms) : std::string();
}

std::string error_line(const BenchReport& report, const char* label, std::optional<double> ErrorFigures::* part) {
  if (!(report.px.*part)) return {};
  return format("  %s  %.3f px  %.3f deg  %.3f %% scale\n", label, *(report.px.*part), *(report.deg.*part),
                *(report.scale_pct.*part));
}

std::string class_line(const ClassFigures& c, bool loose) {
  return format("  %-14s %6zu %9.1f %% %7.1f %% ", c.name.c_str(), c.images, 100 * c.accuracy(),
                100 * c.strict_rate()) +
         (loose ? format("%7.1f %% ", 100 * c.loose_rate()) : std::string()) +
         format("%11.2f %9.2f\n", c.median_ms, c.mean_ms);
}

/// How many of the misses each stage lost.
std::string losses(const BenchReport& report) {
  std::map<std::string, int> count;
  for (const Failure& f : report.failures)
    if (f.loss) ++count[f.loss->stage];
  std::string out;
  for (const auto& [stage, n] : count) out += format("%s%s %d", out.empty() ? "" : ", ", stage.c_str(), n);
  return out.empty() ? "" : "not found loosely, by the stage that lost them: " + out + "\n";
}

std::string percent(std::size_t part, std::size_t whole) {
  return whole == 0 ? "-" : format("%.1f %%", 100.0 * static_cast<double>(part) / static_cast<double>(whole));
}

}  // namespace

BenchReport summarise(const Dataset& set, const BenchRun& run) {
  BenchReport out;
  out.dataset = set.name;
  out.engine = run.options.engine;
  out.threads = run.options.threads;
  out.isa = run.isa;
  OutcomeList all;
  std::vector<double> times;
  bool has_instances = false;
  for (const ImageOutcome& outcome : run.images) {
    const DatasetImage& image = set.images[outcome.image];
    all.push_back(&outcome);
    if (outcome.ms) times.push_back(*outcome.ms);
    has_instances = has_instances || image.has_instances;
    if (!outcome.score.correct) out.failures.push_back({image.file.generic_string(), outcome.score.why, outcome.loss});
  }
  out.all = figures_of("all", all);
  out.loose = !has_instances;
  out.p95_ms = core::quantile(times, 0.95).value_or(0);
  out.teach_ms = core::median(run.teach_ms);
  out.px = error_figures(run, &PoseError::position_px);
  out.deg = error_figures(run, &PoseError::angle_deg);
  out.scale_pct = error_figures(run, &PoseError::scale_pct);
  out.yardstick_ms = core::median(run.yardstick_ms);
  out.by_size = figures_by(run, {"small", "medium", "large"}, [&](const ImageOutcome& outcome) {
    return set.templates[set.images[outcome.image].template_index].size;
  });
  out.by_kind = figures_by(run, {}, [&](const ImageOutcome& outcome) { return set.images[outcome.image].kind; });
  if (has_instances) out.instances = instance_figures(set, run);
  if (run.options.absent) out.absent = absent_figures(run);
  return out;
}

Json to_json(const BenchReport& report) {
  Json out = Json::object();
  out.set("dataset", report.dataset).set("engine", report.engine).set("threads", report.threads).set("isa", report.isa);
  out.set("images", report.all.images).set("correct", report.all.correct).set("strict_count", report.all.strict);
  out.set("accuracy", report.all.accuracy()).set("strict", report.all.strict_rate());
  out.set("median_ms", report.all.median_ms).set("mean_ms", report.all.mean_ms).set("p95_ms", report.p95_ms);
  out.set("teach_ms", number_or_null(report.teach_ms));
  out.set("median_px", number_or_null(report.px.median)).set("p95_px", number_or_null(report.px.p95));
  out.set("median_deg", number_or_null(report.deg.median)).set("p95_deg", number_or_null(report.deg.p95));
  out.set("median_scale_pct", number_or_null(report.scale_pct.median));
  const auto& y = report.yardstick_ms;
  out.set("yardstick_ms", number_or_null(y));
  out.set("median_yardsticks", y ? Json(report.all.median_ms / *y) : Json());
  out.set("mean_yardsticks", y ? Json(report.all.mean_ms / *y) : Json());
  out.set("by_size", classes_json(report.by_size, report.loose));
  out.set("by_kind", classes_json(report.by_kind, report.loose));
  Json failures = Json::array();
  for (const Failure& f : report.failures) {
    Json failure = Json::object().set("image", f.image).set("why", f.why);
    if (f.loss) failure.set("stage", f.loss->stage).set("stage_why", f.loss->why);
    failures.push(std::move(failure));
  }
  out.set("failures", std::move(failures));
  if (const auto& i = report.instances) {
    out.set("recall", ratio(i->found, i->instances)).set("precision", ratio(i->found, i->reported));
    out.set("instances", i->instances);
  }
  if (const auto& a = report.absent) {
    out.set("absent_images", a->images).set("false_accepts", a->false_accepts);
    out.set("recall_at_threshold", a->recall_at_threshold);
  }
  if (report.loose) out.set("loose_count", report.all.loose).set("loose", report.all.loose_rate());
  return out;
}

std::string to_table(const BenchReport& report) {
  const auto& y = report.yardstick_ms;
  std::string out = format("%s: %zu images, engine %s, %d thread%s, %s\n\n", report.dataset.c_str(), report.all.images,
                           report.engine.c_str(), report.threads, report.threads == 1 ? "" : "s", report.isa.c_str());
  out += format("  %-14s %6s %11s %9s %s%11s %9s\n", "", "images", "accuracy", "strict",
                report.loose ? "    loose " : "", "median ms", "mean ms");
  out += class_line(report.all, report.loose) + "\n";
  for (const auto& c : report.by_size) out += class_line(c, report.loose);
  out += report.by_size.empty() ? "" : "\n";
  for (const auto& c : report.by_kind) out += class_line(c, report.loose);
  out += report.by_kind.empty() ? "" : "\n";
  out += format("time    median %.2f ms%s, mean %.2f ms%s, 95 %% %.2f ms", report.all.median_ms,
                in_yardsticks(report.all.median_ms, y).c_str(), report.all.mean_ms,
                in_yardsticks(report.all.mean_ms, y).c_str(), report.p95_ms);
  if (report.teach_ms) out += format("; teaching %.1f ms", *report.teach_ms);
  out += y ? format("; yardstick %.2f ms\n", *y) : std::string("; built without the yardstick\n");
  out += "error over what was found correctly\n";
  out += error_line(report, "median", &ErrorFigures::median) + error_line(report, "95 %  ", &ErrorFigures::p95);
  if (const auto& i = report.instances)
    out += format("instances %zu, recall %s, precision %s\n", i->instances, percent(i->found, i->instances).c_str(),
                  percent(i->found, i->reported).c_str());
  if (const auto& a = report.absent)
    out += format("absent parts: %zu false accepts in %zu images; recall at the suggested threshold %.1f %%\n",
                  a->false_accepts, a->images, 100 * a->recall_at_threshold);
  out += losses(report);
  if (!report.failures.empty()) out += "not correct:\n";
  for (const Failure& f : report.failures)
    out += "  " + f.image + ": " + f.why +
           (f.loss ? "; lost at stage " + f.loss->stage + " (" + f.loss->why + ")" : "") + "\n";
  return out;
}

}  // namespace pickcell::cli
