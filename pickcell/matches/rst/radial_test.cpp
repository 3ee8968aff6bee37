#include "pickcell/matches/rst/radial.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace pickcell::matches {
namespace {

std::vector<float> random_means(std::mt19937& rng, int n) {
  std::uniform_real_distribution<float> grey(0, 255);
  std::vector<float> out(static_cast<std::size_t>(n));
  for (float& v : out) v = grey(rng);
  return out;
}

RadialFeatures features_of(const std::vector<float>& means) {
  RadialFeatures out;
  set_radial_features(means.data(), 1, static_cast<int>(means.size()), out);
  return out;
}

/// Formula (1) of the paper in floating point, every turn.
std::pair<int, double> by_formula(const std::vector<float>& query, const std::vector<float>& scene) {
  const std::size_t n = query.size();
  std::pair<int, double> best{0, -2};
  for (std::size_t m = 0; m < n; ++m) {
    double mx = 0, my = 0;
    for (std::size_t j = 0; j < n; ++j)
      mx += query[j] / static_cast<double>(n), my += scene[j] / static_cast<double>(n);
    double xy = 0, xx = 0, yy = 0;
    for (std::size_t j = 0; j < n; ++j) {
      const double x = query[(j + n - m) % n] - mx, y = scene[j] - my;
      xy += x * y, xx += x * x, yy += y * y;
    }
    if (xy / std::sqrt(xx * yy) > best.second) best = {static_cast<int>(m), xy / std::sqrt(xx * yy)};
  }
  return best;
}

TEST(RstRadial, DotProductFindsTheShiftOfTheFullNccOnRandomVectors) {
  std::mt19937 rng(11);
  for (const int n : {36, 45, 72, 360, 4})
    for (int i = 0; i < 500; ++i) {
      const auto a = random_means(rng, n), b = random_means(rng, n);
      const RadialQuery query = make_radial_query(a);
      const RadialFeatures scene = features_of(b);
      const ShiftScore full = shift_by_ncc(query, scene, {}, false), dot = shift_by_every_dot(query, scene, false);
      ASSERT_EQ(dot.shift, full.shift) << n;
      ASSERT_NEAR(dot.ncc, full.ncc, 1e-12);
      const auto formula = by_formula(a, b);
      ASSERT_NEAR(dot.ncc, formula.second, 2e-3);  // fixed point of 1/8 grey value
    }
}

TEST(RstRadial, FindsHowFarAVectorWasTurned) {
  std::mt19937 rng(12);
  for (int m = 0; m < 36; ++m) {
    std::vector<float> a(36);  // smooth, as features of a picture are
    for (std::size_t j = 0; j < 36; ++j)
      a[j] = static_cast<float>(120 + 60 * std::cos(j * 0.1745) + 20 * std::sin(j * 0.349 + 1));
    std::vector<float> b = a;
    std::rotate(b.begin(), b.end() - m, b.end());
    for (float& v : b) v = 0.7f * v + 20;
    const RadialQuery query = make_radial_query(a);
    const ShiftScore fast = shift_by_dot(query, features_of(b), {}, false);
    EXPECT_EQ(fast.shift, m);
    EXPECT_NEAR(fast.ncc, 1, 1e-3);
    EXPECT_EQ(shift_by_ncc(query, features_of(b), {}, false).shift, m);
  }
}

TEST(RstRadial, LooksAt20TurnsInsteadOf36) {
  std::mt19937 rng(13);
  const RadialQuery query = make_radial_query(random_means(rng, 36));
  const RadialFeatures scene = features_of(random_means(rng, 36));
  EXPECT_EQ(shift_by_ncc(query, scene, {}, false).compared, 36);
  EXPECT_EQ(shift_by_dot(query, scene, {}, false).compared, 20);
}

TEST(RstRadial, OnlyAllowedTurnsAreFound) {
  std::mt19937 rng(14);
  const RadialQuery query = make_radial_query(random_means(rng, 36));
  for (int i = 0; i < 100; ++i) {
    const RadialFeatures scene = features_of(random_means(rng, 36));
    const AllowedShifts allowed{35, 0, 1};
    const ShiftScore a = shift_by_ncc(query, scene, allowed, false), b = shift_by_dot(query, scene, allowed, false);
    EXPECT_TRUE(a.shift == 35 || a.shift <= 1);
    EXPECT_EQ(a.shift, b.shift);
  }
}

TEST(RstRadial, FlatFeaturesMatchNothing) {
  std::mt19937 rng(15);
  const RadialQuery query = make_radial_query(random_means(rng, 36));
  const RadialFeatures flat = features_of(std::vector<float>(36, 90.f));
  EXPECT_LT(shift_by_ncc(query, flat, {}, false).ncc, -1);
  EXPECT_LT(shift_by_dot(query, flat, {}, false).ncc, -1);
}

}  // namespace
}  // namespace pickcell::matches
