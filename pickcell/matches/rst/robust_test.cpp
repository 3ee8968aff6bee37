#include "pickcell/matches/rst/robust.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <set>
#include <utility>

namespace pickcell::matches {
namespace {

RobustSearch how(RstVariant variant, int level) {
  RobustSearch h;
  h.variant = variant;
  h.level = level;
  return h;
}

const RobustPlace kStart{40, 80, 350, 1};

/// Falls off with the distance from one place: what a correlation does near its peak.
PlaceScore peak_at(int x, int y, int angle_deg, int scale) {
  return [=](const RobustPlace& p) {
    const double turn = std::abs(std::remainder(p.angle_deg - angle_deg, 360));
    return WindowScore{1 - 0.01 * std::hypot(p.x - x, p.y - y) - 0.01 * turn - 0.05 * std::abs(p.scale - scale), 1};
  };
}

int count(RstVariant variant, int level) {
  return search_robustly(how(variant, level), kStart, peak_at(41, 81, 351, 1)).ncc_count;
}

TEST(RstRobust, Takes17CorrelationsInsteadOf480) {
  EXPECT_EQ(count(RstVariant::rst, 2), 17);
  EXPECT_EQ(count(RstVariant::erst, 2), 480);
  EXPECT_EQ(count(RstVariant::rst, 1), 14);
  EXPECT_EQ(count(RstVariant::erst, 1), 120);
  EXPECT_EQ(count(RstVariant::rst, 3), 20);
  EXPECT_EQ(count(RstVariant::erst, 3), 1920);
}

/// Places visited at the coarse angle and scale before the angle is searched.
std::size_t places(RstVariant variant, int level) {
  std::set<std::pair<int, int>> seen;
  const PlaceScore score = peak_at(43, 83, 350, 1);
  static_cast<void>(search_robustly(how(variant, level), kStart, [&](const RobustPlace& p) {
    seen.emplace(p.x, p.y);
    return score(p);
  }));
  return seen.size();
}

TEST(RstRobust, Looks7PlacesInsteadOf16And10InsteadOf64) {
  EXPECT_EQ(places(RstVariant::rst, 1), 4u);
  EXPECT_EQ(places(RstVariant::erst, 1), 4u);
  EXPECT_EQ(places(RstVariant::rst, 2), 7u);
  EXPECT_EQ(places(RstVariant::erst, 2), 16u);
  EXPECT_EQ(places(RstVariant::rst, 3), 10u);
  EXPECT_EQ(places(RstVariant::erst, 3), 64u);
}

TEST(RstRobust, BothReachEveryPlaceAngleAndScaleOfTheBlock) {
  for (const RstVariant variant : {RstVariant::rst, RstVariant::erst})
    for (int dy = 0; dy < 4; ++dy)
      for (int dx = 0; dx < 4; ++dx)
        for (int d = -5; d <= 4; ++d)
          for (int scale = 0; scale < 3; ++scale) {
            const int angle = (350 + d) % 360;
            const RobustResult r = search_robustly(how(variant, 2), kStart, peak_at(40 + dx, 80 + dy, angle, scale));
            ASSERT_EQ(r.place.x, 40 + dx);
            ASSERT_EQ(r.place.y, 80 + dy);
            ASSERT_EQ(r.place.angle_deg, angle);
            ASSERT_EQ(r.place.scale, scale);
          }
}

/// Every place of blocks of 2 to 32 pixels is found where the score falls off with the distance, gently or steeply.
TEST(RstRobust, HalvingEndsAtEachPlaceOfABlock) {
  for (int level = 1; level <= 5; ++level)
    for (const double power : {0.5, 1.0, 4.0})
      for (int y = 0; y < 1 << level; ++y)
        for (int x = 0; x < 1 << level; ++x) {
          const PlaceScore score = [=](const RobustPlace& p) {
            return WindowScore{-std::pow(std::hypot(p.x - 40 - x, p.y - 80 - y), power) / 1e7, 1};
          };
          const RobustResult r = search_robustly(how(RstVariant::rst, level), kStart, score);
          ASSERT_EQ(r.place.x, 40 + x) << level << " " << y << " " << power;
          ASSERT_EQ(r.place.y, 80 + y) << level << " " << x << " " << power;
        }
}

TEST(RstRobust, AngleOffsetsReachHalfTheStep) {
  EXPECT_EQ(first_angle_offset_deg(10), 3);
  for (int alpha = 1; alpha <= 90; ++alpha) {
    const int k = first_angle_offset_deg(alpha);
    EXPECT_GE(k * (k + 1), alpha);
    EXPECT_TRUE(k == 1 || (k - 1) * k < alpha);
  }
}

TEST(RstRobust, KeepsToTheAllowedAngles) {
  std::vector<bool> allowed(360, false);
  for (int a = 349; a < 353; ++a) allowed[static_cast<std::size_t>(a)] = true;
  for (const RstVariant variant : {RstVariant::rst, RstVariant::erst}) {
    RobustSearch h = how(variant, 2);
    h.allowed_deg = &allowed;
    EXPECT_EQ(search_robustly(h, kStart, peak_at(41, 81, 357, 1)).place.angle_deg, 352);
  }
}

}  // namespace
}  // namespace pickcell::matches
