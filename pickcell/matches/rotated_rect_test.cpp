#include "pickcell/matches/rotated_rect.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace pickcell::matches {
namespace {

RotatedRect rect(double x, double y, double w, double h, double angle_rad) {
  RotatedRect r{};
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  const double corner[4][2] = {{-w / 2, -h / 2}, {w / 2, -h / 2}, {w / 2, h / 2}, {-w / 2, h / 2}};
  for (std::size_t i = 0; i < 4; ++i)
    r.corner[i] = {x + c * corner[i][0] - s * corner[i][1], y + s * corner[i][0] + c * corner[i][1]};
  return r;
}

bool contains(const RotatedRect& r, double x, double y) {
  int left = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& a = r.corner[i];
    const auto& b = r.corner[(i + 1) % 4];
    left += (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) >= 0 ? 1 : 0;
  }
  return left == 4 || left == 0;
}

TEST(RotatedRect, KnownOverlaps) {
  EXPECT_NEAR(area(rect(5, 5, 4, 3, 0.7)), 12, 1e-12);
  EXPECT_NEAR(overlap(rect(0, 0, 4, 2, 0.3), rect(0, 0, 4, 2, 0.3)), 1, 1e-12);
  EXPECT_EQ(overlap(rect(0, 0, 2, 2, 0), rect(5, 0, 2, 2, 0.5)), 0);
  EXPECT_NEAR(overlap(rect(0, 0, 2, 2, 0), rect(1, 0, 2, 2, 0)), 0.5, 1e-12);
  // A square and itself turned by 45 degrees meet in a regular octagon: 2 (sqrt 2 - 1) of the square.
  EXPECT_NEAR(overlap(rect(0, 0, 2, 2, 0), rect(0, 0, 2, 2, std::atan(1.0))), 2 * (std::sqrt(2.0) - 1), 1e-12);
  // A small one wholly inside: of the smaller area.
  EXPECT_NEAR(overlap(rect(0, 0, 10, 10, 0.2), rect(1, 1, 2, 1, 1.1)), 1, 1e-12);
}

TEST(RotatedRect, AgreesWithMonteCarlo) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> u(0, 1);
  for (int trial = 0; trial < 20; ++trial) {
    const RotatedRect a = rect(5 + u(rng), 5 + u(rng), 1 + 5 * u(rng), 1 + 5 * u(rng), 7 * u(rng));
    RotatedRect b = rect(5 + 3 * u(rng), 5 + 3 * u(rng), 1 + 5 * u(rng), 1 + 5 * u(rng), 7 * u(rng));
    if (trial % 2) std::swap(b.corner[1], b.corner[3]);  // the other sense of rotation
    int both = 0;
    constexpr int kSamples = 40000;
    for (int i = 0; i < kSamples; ++i) {
      const double x = 14 * u(rng) - 1;
      const double y = 14 * u(rng) - 1;
      both += contains(a, x, y) && contains(b, x, y) ? 1 : 0;
    }
    EXPECT_NEAR(intersection_area(a, b), 196.0 * both / kSamples, 0.6) << trial;
    EXPECT_NEAR(intersection_area(a, b), intersection_area(b, a), 1e-9);
  }
}

}  // namespace
}  // namespace pickcell::matches
