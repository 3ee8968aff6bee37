#include "pickcell/frames/clock_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace pickcell::frames {
namespace {

using core::Duration;
using core::TimePoint;

/// A camera whose clock starts anywhere and runs too fast or too slow; frames arrive a least time after their stamp,
/// most a little later, some much later.
struct Model {
  double drift_ppm, least_ms, jitter_ms;
  std::mt19937 random{3};
  [[nodiscard]] std::int64_t stamp(double t_s) const {
    return 987'654'321'000 + std::llround(t_s * 1e9 * (1 - drift_ppm * 1e-6));
  }
  TimePoint arrival(double t_s) {
    std::exponential_distribution<double> more(1 / jitter_ms);
    const double late_ms = random() % 50 == 0 ? 40 : more(random);
    return TimePoint(Duration(std::llround(t_s * 1e9 + (least_ms + late_ms) * 1e6)));
  }
};

class Drift : public ::testing::TestWithParam<double> {};

TEST_P(Drift, IsFoundAndTheMomentIsRightToATenthOfAMillisecond) {
  Model model{GetParam(), 4, 0.5};
  ClockMap map;
  double t = 100, worst_ms = 0;
  for (int i = 0; i < 60 * 25; ++i, t += 0.04) {
    map.observe(model.stamp(t), model.arrival(t));
    if (i < 10 * 25) continue;
    const double error_ms = (core::seconds(map.at(model.stamp(t))) - t) * 1e3 - model.least_ms;
    worst_ms = std::max(worst_ms, std::abs(error_ms));
  }
  EXPECT_NEAR(map.drift_ppm(), GetParam(), 5);
  EXPECT_LT(worst_ms, 0.2);
}

INSTANTIATE_TEST_SUITE_P(Ppm, Drift, ::testing::Values(0.0, 50.0, -50.0, 300.0));

TEST(ClockMap, NeverLaterThanTheArrival) {
  Model model{20, 2, 3};
  ClockMap map;
  for (double t = 0; t < 4; t += 0.02) {
    const TimePoint arrived = model.arrival(t);
    map.observe(model.stamp(t), arrived);
    EXPECT_LE(map.at(model.stamp(t)), arrived);
  }
}

TEST(ClockMap, ACameraThatStartsAnewIsLearntAnew) {
  ClockMap map;
  EXPECT_FALSE(map.known());
  map.observe(5'000'000'000, TimePoint(Duration(1'000'000)));
  map.observe(1'000, TimePoint(Duration(2'000'000)));
  EXPECT_EQ(map.at(1'000), TimePoint(Duration(2'000'000)));
  // A clock that is set by hours while it runs.
  map.observe(7'200'000'000'000, TimePoint(Duration(3'000'000)));
  EXPECT_EQ(map.at(7'200'000'000'000), TimePoint(Duration(3'000'000)));
}

TEST(ClockMap, IsExactWhereNothingDelays) {
  ClockMap map;
  for (std::int64_t t = 1; t < 20'000'000'000; t += 777'777'777) {
    map.observe(t, TimePoint(Duration(t)));
    EXPECT_EQ(map.at(t), TimePoint(Duration(t))) << "simulated time";
  }
}

}  // namespace
}  // namespace pickcell::frames
