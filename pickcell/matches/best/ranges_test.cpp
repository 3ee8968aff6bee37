/// Engine best far from the middle of its ranges: scales, angles, sizes, numbers. Own truth throughout.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "pickcell/matches/best/engine.hpp"
#include "pickcell/matches/limits.hpp"
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

/// A little beyond a range is within what is documented; more is turned down, and says why. A range of one value allows
/// for tilt.
TEST(BestRanges, AnswersKeepToTheirRanges) {
  const Texture texture(70, 54, 2);
  const Model model = testing::texture_model(texture, 70, 54);
  const Model* one[] = {&model};
  struct Case {
    Range angle, scale;
    double angle_deg, true_scale;
    std::optional<RejectReason> reason;
  };
  const Range turns{-10, 10}, all{-180, 180}, sizes{0.95, 1.05}, same{1, 1};
  for (const Case& c :
       {Case{turns, sizes, 10.3, 1, {}}, Case{turns, sizes, -9.9, 1, {}},
        Case{turns, sizes, 11.5, 1, RejectReason::limit}, Case{turns, sizes, -12, 1, RejectReason::limit},
        Case{all, sizes, 77, 1.053, {}}, Case{all, sizes, 77, 1.095, RejectReason::scale},
        Case{all, sizes, 77, 0.91, RejectReason::scale}, Case{{0, 0}, same, 1.5, 1.01, {}},
        Case{{0, 0}, same, -3.5, 1, RejectReason::limit}}) {
    for (const int most : {1, 5}) {
      image::Image picture = testing::draw_ground(320, 240, 5);
      testing::draw_part(picture, texture, model, {150, 110, c.angle_deg, c.true_scale});
      testing::add_noise(picture, 3, 2);
      SearchOptions options;
      options.angle_deg = c.angle;
      options.scale = c.scale;
      options.min_score = 0.6;
      options.max_matches = most;
      options.explain = true;
      const FindResult found = find(picture, one, options);
      const auto said = [&] {
        return ::testing::Message() << c.angle_deg << " degrees, " << c.true_scale << ", of " << most;
      };
      EXPECT_EQ(found.matches.size(), c.reason ? 0u : 1u) << said();
      for (const Match& m : found.matches) EXPECT_LT(testing::distance_px(m.pose, {150, 110, 0, 1}), 0.3) << said();
      if (!c.reason) continue;
      EXPECT_TRUE(std::any_of(found.rejected.begin(), found.rejected.end(), [&](const Rejected& r) {
        return r.reason == *c.reason && r.stage == Stage::final &&
               testing::distance_px(r.match.pose, {150, 110, 0, 1}) < 1;
      })) << said();
    }
  }
}

/// What is not asked for may look more like the part, and yet does not hide it.
TEST(BestRanges, AnotherOneBeyondTheRangeHidesNothing) {
  const Texture texture(70, 54, 2);
  const Model model = testing::texture_model(texture, 70, 54);
  const Model* one[] = {&model};
  const Pose2d asked_for{90, 110, 20, 1.04};
  image::Image picture = testing::draw_ground(360, 240, 5);
  testing::draw_part(picture, texture, model, {250, 120, 75, 1.15});
  testing::draw_part(picture, texture, model, asked_for);
  testing::add_noise(picture, 3, 2);
  SearchOptions options;
  for (const double low : {0.9, 1.0, 1.03}) {
    options.scale = Range{low, 1.05};
    const FindResult found = find(picture, one, options);
    ASSERT_EQ(found.matches.size(), 1u) << low;
    EXPECT_LT(testing::distance_px(found.matches[0].pose, asked_for), 0.3) << low;
  }
}

/// A wire has the finest cells there are and a wide circle: what is made of it stays small.
TEST(BestRanges, ALongWireIsPreparedAtOnce) {
  Model wire;
  wire.name = "wire";
  wire.picture.resize(9, 800);
  wire.picture.fill(60);
  wire.mask.resize(9, 800);
  for (int y = 5; y < 795; ++y)
    for (int x = 3; x < 6; ++x) {
      wire.picture.at(x, y) = static_cast<std::uint8_t>(200 - 3 * (y % 17));
      wire.mask.at(x, y) = 255;
    }
  wire.scale = {0.8, 1.25};
  const CoarseTemplates templates = build_coarse_templates(build_template_pyramid(wire), CoarseDetail{}, wire.scale);
  const double side = 2 * templates.reach + 1;
  EXPECT_LT(4 * static_cast<double>(templates.tiles.size()) * side * side, 2e8);
}

TEST(BestRanges, TheNearestAnswerOfARange) {
  EXPECT_EQ(nearest_angle(3, {-10, 10}), 3);
  EXPECT_EQ(nearest_angle(12, {-10, 10}), 10.5);
  EXPECT_EQ(nearest_angle(-175, {160, 180}), 180.5);
  EXPECT_EQ(nearest_angle(-150, {-1, 1}), -1.5);
  EXPECT_EQ(nearest_angle(-150, {0, 0}), -2);
  EXPECT_EQ(nearest_angle(123, {-180, 180}), 123);
  EXPECT_DOUBLE_EQ(nearest_scale(1.2, {0.9, 1.1}), 1.1 * 1.005);
  EXPECT_DOUBLE_EQ(nearest_scale(0.9, {1, 1}), 0.98);
  EXPECT_TRUE(scale_answers(nearest_scale(2, {0.9, 1.1}), {0.9, 1.1}));
  EXPECT_TRUE(angle_answers(nearest_angle(99, {-10, 10}), {-10, 10}));
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
