#include "pickcell/cli/bench/plots.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "pickcell/core/file.hpp"
#include "pickcell/core/statistics.hpp"

namespace pickcell::cli {

namespace {

std::string rounded(double v, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, v);
  return text;
}

std::string run_of(const BenchReport& report) {
  return report.dataset + ", engine " + report.engine + ", " + std::to_string(report.all.images) + " images";
}

std::vector<double> errors(const BenchRun& run, double PoseError::* part) {
  std::vector<double> out;
  for (const ImageOutcome& outcome : run.images)
    for (const Hit& hit : outcome.score.hits) out.push_back(hit.error.*part);
  return out;
}

/// Counts in bins that grow by a constant factor: errors span decades. What lies outside goes to the first or last bin.
Plot error_histogram(const std::vector<double>& values, double lo, double hi) {
  constexpr int kBins = 32;
  std::vector<PlotBar> bars(kBins);
  for (int i = 0; i < kBins; ++i) {
    bars[static_cast<std::size_t>(i)].x0 = lo * std::pow(hi / lo, static_cast<double>(i) / kBins);
    bars[static_cast<std::size_t>(i)].x1 = lo * std::pow(hi / lo, static_cast<double>(i + 1) / kBins);
  }
  for (const double v : values) {
    const double place = std::floor(kBins * std::log(std::max(v, lo) / lo) / std::log(hi / lo));
    bars[static_cast<std::size_t>(std::clamp(place, 0.0, kBins - 1.0))].y += 1;
  }
  double highest = 1;
  for (const PlotBar& bar : bars) highest = std::max(highest, bar.y);
  Plot plot;
  plot.x = {"", lo, hi, true, {}};
  plot.y = {"found poses", 0, 1.08 * highest, false, {}};
  plot.series.push_back({"found", std::move(bars), {}});
  return plot;
}

struct ErrorPlot {
  const char* file;
  const char* title;
  const char* label;
  const char* unit;
  double PoseError::* part;
  double lo;
  double hi;
  double limit;  ///< marked, 0: none
  const char* limit_name;
};

constexpr ErrorPlot kErrorPlots[] = {
    {"position_error.svg", "Position error", "distance of the found centre from the true one, px (log)", "px",
     &PoseError::position_px, 1e-3, 20, 1, "strict: 1 px"},
    {"angle_error.svg", "Angle error", "difference of the angles, degrees (log)", "deg", &PoseError::angle_deg, 1e-3, 5,
     1, "strict: 1 deg"},
    {"scale_error.svg", "Scale error", "difference of the scales, % of the true scale (log)", "%",
     &PoseError::scale_pct, 1e-3, 10, 5, "correct: 5 %"},
};

std::vector<NamedPlot> error_plots(const BenchRun& run, const BenchReport& report) {
  std::vector<NamedPlot> out;
  for (const ErrorPlot& spec : kErrorPlots) {
    const std::vector<double> values = errors(run, spec.part);
    if (values.empty()) continue;
    Plot plot = error_histogram(values, spec.lo, spec.hi);
    plot.title = spec.title;
    plot.subtitle = run_of(report) + "; " + std::to_string(values.size()) + " poses found correctly";
    plot.x.label = spec.label;
    const double middle = *core::median(values);
    const double p95 = *core::quantile(values, 0.95);
    plot.marks = {{middle, "median " + rounded(middle, 3) + " " + spec.unit},
                  {p95, "95 % " + rounded(p95, 3) + " " + spec.unit},
                  {spec.limit, spec.limit_name}};
    out.push_back({spec.file, std::move(plot)});
  }
  return out;
}

Plot accuracy_plot(const BenchReport& report) {
  Plot plot;
  plot.title = "Accuracy by condition";
  plot.subtitle = run_of(report);
  plot.x.label = "condition (number of images)";
  plot.y = {"images, %", 0, 108, false, {}};
  plot.series = {{"correct", {}, {}}, {"strict", {}, {}}};
  for (const ClassFigures& c : report.by_kind) {
    const auto place = static_cast<double>(plot.x.categories.size());
    plot.x.categories.push_back(c.name + " (" + std::to_string(c.images) + ")");
    const double correct = 100 * c.accuracy();
    const double strict = 100 * c.strict_rate();
    plot.series[0].bars.push_back({place - 0.36, place, correct, rounded(correct, 1)});
    plot.series[1].bars.push_back({place, place + 0.36, strict, rounded(strict, 1)});
  }
  return plot;
}

/// Ends of a logarithmic axis around values: at 1, 2 or 5 times a power of ten.
std::pair<double, double> log_ends(const std::vector<double>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const auto step_below = [](double v) {
    const double decade = std::pow(10.0, std::floor(std::log10(v)));
    return v >= 5 * decade ? 5 * decade : v >= 2 * decade ? 2 * decade : decade;
  };
  const double lo = step_below(std::max(*least, 1e-3) * 0.95);
  return {lo, std::max(step_below(std::max(*most, 1e-3) * 1.05) * 2.5, 2 * lo)};
}

Plot time_plot(const Dataset& set, const BenchRun& run, const BenchReport& report) {
  Plot plot;
  plot.title = "Time by size";
  plot.subtitle =
      run_of(report) + ", " + std::to_string(report.threads) + (report.threads == 1 ? " thread" : " threads");
  if (report.yardstick_ms) plot.subtitle += "; yardstick " + rounded(*report.yardstick_ms, 2) + " ms";
  std::vector<double> sides;
  std::vector<double> times;
  for (const ImageOutcome& outcome : run.images) {
    const DatasetTemplate& part = set.templates[set.images[outcome.image].template_index];
    if (!part.size_px || !outcome.ms) continue;
    const double side = std::sqrt(static_cast<double>(part.size_px->width_px) * part.size_px->height_px);
    const std::string name = part.size.empty() ? "images" : part.size;
    auto series = std::find_if(plot.series.begin(), plot.series.end(), [&](const auto& s) { return s.name == name; });
    if (series == plot.series.end()) series = plot.series.insert(series, {name, {}, {}});
    series->points.push_back({side, *outcome.ms});
    sides.push_back(side);
    times.push_back(*outcome.ms);
  }
  if (sides.empty()) return plot;
  const auto [x_lo, x_hi] = log_ends(sides);
  const auto [y_lo, y_hi] = log_ends(times);
  plot.x = {"side of the template, square root of its area, px (log)", x_lo, x_hi, true, {}};
  plot.y = {"time of one image, ms (log)", y_lo, y_hi, true, {}};
  return plot;
}

}  // namespace

std::vector<NamedPlot> bench_plots(const Dataset& set, const BenchRun& run, const BenchReport& report) {
  std::vector<NamedPlot> out = error_plots(run, report);
  if (!report.by_kind.empty()) out.push_back({"accuracy_by_condition.svg", accuracy_plot(report)});
  Plot time = time_plot(set, run, report);
  if (!time.series.empty()) out.push_back({"time_by_size.svg", std::move(time)});
  return out;
}

core::Status write_plots(const std::filesystem::path& folder, const std::vector<NamedPlot>& plots) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    return core::failure(core::ErrorCode::unreadable, folder.string(), "cannot make the folder: " + error.message());
  for (const NamedPlot& plot : plots) {
    auto written = core::write_file_atomically(folder / plot.file, to_svg(plot.plot));
    if (!written) return written;
  }
  return {};
}

}  // namespace pickcell::cli
