#include "pickcell/matches/teach.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "pickcell/matches/learn/self_match.hpp"

namespace pickcell::matches {
namespace {

using image::Image;

/// Averages a formula over 3x3 points a pixel: no jagged edges.
Image drawn(int width, int height, const std::function<double(double, double)>& grey) {
  Image out(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      for (const double dy : {-1 / 3., 0., 1 / 3.})
        for (const double dx : {-1 / 3., 0., 1 / 3.}) sum += grey(x + dx, y + dy);
      out.at(x, y) = static_cast<std::uint8_t>(std::lround(sum / 9));
    }
  return out;
}

/// A wheel with spokes around (60, 60): the same every 360/spokes degrees.
Image wheel(int spokes) {
  return drawn(121, 121, [spokes](double x, double y) {
    const double r = std::hypot(x - 60, y - 60), a = std::atan2(y - 60, x - 60);
    if (r > 55) return 40.0;
    return r > 45 || r < 10 || std::cos(a * spokes) > 0.5 ? 200.0 : 70.0;
  });
}

Image disc_mask() {
  return drawn(121, 121, [](double x, double y) { return std::hypot(x - 60, y - 60) <= 56 ? 255.0 : 0.0; });
}

/// An L with a hole: nothing about it repeats.
Image bracket(int width = 120, int height = 90) {
  return drawn(width, height, [=](double x, double y) {
    const bool on = (x > 15 && x < 40 && y > 10 && y < height - 15) ||
                    (x > 15 && x < width - 15 && y > height - 40 && y < height - 15);
    const bool hole = std::hypot(x - 28, y - 25) < 7;
    return on && !hole ? 210.0 : 60.0;
  });
}

TeachInput of(const Image& picture) {
  TeachInput input;
  input.name = "part";
  input.picture = picture.view();
  return input;
}

std::string why_refused(const TeachInput& input) {
  const auto taught = teach(input);
  if (taught) return "taught";
  EXPECT_EQ(core::exit_code(taught.error().code), 2);
  return taught.error().line();
}

bool warns(const Taught& taught, const std::string& code) {
  for (const TeachWarning& w : taught.warnings)
    if (w.code == code) return true;
  return false;
}

TEST(Teach, TheReferencePointIsTheCentreUnlessSaidOtherwise) {
  const Image picture = bracket(121, 90);
  const auto taught = teach(of(picture));
  ASSERT_TRUE(taught) << taught.error().line();
  EXPECT_EQ(taught->model.ref_x_px, 60);
  EXPECT_EQ(taught->model.ref_y_px, 44.5);
  EXPECT_TRUE(taught->warnings.empty()) << taught->warnings[0].text;
  EXPECT_GT(taught->teach_ms, 0);
}

TEST(Teach, PlacesAreGivenInTheWholePictureAndKeptInTheCut) {
  const Image picture = bracket();
  TeachInput input = of(picture);
  input.roi = SearchOptions::Roi{10, 5, 101, 80};
  input.ref_px = TeachInput::Point{30, 20};
  input.grasps = {{50, 60, 30, true}};
  auto taught = teach(input);
  ASSERT_TRUE(taught) << taught.error().line();
  EXPECT_EQ(taught->model.picture.width(), 101);
  EXPECT_EQ(taught->model.picture.at(3, 7), picture.at(13, 12));
  EXPECT_EQ(taught->model.ref_x_px, 20);
  EXPECT_EQ(taught->model.ref_y_px, 15);
  EXPECT_EQ(taught->model.grasps[0].x_px, 40);
  EXPECT_EQ(taught->model.grasps[0].y_px, 55);
  EXPECT_TRUE(taught->model.grasps[0].sym180);
  EXPECT_EQ(taught->model.roi_x_px, 10);
  input.ref_px.reset();
  taught = teach(input);
  EXPECT_EQ(taught->model.ref_x_px, 50);
  EXPECT_EQ(taught->model.ref_y_px, 39.5);
}

TEST(Teach, MaskOfThePictureOrTheRoi) {
  const Image picture = bracket();
  Image whole(120, 90), cut(100, 80), other(99, 80), empty(120, 90);
  whole.fill(255);
  whole.at(12, 9) = 127;
  cut.fill(200);
  other.fill(255);
  TeachInput input = of(picture);
  input.roi = SearchOptions::Roi{10, 5, 100, 80};
  input.mask = whole.view();
  auto taught = teach(input);
  ASSERT_TRUE(taught) << taught.error().line();
  EXPECT_EQ(taught->model.mask.at(2, 4), 0);
  EXPECT_EQ(taught->model.mask.at(3, 4), 255);
  input.mask = cut.view();
  EXPECT_TRUE(teach(input));
  input.mask = other.view();
  EXPECT_EQ(
      why_refused(input),
      "mask: it is 99x80 but the picture is 120x90 and the ROI 100x80; use a mask of the picture's size or the ROI's");
  input.mask = empty.view();
  EXPECT_EQ(why_refused(input), "mask: it marks no part: no pixel is 128 or brighter; paint the part white");
}

TEST(Teach, BadRangesAndPlacesAreRefused) {
  const Image picture = bracket();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](auto change) {
    TeachInput input = of(picture);
    change(input);
    return why_refused(input);
  };
  EXPECT_EQ(refused([&](TeachInput& i) { i.angle_deg = {nan, 10}; }).substr(0, 6), "angle:");
  EXPECT_EQ(refused([](TeachInput& i) { i.angle_deg = {10, -10}; }),
            "angle: range 10,-10 is reversed; write the smaller number first");
  EXPECT_NE(refused([](TeachInput& i) { i.angle_deg = {-180, 200}; }), "taught");
  EXPECT_NE(refused([](TeachInput& i) { i.angle_deg = {5000, 5010}; }), "taught");
  EXPECT_NE(refused([](TeachInput& i) { i.scale = {0, 1}; }), "taught");
  EXPECT_NE(refused([](TeachInput& i) { i.scale = {1.1, 0.9}; }), "taught");
  EXPECT_NE(refused([](TeachInput& i) { i.scale = {1, std::numeric_limits<double>::infinity()}; }), "taught");
  EXPECT_NE(refused([](TeachInput& i) { i.roi = SearchOptions::Roi{100, 0, 21, 20}; }), "taught");
  EXPECT_NE(refused([](TeachInput& i) { i.roi = SearchOptions::Roi{-1, 0, 21, 20}; }), "taught");
  const std::string small =
      "; use one of at least 6 pixels a side and 64 in all; below about 25x25 some parts are missed";
  EXPECT_EQ(refused([](TeachInput& i) { i.roi = SearchOptions::Roi{0, 0, 3, 50}; }),
            "template: it is only 3x50 pixels" + small);
  EXPECT_EQ(refused([](TeachInput& i) { i.roi = SearchOptions::Roi{0, 0, 7, 9}; }),
            "template: it is only 7x9 pixels" + small);
  EXPECT_NE(refused([&](TeachInput& i) { i.ref_px = TeachInput::Point{nan, 0}; }), "taught");
  EXPECT_NE(refused([&](TeachInput& i) { i.grasps = {{0, 0, nan, false}}; }), "taught");
  EXPECT_NE(refused([&](TeachInput& i) { i.height_m = nan; }), "taught");
  EXPECT_EQ(refused([](TeachInput& i) { i.angle_deg = {170, 190}; }), "taught");
}

TEST(Teach, ATemplateWithoutFeaturesIsRefused) {
  Image flat(100, 80);
  flat.fill(120);
  EXPECT_EQ(
      why_refused(of(flat)),
      "template: it has no features (contrast 0.0 grey values); choose a region with edges, or light the part so that "
      "its shape shows");
  std::mt19937 random(5);
  std::normal_distribution<double> noise(120, 3);
  const Image noisy = drawn(100, 80, [&](double, double) { return 120 + 3 * (noise(random) - 120); });
  EXPECT_NE(why_refused(of(noisy)).find("no features"), std::string::npos);
}

TEST(Teach, AFlatPartInsideItsMaskIsRefusedHoweverTheBackgroundLooks) {
  const Image picture = bracket();
  Image mask(120, 90);
  for (int y = 60; y < 70; ++y)
    for (int x = 45; x < 90; ++x) mask.at(x, y) = 255;
  TeachInput input = of(picture);
  input.mask = mask.view();
  EXPECT_NE(why_refused(input).find("no features inside its mask"), std::string::npos);
}

TEST(Teach, WhatIsHardToFindIsWarnedAbout) {
  const Image small = drawn(24, 20, [](double x, double y) { return x > 8 && y > 9 ? 220. : 30.; });
  EXPECT_TRUE(warns(*teach(of(small)), "small"));
  const Image thin = drawn(200, 20, [](double x, double y) { return x > 50 && y > 9 ? 220. : 30.; });
  EXPECT_TRUE(warns(*teach(of(thin)), "thin"));
  const Image edge = drawn(100, 100, [](double x, double y) { return x + 0.5 * y > 70 ? 220. : 30.; });
  EXPECT_TRUE(warns(*teach(of(edge)), "one_direction"));
  const Image faint = drawn(120, 90, [](double x, double y) { return x > 50 && y > 40 ? 105. : 100.; });
  EXPECT_TRUE(warns(*teach(of(faint)), "low_contrast"));
}

TEST(SelfMatch, CountsTheSpokesOfAWheel) {
  const Image mask = disc_mask();
  for (const int spokes : {2, 3, 4, 5, 6, 7, 8, 12}) {
    const SelfMatch found = self_match(wheel(spokes).view(), mask.view());
    EXPECT_EQ(found.symmetry_order, spokes);
    ASSERT_GE(found.ambiguous_deg.size(), static_cast<std::size_t>(spokes - 1));
    EXPECT_NEAR(found.ambiguous_deg.front(), 360.0 / spokes, 1e-9);
  }
}

TEST(SelfMatch, ADiscHasNoAngleAndABracketHasOne) {
  const Image mask = disc_mask();
  const Image rings =
      drawn(121, 121, [](double x, double y) { return 120 + 80 * std::cos(std::hypot(x - 60, y - 60) / 6); });
  const SelfMatch disc = self_match(rings.view(), mask.view());
  EXPECT_EQ(disc.symmetry_order, kAnyAngle);
  EXPECT_EQ(disc.ambiguous_deg.size(), 11u);
  const SelfMatch one = self_match(bracket().view(), {});
  EXPECT_EQ(one.symmetry_order, 1);
  EXPECT_TRUE(one.ambiguous_deg.empty());
  EXPECT_LT(one.second_best, 0.8);
}

TEST(SelfMatch, ANearlySymmetricPartIsAmbiguousButNotSymmetric) {
  const Image mask = disc_mask();
  const Image cap = drawn(121, 121, [](double x, double y) {
    const double r = std::hypot(x - 60, y - 60);
    if (std::hypot(x - 60, y - 30) < 6 || std::hypot(x - 60, y - 90) < 6) return 20.0;  // two holes
    if (std::hypot(x - 85, y - 60) < 7) return 90.0;                                    // and a mark on one side
    return r < 50 ? 200.0 : 60.0;
  });
  const SelfMatch found = self_match(cap.view(), mask.view());
  EXPECT_EQ(found.symmetry_order, 1);
  ASSERT_EQ(found.ambiguous_deg.size(), 1u);
  EXPECT_NEAR(found.ambiguous_deg[0], 180, 2);
}

TEST(SelfMatch, TheOutlineCounts) {
  // the same texture everywhere, but the mask is a bar: turned by 90 degrees it lies elsewhere
  const Image texture =
      drawn(121, 121, [](double x, double y) { return 120 + 60 * std::cos(std::hypot(x - 60, y - 60) / 4); });
  const Image bar =
      drawn(121, 121, [](double x, double y) { return std::abs(x - 60) < 50 && std::abs(y - 60) < 15 ? 255. : 0.; });
  EXPECT_EQ(self_match(texture.view(), bar.view()).symmetry_order, 2);
}

/// A row of pins looks the same one pin further; a bracket, a wheel and a smooth ramp do not look the same elsewhere.
TEST(SelfMatch, ARowOfPinsRepeats) {
  const Image pins =
      drawn(160, 60, [](double x, double y) { return std::fmod(x + 4, 20.0) < 8 && y > 12 && y < 48 ? 210.0 : 60.0; });
  const SelfMatch row = self_match(pins.view(), {});
  ASSERT_TRUE(row.repeat);
  EXPECT_NEAR(row.repeat->dx_px, 20, 2);
  EXPECT_NEAR(row.repeat->dy_px, 0, 2);
  EXPECT_GT(row.second_best, 0.9);
  const auto taught = teach(of(pins));
  ASSERT_TRUE(taught);
  EXPECT_TRUE(warns(*taught, "repeats"));
  EXPECT_FALSE(self_match(bracket().view(), {}).repeat);
  EXPECT_FALSE(self_match(wheel(5).view(), disc_mask().view()).repeat);
  const Image ramp = drawn(120, 80, [](double x, double y) { return 40 + x + 0.5 * y; });
  EXPECT_FALSE(self_match(ramp.view(), {}).repeat);
}

}  // namespace
}  // namespace pickcell::matches
