#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pickcell/matches/best/engine.hpp"
#include "pickcell/matches/test_scenes.hpp"

namespace pickcell::matches {
namespace {

using testing::Texture;

FindResult find_in(const image::Image& picture, const std::vector<const Model*>& models,
                   const SearchOptions& options = {}, const Settings& settings = {}) {
  image::Pyramid pyramid;
  pyramid.build(picture.view());
  auto engine = make_engine("best", settings);
  EXPECT_TRUE(engine);
  auto result = (*engine)->find(pyramid, models, options);
  EXPECT_TRUE(result) << (result ? "" : result.error().line());
  return result ? *result : FindResult{};
}

/// The template's picture turned by quarter turns counter-clockwise on the screen, pixel by pixel: no interpolation.
image::Image quarter_turned(const image::Image& p, int quarters) {
  image::Image out(quarters % 2 ? p.height() : p.width(), quarters % 2 ? p.width() : p.height());
  for (int y = 0; y < p.height(); ++y)
    for (int x = 0; x < p.width(); ++x) {
      if (quarters == 0) out.at(x, y) = p.at(x, y);
      if (quarters == 1) out.at(y, p.width() - 1 - x) = p.at(x, y);
      if (quarters == 2) out.at(p.width() - 1 - x, p.height() - 1 - y) = p.at(x, y);
      if (quarters == 3) out.at(p.height() - 1 - y, x) = p.at(x, y);
    }
  return out;
}

TEST(BestEngine, QuarterTurnsFollowTheConvention) {
  const Texture texture(90, 60, 1);
  Model model = testing::texture_model(texture, 90, 60);
  model.ref_x_px = 12;  // a corner of the part: its place tells the turns apart
  model.ref_y_px = 7;
  for (int quarters = 0; quarters < 4; ++quarters) {
    image::Image scene = testing::draw_ground(320, 240, 5);
    const image::Image turned = quarter_turned(model.picture, quarters);
    const int x0 = 131;
    const int y0 = 83;
    for (int y = 0; y < turned.height(); ++y)
      for (int x = 0; x < turned.width(); ++x) scene.at(x0 + x, y0 + y) = turned.at(x, y);
    const double expected[4][2] = {{12, 7}, {7, 89 - 12}, {89 - 12, 59 - 7}, {59 - 7, 12}};
    const FindResult r = find_in(scene, {&model});
    ASSERT_EQ(r.matches.size(), 1u) << quarters;
    const Pose2d& p = r.matches[0].pose;
    EXPECT_NEAR(p.x_px, x0 + expected[quarters][0], 0.01) << quarters;
    EXPECT_NEAR(p.y_px, y0 + expected[quarters][1], 0.01) << quarters;
    EXPECT_NEAR(std::remainder(p.angle_deg - 90.0 * quarters, 360.0), 0, 0.01) << quarters;
    EXPECT_NEAR(p.scale, 1, 2e-4) << quarters;
    EXPECT_GT(r.matches[0].score, 0.97);
  }
}

TEST(BestEngine, FindsRandomPosesExactly) {
  const Texture texture(70, 54, 2);
  Model model = testing::texture_model(texture, 70, 54);
  model.ref_x_px = 20;
  std::vector<double> off_px;
  std::vector<double> off_deg;
  for (unsigned i = 0; i < 12; ++i) {
    const Pose2d truth{100 + 9.37 * i, 90 + 4.71 * i, wrap_deg(10 + 29.3 * i), 0.91 + 0.015 * i};
    image::Image scene = testing::draw_ground(320, 240, 40 + i);
    testing::draw_part(scene, texture, model, truth);
    testing::add_noise(scene, 3, i);
    const FindResult r = find_in(scene, {&model});
    ASSERT_EQ(r.matches.size(), 1u) << i;
    EXPECT_LT(testing::distance_px(r.matches[0].pose, truth), 0.15) << i;
    EXPECT_LT(testing::turn_deg(r.matches[0].pose, truth), 0.15) << i;
    EXPECT_NEAR(r.matches[0].pose.scale, truth.scale, 0.003) << i;
  }
}

TEST(BestEngine, RefusesWhatItCannotDo) {
  const Texture texture(70, 54, 2);
  const Model model = testing::texture_model(texture, 70, 54);
  image::Pyramid tiny;
  const image::Image picture = testing::draw_ground(48, 40, 1);
  tiny.build(picture.view());
  auto engine = make_engine("best", {});
  ASSERT_TRUE(engine);
  const Model* models[] = {&model};
  const auto too_large = (*engine)->find(tiny, models, {});
  ASSERT_FALSE(too_large);
  EXPECT_EQ(too_large.error().code, core::ErrorCode::usage);
  EXPECT_NE(too_large.error().why.find("48 x 40"), std::string::npos);
  EXPECT_THROW((void)(*engine)->find(tiny, {}, {}), std::invalid_argument);

  SearchOptions reversed;
  reversed.angle_deg = Range{30, -30};
  EXPECT_FALSE((*engine)->find(tiny, models, reversed));
  SearchOptions not_a_number;
  not_a_number.scale = Range{std::nan(""), 1};
  EXPECT_FALSE((*engine)->find(tiny, models, not_a_number));

  EXPECT_FALSE(make_engine("bset", {}));
  const auto typo = make_engine("best", {{"efort", "quick"}});
  ASSERT_FALSE(typo);
  EXPECT_NE(typo.error().remedy.find("effort"), std::string::npos);
  EXPECT_FALSE(make_engine("best", {{"accept_ncc", "nan"}}));
  EXPECT_FALSE(make_engine("best", {{"quick.candidates", "1.5"}}));
  EXPECT_TRUE(make_engine("best", {{"quick.candidates", "20"}, {"effort", "quick"}}));
}

}  // namespace
}  // namespace pickcell::matches
