#include "pickcell/cli/bench/plots.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numeric>

namespace pickcell::cli {
namespace {

ImageOutcome outcome_of(std::size_t image, double px, double ms) {
  ImageOutcome out;
  out.image = image;
  out.ms = ms;
  out.score.truths = out.score.matches = 1;
  out.score.correct = true;
  out.score.hits.push_back({0, 0, {px, px / 2, px / 3}});
  return out;
}

Dataset three_images() {
  auto set =
      parse_dataset(R"({"name":"a <small> set","templates":[{"id":"a","file":"a.png","size":"small","w":30,"h":40}],
    "images":[{"file":"0.png","template":"a","kind":"clean","x":1,"y":1,"angle":0,"scale":1},
              {"file":"1.png","template":"a","kind":"clean","x":1,"y":1,"angle":0,"scale":1},
              {"file":"2.png","template":"a","kind":"mixed","x":1,"y":1,"angle":0,"scale":1}]})",
                    "truth.json", "/set");
  return *set;
}

std::vector<NamedPlot> plots_of_three_images() {
  const Dataset set = three_images();
  BenchRun run;
  run.images = {outcome_of(0, 0.01, 1), outcome_of(1, 0.1, 2), outcome_of(2, 500, 30)};
  return bench_plots(set, run, summarise(set, run));
}

double bar_sum(const Plot& plot) {
  const auto& bars = plot.series.at(0).bars;
  return std::accumulate(bars.begin(), bars.end(), 0.0, [](double sum, const PlotBar& bar) { return sum + bar.y; });
}

TEST(AxisTicks, AreRoundNumbersInsideTheAxis) {
  EXPECT_EQ(axis_ticks({"", 0, 100, false, {}}, 5), (std::vector<double>{0, 20, 40, 60, 80, 100}));
  EXPECT_EQ(axis_ticks({"", 3, 17, false, {}}, 3), (std::vector<double>{5, 10, 15}));
  EXPECT_EQ(axis_ticks({"", 0, 1, false, {}}, 1), (std::vector<double>{0, 1}));
}

TEST(AxisTicks, LogarithmicAxesHaveDecades) {
  EXPECT_EQ(axis_ticks({"", 0.001, 20, true, {}}), (std::vector<double>{0.001, 0.01, 0.1, 1, 10}));
  EXPECT_EQ(axis_ticks({"", 1, 20, true, {}}), (std::vector<double>{1, 2, 5, 10, 20}));
}

TEST(BenchPlots, AHistogramCountsEveryPoseOnceAlsoOutsideItsEnds) {
  const auto plots = plots_of_three_images();
  ASSERT_EQ(plots.size(), 5u);
  for (int i = 0; i < 3; ++i) EXPECT_DOUBLE_EQ(bar_sum(plots[static_cast<std::size_t>(i)].plot), 3);
  EXPECT_DOUBLE_EQ(plots[0].plot.series[0].bars.back().y, 1);  // 500 px
}

TEST(BenchPlots, AccuracyHasABarPerConditionAndTimeAPointPerImage) {
  const auto plots = plots_of_three_images();
  EXPECT_EQ(plots[3].plot.x.categories, (std::vector<std::string>{"clean (2)", "mixed (1)"}));
  EXPECT_DOUBLE_EQ(plots[3].plot.series[0].bars[0].y, 100);
  EXPECT_DOUBLE_EQ(plots[3].plot.series[1].bars[0].y, 0);
  EXPECT_EQ(plots[4].plot.series[0].points.size(), 3u);
  EXPECT_LE(plots[4].plot.y.lo, 1);
  EXPECT_GE(plots[4].plot.y.hi, 30);
}

TEST(BenchPlots, SvgNamesAxesAndEscapesText) {
  const std::string svg = to_svg(plots_of_three_images()[0].plot);
  EXPECT_EQ(svg.rfind("<svg", 0), 0u);
  EXPECT_NE(svg.find("a &lt;small&gt; set"), std::string::npos);
  EXPECT_NE(svg.find("px (log)"), std::string::npos);
  EXPECT_NE(svg.find("strict: 1 px"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST(BenchPlots, ARunThatFoundNothingHasNoErrorPlots) {
  const Dataset set = three_images();
  BenchRun run;
  run.images.resize(1);
  run.images[0].score.why = "no match";
  const auto plots = bench_plots(set, run, summarise(set, run));
  ASSERT_EQ(plots.size(), 1u);
  EXPECT_EQ(plots[0].file, "accuracy_by_condition.svg");
}

TEST(BenchPlots, AreWrittenToAFolderThatIsMade) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "pickcell_plots_test" / "deep";
  std::filesystem::remove_all(folder.parent_path());
  ASSERT_TRUE(write_plots(folder, plots_of_three_images()));
  EXPECT_GT(std::filesystem::file_size(folder / "time_by_size.svg"), 1000u);
  std::ofstream(folder / "file") << "x";
  EXPECT_FALSE(write_plots(folder / "file", plots_of_three_images()));
  std::filesystem::remove_all(folder.parent_path());
}

}  // namespace
}  // namespace pickcell::cli
