#include "pickcell/matches/rst_engine.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "pickcell/matches/test_scenes.hpp"

namespace pickcell::matches {
namespace {

using testing::distance_px;
using testing::draw_part;
using testing::Texture;
using testing::turn_deg;

struct Scene {
  Texture texture;
  Model model;
  Scene(int w, int h, unsigned seed) : texture(w, h, seed), model(testing::texture_model(texture, w, h)) {}

  [[nodiscard]] image::Image with(const Pose2d& pose, int width = 320, int height = 240) const {
    image::Image out = testing::draw_ground(width, height, 77);
    draw_part(out, texture, model, pose);
    return out;
  }
};

FindResult find(RstEngine& engine, const image::Image& picture, const Model& model, SearchOptions options = {}) {
  image::Pyramid pyramid;
  pyramid.build(picture.view());
  const Model* one[] = {&model};
  auto found = engine.find(pyramid, one, options);
  EXPECT_TRUE(found) << found.error().line();
  return found ? *found : FindResult{};
}

const StageReport& stage(const FindResult& r, const std::string& name) {
  for (const StageReport& s : r.stages)
    if (s.stage == name) return s;
  throw std::runtime_error("no stage " + name);
}

TEST(RstEngine, BothFindAPartAtAnyPose) {
  const Scene scene(120, 110, 4);
  RstEngine rst(RstVariant::rst), erst(RstVariant::erst);
  for (const Pose2d& pose : {Pose2d{160, 120, 0, 1}, Pose2d{150.4, 118.7, 73, 1.1}, Pose2d{171.2, 125.1, -152, 0.9}}) {
    const image::Image picture = scene.with(pose);
    for (RstEngine* engine : {&rst, &erst}) {
      const FindResult r = find(*engine, picture, scene.model);
      ASSERT_EQ(r.matches.size(), 1u) << engine->name() << " " << pose.angle_deg;
      EXPECT_LT(distance_px(r.matches[0].pose, pose), 2) << engine->name();
      EXPECT_LT(turn_deg(r.matches[0].pose, pose), 2) << engine->name();
      EXPECT_NEAR(r.matches[0].pose.scale, pose.scale, 0.001);
    }
  }
}

TEST(RstEngine, StagesReportTheCountsOfThePaper) {
  const Scene scene(120, 110, 4);
  RstEngine rst(RstVariant::rst), erst(RstVariant::erst);
  const image::Image picture = scene.with({160, 120, 40, 1});
  const FindResult fast = find(rst, picture, scene.model), full = find(erst, picture, scene.model);
  // NP = 2: positions where the largest circle (radius 14 of a template 27 pixels high) fits an 80 x 60 picture
  EXPECT_EQ(stage(fast, "circular").population, (80 - 28) * (60 - 28));
  EXPECT_EQ(stage(fast, "circular").feature_count, 3 * stage(fast, "circular").population);
  EXPECT_EQ(stage(fast, "radial").population, stage(fast, "circular").survivors);
  EXPECT_EQ(stage(full, "radial").population, stage(fast, "radial").population);
  EXPECT_EQ(stage(fast, "radial").feature_count, 20 * stage(fast, "radial").population);
  EXPECT_EQ(stage(full, "radial").feature_count, 36 * stage(full, "radial").population);
  EXPECT_EQ(stage(fast, "template").ncc_count, stage(fast, "template").population);
  ASSERT_GT(stage(fast, "robust").population, 0);
  EXPECT_EQ(stage(fast, "robust").ncc_count, 17 * stage(fast, "robust").population);
  EXPECT_EQ(stage(full, "robust").ncc_count, 480 * stage(full, "robust").population);
}

/// A picture shifted by less than a coarse pixel finds the shifted pose, whatever the remainder of the template's size.
TEST(RstEngine, ShiftsWithinACoarsePixelMoveTheFindAsMuch) {
  for (const int size : {100, 101, 102, 103}) {
    const Scene scene(size, size, 9);
    RstEngine erst(RstVariant::erst);
    for (int shift = 0; shift < 4; ++shift) {
      const Pose2d pose{150.0 + shift + 0.5 * (size % 2 == 0), 110.0 + shift + 0.5 * (size % 2 == 0), 0, 1};
      const FindResult r = find(erst, scene.with(pose), scene.model);
      ASSERT_EQ(r.matches.size(), 1u) << size << " " << shift;
      EXPECT_LT(distance_px(r.matches[0].pose, pose), 0.75) << size << " " << shift;
      EXPECT_LT(turn_deg(r.matches[0].pose, pose), 0.5);
    }
  }
}

TEST(RstEngine, SubpixelRefinementIsMoreExact) {
  const Scene scene(120, 110, 4);
  RstSettings settings;
  settings.refine_subpixel = true;
  RstEngine refined(RstVariant::rst, settings);
  const Pose2d pose{150.37, 118.72, 73.4, 1.04};
  const FindResult r = find(refined, scene.with(pose), scene.model);
  ASSERT_EQ(r.matches.size(), 1u);
  EXPECT_LT(distance_px(r.matches[0].pose, pose), 0.1);
  EXPECT_LT(turn_deg(r.matches[0].pose, pose), 0.1);
  EXPECT_NEAR(r.matches[0].pose.scale, 1.04, 0.002);
}

TEST(RstEngine, NegativeContrastIsFoundOnlyWhenAskedFor) {
  const Scene scene(120, 110, 4);
  image::Image picture = scene.with({160, 120, 40, 1});
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) picture.at(x, y) = static_cast<std::uint8_t>(255 - picture.at(x, y));
  RstEngine plain(RstVariant::rst);
  EXPECT_TRUE(find(plain, picture, scene.model).matches.empty());
  RstSettings settings;
  settings.match_negative = true;
  RstEngine negative(RstVariant::rst, settings);
  const FindResult r = find(negative, picture, scene.model);
  ASSERT_EQ(r.matches.size(), 1u);
  EXPECT_LT(distance_px(r.matches[0].pose, {160, 120, 40, 1}), 2);
}

TEST(RstEngine, OptionsOfTheSpecificationStillFindThePart) {
  const Scene scene(120, 110, 4);
  const Pose2d pose{150.4, 118.7, 73, 1};
  const image::Image picture = scene.with(pose);
  for (const Settings& set :
       {Settings{{"radial_length", "matched"}}, Settings{{"step3_tolerance", "1"}}, Settings{{"suppress", "3"}},
        Settings{{"t_contrast", "0.1"}, {"t_brightness", "0.9"}}, Settings{{"mask", "disc"}},
        Settings{{"location", "symmetric"}}, Settings{{"alpha", "5"}}, Settings{{"NP", "1"}}, Settings{{"NC", "16"}}}) {
    auto parsed = parse_rst_settings(set, "rst");
    ASSERT_TRUE(parsed);
    RstEngine engine(RstVariant::rst, *parsed);
    const FindResult r = find(engine, picture, scene.model);
    ASSERT_EQ(r.matches.size(), 1u) << set.begin()->first;
    EXPECT_LT(distance_px(r.matches[0].pose, pose), 2.5) << set.begin()->first;
    EXPECT_LT(turn_deg(r.matches[0].pose, pose), 2.5) << set.begin()->first;
  }
}

TEST(RstEngine, AngleRangeIsKept) {
  const Scene scene(120, 110, 4);
  const image::Image picture = scene.with({160, 120, 40, 1});
  RstEngine rst(RstVariant::rst);
  SearchOptions options;
  options.angle_deg = Range{30, 50};
  ASSERT_EQ(find(rst, picture, scene.model, options).matches.size(), 1u);
  options.angle_deg = Range{60, 200};
  EXPECT_TRUE(find(rst, picture, scene.model, options).matches.empty());
}

TEST(RstEngine, ThreadsGiveTheSameResult) {
  const Scene scene(120, 110, 4);
  const image::Image picture = scene.with({150.4, 118.7, 73, 1.1});
  RstEngine one(RstVariant::erst), many(RstVariant::erst);
  SearchOptions options;
  const FindResult a = find(one, picture, scene.model, options);
  options.threads = 3;
  const FindResult b = find(many, picture, scene.model, options);
  ASSERT_EQ(a.matches.size(), b.matches.size());
  EXPECT_EQ(a.matches[0].pose.x_px, b.matches[0].pose.x_px);
  EXPECT_EQ(a.matches[0].score, b.matches[0].score);
}

TEST(RstEngine, AMissNamesItsStage) {
  const Scene scene(120, 110, 4);
  const Pose2d pose{160, 120, 45, 0.95};
  const image::Image picture = scene.with(pose);
  SearchOptions options;
  options.explain = true;
  options.watch = pose;
  const auto lost_at = [&](const char* key, const char* value) {
    RstEngine engine(RstVariant::rst, *parse_rst_settings({{key, value}}, "rst"));
    const FindResult r = find(engine, picture, scene.model, options);
    EXPECT_TRUE(r.matches.empty());
    return r.rejected.empty() ? std::string() : std::string(name(r.rejected.front().stage));
  };
  EXPECT_EQ(lost_at("t1", "1"), "circular");
  EXPECT_EQ(lost_at("t2", "1"), "radial");
  EXPECT_EQ(lost_at("t3", "1"), "template");
  EXPECT_EQ(lost_at("t4", "1"), "robust");
}

TEST(RstEngine, RefusesWhatItCannotSearch) {
  const Scene small(24, 24, 1);
  RstEngine rst(RstVariant::rst, *parse_rst_settings({{"NP", "3"}}, "rst"));
  image::Pyramid pyramid;
  pyramid.build(small.with({60, 60, 0, 1}).view());
  const Model* one[] = {&small.model};
  const auto found = rst.find(pyramid, one, {});
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().line().find("set NP lower"), std::string::npos) << found.error().line();
  const Scene large(200, 200, 1);
  const image::Image tiny = testing::draw_ground(150, 150, 3);
  pyramid.build(tiny.view());
  const Model* big[] = {&large.model};
  EXPECT_FALSE(RstEngine(RstVariant::rst).find(pyramid, big, {}));
}

