#include "pickcell/image/draw.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "pickcell/image/stroke_font.hpp"

namespace pickcell::image {
namespace {

int brightness(const RgbImage& picture, int x, int y) { return picture.at(x, y)[0]; }

double total(const RgbImage& picture) {
  double sum = 0;
  for (const Rgb& p : picture.pixels) sum += p[0];
  return sum;
}

Pen plain(double width_px) {
  Pen pen;
  pen.width_px = width_px;
  pen.halo_px = 0;
  return pen;
}

TEST(Draw, AStrokePaintsItsAreaAtEveryAngleAndSubPixelPlace) {
  for (const double degrees : {0., 13., 45., 77., 90.}) {
    RgbImage picture(120, 120, {0, 0, 0});
    const double a = degrees * 3.14159265358979 / 180;
    draw_path(picture, {{40.3, 40.7}, {40.3 + 50 * std::cos(a), 40.7 + 50 * std::sin(a)}}, plain(4));
    EXPECT_NEAR(total(picture) / 255, 50 * 4 + 3.14159 * 4, 6) << degrees;  // a capsule
  }
}

TEST(Draw, LinesGoThroughPixelCentres) {
  RgbImage picture(20, 20, {0, 0, 0});
  draw_path(picture, {{2, 5}, {15, 5}}, plain(1));
  EXPECT_EQ(brightness(picture, 8, 5), 255);
  EXPECT_EQ(brightness(picture, 8, 4), 0);
  EXPECT_EQ(brightness(picture, 8, 6), 0);
  RgbImage between(20, 20, {0, 0, 0});
  draw_path(between, {{2, 5.5}, {15, 5.5}}, plain(1));
  EXPECT_NEAR(brightness(between, 8, 5), 128, 1);
  EXPECT_NEAR(brightness(between, 8, 6), 128, 1);
}

TEST(Draw, TheHaloMakesWhiteReadableOnWhite) {
  RgbImage picture(40, 20, {255, 255, 255});
  draw_path(picture, {{5, 10}, {35, 10}}, Pen{});
  int darkest = 255;
  for (int y = 0; y < 20; ++y) darkest = std::min(darkest, brightness(picture, 20, y));
  EXPECT_LT(darkest, 110);
  EXPECT_EQ(brightness(picture, 20, 10), 255);
}

TEST(Draw, CrossingsOfOneStrokeAreNotPaintedTwice) {
  Pen pen = plain(3);
  pen.opacity = 0.5;
  RgbImage picture(41, 41, {0, 0, 0});
  const std::vector<Path> cross{{{5, 20}, {35, 20}}, {{20, 5}, {20, 35}}};
  draw_paths(picture, cross, pen);
  EXPECT_EQ(brightness(picture, 20, 20), brightness(picture, 10, 20));
}

TEST(Draw, WhatLiesOutsideIsCutOff) {
  RgbImage picture(30, 20, {9, 9, 9});
  const double far = 1e12, nan = std::numeric_limits<double>::quiet_NaN();
  draw_path(picture, {{-50, -80}, {90, 100}}, Pen{});
  const std::vector<Path> mixed{{{-far, 3}, {far, 3}}, {{far, far}, {2 * far, far}}};
  draw_paths(picture, mixed, Pen{});
  draw_path(picture, {{100, 100}, {120, 140}}, Pen{});
  draw_path(picture, {}, Pen{});
  RgbImage before = picture;
  draw_path(picture, {{nan, 1}, {2, 2}}, Pen{});
  EXPECT_EQ(before.pixels, picture.pixels);
  RgbImage nothing;
  draw_path(nothing, {{0, 0}, {1, 1}}, Pen{});
  draw_text(picture, {-4, 15}, "cut off at all sides of it", 14, Pen{});
}

TEST(Draw, EveryPrintableCharacterHasItsOwnShape) {
  std::set<std::vector<std::pair<double, double>>> shapes;
  for (char c = '!'; c <= '~'; ++c) {
    std::vector<Path> strokes;
    stroke_font::add_glyph(c, {0, 0}, 1, strokes);
    ASSERT_FALSE(strokes.empty()) << c;
    std::vector<std::pair<double, double>> shape;
    for (const Path& stroke : strokes) {
      for (const Point& p : stroke) {
        EXPECT_TRUE(p.x >= 0 && p.x <= 4 && p.y >= 0 && p.y <= 8) << c;
        shape.emplace_back(p.x, p.y);
      }
      shape.emplace_back(-1, -1);
    }
    const bool fresh = shapes.insert(shape).second;
    EXPECT_TRUE(fresh || c == 'O') << c;  // 'O' is drawn like '0'
  }
  EXPECT_DOUBLE_EQ(text_width("abc", 12), 36);
}

}  // namespace
}  // namespace pickcell::image
