#include "pickcell/matches/rst/engine.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>
#include <tuple>

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

std::optional<Match> one_match(RstEngine& engine, const image::Image& picture, const Model& model) {
  const FindResult r = find(engine, picture, model);
  if (r.matches.size() != 1) return {};
  return r.matches[0];
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

/// A picture shifted by 0 .. 2^NP - 1 pixels finds the same pose, moved as much, whatever the remainder of the
/// template's size.
void shifts_move_the_find_as_much(RstVariant variant, int level, int smallest, double limit_px) {
  for (const int size : {smallest, smallest + (1 << level) - 1}) {
    const Scene scene(size, size, 9);
    const int block = 1 << level;
    RstSettings settings;
    settings.pyramid_level = level;
    RstEngine engine(variant, settings);
    SearchOptions options;
    options.angle_deg = Range{0, 0};  // one angle keeps the full search short; the place is what is tested
    options.scale = Range{1, 1};
    for (int shift = 0; shift < block; ++shift) {
      const double half = 0.5 * (1 - size % 2);  // the template's pixels fall on the picture's
      const Pose2d pose{150.0 + shift + half, 110.0 + 3 * shift % block + half, 0, 1};
      const FindResult r = find(engine, scene.with(pose), scene.model, options);
      ASSERT_EQ(r.matches.size(), 1u) << size << " " << shift;
      EXPECT_LE(distance_px(r.matches[0].pose, pose), limit_px) << size << " " << shift;
      EXPECT_EQ(r.matches[0].pose.angle_deg, 0);
    }
  }
}

TEST(RstEngine, PicturesShiftedBy0To1PixelsFindTheSamePoseAtNp1) {
  shifts_move_the_find_as_much(RstVariant::erst, 1, 60, 1e-6);
  shifts_move_the_find_as_much(RstVariant::rst, 1, 60, 1e-6);
}
TEST(RstEngine, PicturesShiftedBy0To3PixelsFindTheSamePoseAtNp2) {
  shifts_move_the_find_as_much(RstVariant::erst, 2, 100, 1e-6);
  shifts_move_the_find_as_much(RstVariant::rst, 2, 100, 1e-6);
}
TEST(RstEngine, PicturesShiftedBy0To7PixelsFindTheSamePoseAtNp3) {
  shifts_move_the_find_as_much(RstVariant::erst, 3, 160, 1e-6);
  shifts_move_the_find_as_much(RstVariant::rst, 3, 160, 1e-6);
}

/// NP = 1 and 3: 4^NP * 10 * 3 correlations of a candidate in erst, 1 + 3 NP + 7 + 3 in rst.
TEST(RstEngine, RobustFilterTakes14Of120And20Of1920CorrelationsAtNp1AndNp3) {
  const Scene scene(160, 160, 4);
  const image::Image picture = scene.with({160, 120, 40, 1});
  for (const auto& [level, fast, full] : {std::tuple{1, 14, 120}, {3, 20, 1920}}) {
    RstSettings settings;
    settings.pyramid_level = level;
    settings.suppress_px = 100;  // one candidate: 1920 correlations of it are enough
    RstEngine rst(RstVariant::rst, settings), erst(RstVariant::erst, settings);
    const FindResult a = find(rst, picture, scene.model), b = find(erst, picture, scene.model);
    ASSERT_EQ(stage(a, "robust").population, 1) << level;
    EXPECT_EQ(stage(a, "robust").ncc_count, fast);
    EXPECT_EQ(stage(b, "robust").ncc_count, full);
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

/// The covariance is the fit's: with noise it foretells how far the poses lie from the truth. Without refinement it is
/// that of the grids.
TEST(RstEngine, SubpixelRefinementReportsTheCovarianceOfItsFit) {
  const Scene scene(120, 110, 4);
  RstEngine refined(RstVariant::rst, *parse_rst_settings({{"refine", "subpixel"}}, "rst")), plain(RstVariant::rst);
  std::mt19937 rng(17);
  std::normal_distribution<double> noise(0, 8);
  double sum = 0;
  constexpr int kPictures = 12;
  for (int i = 0; i < kPictures; ++i) {
    const Pose2d pose{150 + 0.37 * i, 118 - 0.21 * i, 73.4 + 11 * i, 1.02};
    image::Image picture = scene.with(pose);
    for (int y = 0; y < picture.height(); ++y)
      for (int x = 0; x < picture.width(); ++x)
        picture.at(x, y) = static_cast<std::uint8_t>(std::clamp(picture.at(x, y) + noise(rng) + 0.5, 0.0, 255.0));
    const std::optional<Match> r = one_match(refined, picture, scene.model);
    ASSERT_TRUE(r) << i;
    const Eigen::Vector2d off(r->pose.x_px - pose.x_px, r->pose.y_px - pose.y_px);
    sum += off.dot(r->covariance.topLeftCorner<2, 2>().inverse() * off);
    EXPECT_LT(std::sqrt(r->covariance(0, 0)), 0.1);
    EXPECT_LT(std::sqrt(r->covariance(2, 2)), 0.1);
  }
  EXPECT_NEAR(one_match(plain, scene.with({160, 120, 40, 1}), scene.model)->covariance(0, 0), 1 / 12.0, 1e-9);
  EXPECT_GT(sum / kPictures, 0.5);  // 2 in the mean; 12 pictures leave it in 0.8 .. 3.9
  EXPECT_LT(sum / kPictures, 6);    // resampling of the template adds to the noise
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
  settings.refine_subpixel = true;  // fits no negatives: the find stays as it is
  RstEngine refining(RstVariant::rst, settings);
  const FindResult kept = find(refining, picture, scene.model);
  ASSERT_EQ(kept.matches.size(), 1u);
  EXPECT_EQ(kept.matches[0].score, r.matches[0].score);
  EXPECT_EQ(kept.matches[0].pose.x_px, r.matches[0].pose.x_px);
}

TEST(RstEngine, OptionsOfTheSpecificationStillFindThePart) {
  const Scene scene(120, 110, 4);
  const Pose2d pose{150.4, 118.7, 73, 1};
  const image::Image picture = scene.with(pose);
  for (const Settings& set :
       {Settings{{"radial_length", "matched"}}, Settings{{"step3_tolerance", "1"}}, Settings{{"suppress", "3"}},
        Settings{{"t_contrast", "0.1"}, {"t_brightness", "0.9"}}, Settings{{"mask", "disc"}},
        Settings{{"location", "symmetric"}}, Settings{{"location", "quadrant"}}, Settings{{"alpha", "5"}},
        Settings{{"NP", "1"}}, Settings{{"NC", "16"}}}) {
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

}  // namespace
}  // namespace pickcell::matches
