/// Engine best far from the middle of its ranges: scales, angles, sizes, numbers. Own truth throughout.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pickcell/matches/best_engine.hpp"
#include "pickcell/matches/test_scenes.hpp"

namespace pickcell::matches {
namespace {

using testing::Texture;

image::Pyramid pyramid_of(const image::Image& picture) {
  image::Pyramid out;
  out.build(picture.view());
  return out;
}

FindResult find(const image::Image& picture, std::span<const Model* const> models, const SearchOptions& options) {
  BestEngine engine;
  auto found = engine.find(pyramid_of(picture), models, options);
  EXPECT_TRUE(found) << (found ? "" : found.error().why);
  return found ? std::move(*found) : FindResult{};
}

TEST(BestRanges, ScalesFromHalfToDouble) {
  const Texture texture(72, 60, 4);
  const Model model = testing::texture_model(texture, 72, 60);
  const Model* one[] = {&model};
  SearchOptions options;
  options.scale = Range{0.5, 2};
  for (const double scale : {0.52, 0.66, 0.85, 1.2, 1.55, 1.95}) {
    const Pose2d truth{210, 160, 57 * scale, scale};
    image::Image picture = testing::draw_ground(420, 320, 6);
    testing::draw_part(picture, texture, model, truth);
    testing::add_noise(picture, 3, 2);
    const FindResult found = find(picture, one, options);
    ASSERT_EQ(found.matches.size(), 1u) << scale;
    EXPECT_LT(testing::distance_px(found.matches[0].pose, truth), 0.3) << scale;
    EXPECT_LT(testing::turn_deg(found.matches[0].pose, truth), 0.4) << scale;
    EXPECT_NEAR(found.matches[0].pose.scale, scale, 0.01 * scale);
  }
}

/// Ranges may cross 180 degrees, and may be one angle.
TEST(BestRanges, AnglesInsideTheRangeOnly) {
  const Texture texture(70, 54, 2);
  const Model model = testing::texture_model(texture, 70, 54);
  const Model* one[] = {&model};
  struct Case {
    Range range;
    double angle_deg;
    bool inside;
  };
  for (const Case& c :
       {Case{{-10, 10}, 8, true}, Case{{-10, 10}, 40, false}, Case{{-10, 10}, 178, false}, Case{{170, 190}, -172, true},
        Case{{170, 190}, 0, false}, Case{{0, 0}, 0.4, true}, Case{{0, 0}, 90, false}, Case{{-180, 180}, 135, true}}) {
    image::Image picture = testing::draw_ground(320, 240, 5);
    testing::draw_part(picture, texture, model, {150, 110, c.angle_deg, 1});
    SearchOptions options;
    options.angle_deg = c.range;
    options.min_score = 0.5;
    const FindResult found = find(picture, one, options);
    EXPECT_EQ(found.matches.size(), c.inside ? 1u : 0u) << c.range.lo << " to " << c.range.hi << ": " << c.angle_deg;
  }
}

TEST(BestRanges, TemplatesOf20Pixels) {
  int good = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Texture texture(20, 20, seed);
    const Model model = testing::texture_model(texture, 20, 20);
    const Model* one[] = {&model};
    const Pose2d truth{60.0 + 15 * seed, 100.0 + 5 * seed, 30.0 * seed - 170, 0.92 + 0.015 * seed};
    image::Image picture = testing::draw_ground(320, 240, seed + 50);
    testing::draw_part(picture, texture, model, truth);
    testing::add_noise(picture, 2, seed);
    SearchOptions options;
    options.min_score = 0;
    const FindResult found = find(picture, one, options);
    good += !found.matches.empty() && testing::distance_px(found.matches[0].pose, truth) < 0.5 &&
            testing::turn_deg(found.matches[0].pose, truth) < 2;
  }
  EXPECT_GE(good, 11);
}

TEST(BestRanges, AHundredParts) {
  const Texture texture(44, 36, 3);
  const Model model = testing::texture_model(texture, 44, 36);
  const Model* one[] = {&model};
  image::Image picture = testing::draw_ground(700, 700, 8);
  std::vector<Pose2d> truths;
  for (int i = 0; i < 100; ++i)
    truths.push_back({40 + 68.0 * (i % 10) + 0.13 * (i % 7), 40 + 68.0 * (i / 10) + 0.17 * (i % 5), 37.0 * i - 180,
                      0.92 + 0.0016 * i});
  for (const Pose2d& t : truths) testing::draw_part(picture, texture, model, t);
  testing::add_noise(picture, 3, 4);
  SearchOptions options;
  options.max_matches = 150;
  const FindResult found = find(picture, one, options);
  EXPECT_EQ(found.matches.size(), 100u);
  for (const Pose2d& truth : truths) {
    double nearest = std::numeric_limits<double>::max();
    for (const Match& m : found.matches)
      if (testing::turn_deg(m.pose, truth) < 1) nearest = std::min(nearest, testing::distance_px(m.pose, truth));
    EXPECT_LT(nearest, 0.3) << truth.x_px << ", " << truth.y_px;
  }
}

}  // namespace
}  // namespace pickcell::matches
