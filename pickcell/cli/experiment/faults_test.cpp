// The fault soak in its short form: the long one is `pickcell experiment faults`.

#include "pickcell/cli/experiment/faults_soak.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <numeric>

namespace pickcell::cli {
namespace {

TEST(FaultSoak, NothingTwiceNothingLostNoForbiddenMotionEveryStopExplained) {
  FaultSoakOptions options;
  options.picks = 180;
  options.seed = 20261125;
  options.answer_timeout = std::chrono::milliseconds(100);  // also under a sanitizer
  options.folder = std::filesystem::path(::testing::TempDir()) / ("pickcell_soak_" + std::to_string(getpid()));
  const auto report = run_fault_soak(options);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_THAT(report->findings, ::testing::IsEmpty());
  EXPECT_EQ(report->executed_twice, 0);
  EXPECT_EQ(report->lost, 0);
  EXPECT_EQ(report->forbidden_motions, 0);
  EXPECT_EQ(report->stops_explained, report->stops);
  EXPECT_GE(report->parts, 180);
  EXPECT_EQ(report->done + report->refused + report->unknown, report->parts);
  EXPECT_EQ(std::accumulate(report->unknown_after.begin(), report->unknown_after.end(), 0), report->unknown);
  EXPECT_EQ(report->unknown_untouched + report->unknown_in_between + report->unknown_placed, report->unknown);
  // It was no walk in the park.
  EXPECT_GT(report->stops, 30);
  EXPECT_GT(report->pc_starts, 10);
  EXPECT_GT(report->unknown, 10);
  EXPECT_GT(report->withdrawn, 5);
  EXPECT_GT(report->outside_refused, 0);
  for (const int n : report->injected) EXPECT_GT(n, 0);
  std::filesystem::remove_all(options.folder);
}

}  // namespace
}  // namespace pickcell::cli
