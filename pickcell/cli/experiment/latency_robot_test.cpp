#include "pickcell/cli/experiment/latency_robot.hpp"

#include <gtest/gtest.h>

namespace pickcell::cli {
namespace {

TEST(RobotLatencyExperiment, MeasuresEveryPick) {  // in real time: one protocol is slow enough
  const auto measured = measure_robot_latency(RobotProtocol::hses, 1, ::testing::TempDir());
  ASSERT_TRUE(measured) << measured.error().line();
  ASSERT_EQ(measured->to_motion_ms.size(), 1u);
  EXPECT_GT(measured->submit_ms[0], 0);
  EXPECT_GE(measured->to_motion_ms[0], measured->submit_ms[0]);
}

}  // namespace
}  // namespace pickcell::cli
