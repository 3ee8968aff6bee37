#include "pickcell/matches/rst/lut.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "pickcell/image/image.hpp"
#include "pickcell/matches/rst/kernels.hpp"
#include "pickcell/matches/rst/radial.hpp"

namespace pickcell::matches {
namespace {

std::set<std::pair<int, int>> as_set(const std::vector<PixelOffset>& pixels) {
  std::set<std::pair<int, int>> out;
  for (const PixelOffset& p : pixels) out.emplace(p.dx, p.dy);
  return out;
}

TEST(RstLut, CirclesTouchEachPixelOnceAndLieOnTheirRadius) {
  for (int r = 0; r <= 60; ++r) {
    const auto pixels = circle_pixels(r);
    EXPECT_EQ(as_set(pixels).size(), pixels.size()) << r;
    for (const PixelOffset& p : pixels) EXPECT_NEAR(std::hypot(p.dx, p.dy), r, 0.75) << r;
  }
}

TEST(RstLut, LinesTouchEachPixelOnceAndReachTheirEnd) {
  for (const int length : {3, 10, 17, 40})
    for (int deg = 0; deg < 360; deg += 10) {
      const auto pixels = line_pixels(deg, length);
      EXPECT_EQ(as_set(pixels).size(), pixels.size());
      EXPECT_EQ(pixels.front(), (PixelOffset{0, 0}));
      const double a = deg * 3.14159265358979323846 / 180;
      EXPECT_NEAR(pixels.back().dx, length * std::cos(a), 0.51) << deg;
      EXPECT_NEAR(pixels.back().dy, -length * std::sin(a), 0.51) << deg;  // up on the screen is counter-clockwise
    }
}

TEST(RstLut, RadiiRunFromTheCentreToTheLargestWithoutDuplicates) {
  EXPECT_EQ(circle_radii(18, 10), (std::vector<int>{0, 2, 4, 6, 8, 10, 12, 14, 16, 18}));
  EXPECT_EQ(circle_radii(4, 10), (std::vector<int>{0, 1, 2, 3, 4}));
}

/// A picture and the same picture turned by quarter turns counter-clockwise about its middle.
image::Image turned(const image::Image& p) {
  image::Image out(p.width(), p.height());
  const int m = p.width() - 1;
  for (int y = 0; y <= m; ++y)
    for (int x = 0; x <= m; ++x) out.at(y, m - x) = p.at(x, y);
  return out;
}

std::vector<float> features(const image::Image& p, const PixelLists& lists) {
  const OffsetLists offsets = offsets_for(lists, p.stride());
  std::vector<float> block(static_cast<std::size_t>(lists.lists()) * kRstBlock), out;
  const int middle = p.width() / 2;
  mean_lists(p.row(middle) + middle, offsets, 1, block.data(), kRstBlock);
  for (std::size_t k = 0; k < static_cast<std::size_t>(lists.lists()); ++k) out.push_back(block[k * kRstBlock]);
  return out;
}

TEST(RstLut, QuarterTurnsKeepTheRingsAndShiftTheLines) {
  std::mt19937 rng(5);
  image::Image picture(41, 41);
  for (int y = 0; y < 41; ++y)
    for (int x = 0; x < 41; ++x) picture.at(x, y) = static_cast<std::uint8_t>(rng() & 255);
  const PixelLists circles = circle_lists(circle_radii(20, 10)), lines = line_lists(36, 20);
  const auto rings = features(picture, circles), rays = features(picture, lines);
  image::Image now = picture;
  for (int quarter = 1; quarter <= 3; ++quarter) {
    now = turned(now);
    EXPECT_EQ(features(now, circles), rings) << 90 * quarter;
    std::vector<float> shifted = rays;
    std::rotate(shifted.begin(), shifted.end() - 9 * quarter, shifted.end());
    EXPECT_EQ(features(now, lines), shifted) << 90 * quarter;
  }
}

}  // namespace
}  // namespace pickcell::matches