TEST(RstSettings, ReadsEveryKeyAndNamesWhatItDoesNotKnow) {
  const auto s =
      parse_rst_settings({{"t1", "0.9"}, {"scales", "1.1,0.9,1"}, {"NP", "2"}, {"refine", "subpixel"}}, "rst");
  ASSERT_TRUE(s);
  EXPECT_EQ(s->t1, 0.9);
  EXPECT_EQ(*s->scales, (std::vector<double>{0.9, 1, 1.1}));
  EXPECT_EQ(*s->pyramid_level, 2);
  EXPECT_TRUE(s->refine_subpixel);
  for (const Settings& bad :
       {Settings{{"t1", "high"}}, Settings{{"alpha", "7"}}, Settings{{"scales", "1,,2"}}, Settings{{"scales", "1,1"}},
        Settings{{"NP", "1.5"}}, Settings{{"mask", "square"}}, Settings{{"scales", ""}}, Settings{{"NC", "2"}}})
    EXPECT_FALSE(parse_rst_settings(bad, "rst")) << bad.begin()->first << "=" << bad.begin()->second;
  const auto unknown = parse_rst_settings({{"t_1", "0.9"}}, "erst");
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().line().find("engine erst"), std::string::npos);
}

TEST(RstSettings, PaperDefaults) {
  const RstSettings s;
  EXPECT_EQ(s.circles, 10);
  EXPECT_EQ(s.angle_step_deg, 10);
  EXPECT_EQ(s.t1, 0.84);
  EXPECT_EQ(s.t2, 0.7);
  EXPECT_EQ(s.t3, 0.7);
  EXPECT_FALSE(s.refine_subpixel);
  EXPECT_EQ(pyramid_level_for(60, 60), 1);
  EXPECT_EQ(pyramid_level_for(130, 130), 2);
  EXPECT_EQ(pyramid_level_for(250, 250), 3);
}

TEST(RstSettings, ScalesFollowTheRange) {
  EXPECT_EQ(scales_for({1, 1}, {}), (std::vector<double>{1}));
  EXPECT_EQ(scales_for({0.9, 1.1}, {}), (std::vector<double>{0.9, 1, 1.1}));
  const auto s = scales_for({0.8, 1.25}, {});  // ln(1.5625) / ln 1.12 = 3.94
  ASSERT_EQ(s.size(), 5u);
  EXPECT_NEAR(s[1] / s[0], s[4] / s[3], 1e-12);
  EXPECT_EQ(s.front(), 0.8);
  EXPECT_NEAR(s.back(), 1.25, 1e-12);
}

}  // namespace
}  // namespace pickcell::matches
