#pragma once
/// Plots of a bench run: histograms of the errors, accuracy by condition, time by size.

#include <filesystem>
#include <vector>

#include "pickcell/cli/bench/report.hpp"
#include "pickcell/cli/svg_plot.hpp"

namespace pickcell::cli {

/// A plot and the name of its file.
struct NamedPlot {
  std::string file;
  Plot plot;
};

/// Plots for which the run has values: position_error.svg, angle_error.svg, scale_error.svg, accuracy_by_condition.svg,
/// time_by_size.svg.
[[nodiscard]] std::vector<NamedPlot> bench_plots(const Dataset& set, const BenchRun& run, const BenchReport& report);

/// Writes them into folder, which is made when missing.
[[nodiscard]] core::Status write_plots(const std::filesystem::path& folder, const std::vector<NamedPlot>& plots);

}  // namespace pickcell::cli
