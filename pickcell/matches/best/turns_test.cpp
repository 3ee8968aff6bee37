#include "pickcell/matches/best/turns.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pickcell/matches/best/engine.hpp"
#include "pickcell/matches/best/settings.hpp"
#include "pickcell/matches/fit/edge_fit.hpp"
#include "pickcell/matches/learn/known_parts.hpp"
#include "pickcell/matches/teach.hpp"
#include "pickcell/matches/test_scenes.hpp"

namespace pickcell::matches {
namespace {

constexpr int kTeeth = 18;

/// A light gear about (0, 0) on dark ground, without teeth in one place and with a hole beside its middle.
double gear(double x, double y) {
  const double r = std::hypot(x, y), a = std::atan2(y, x);
  const bool gap = std::abs(a) < 0.3;
  const double rim = std::cos(kTeeth * a) > 0 && !gap ? 44 : 38;
  return r > rim || std::hypot(x + 18, y) < 16 ? 0 : 1;
}

/// The gear with its middle at (x, y), turned counter-clockwise; 4 x 4 samples a pixel, from `dark` to `light`.
image::Image draw(int width, int height, double x, double y, double angle_deg, double dark, double light) {
  image::Image out(width, height);
  const double c = std::cos(angle_deg / kDegPerRad), s = std::sin(angle_deg / kDegPerRad);
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      double sum = 0;
      for (int k = 0; k < 16; ++k) {
        const double u = i + (k % 4 - 1.5) / 4 - x, v = j + (k / 4 - 1.5) / 4 - y;
        sum += gear(c * u - s * v, s * u + c * v);
      }
      out.at(i, j) = static_cast<std::uint8_t>(dark + (light - dark) * sum / 16 + 0.5);
    }
  return out;
}

Model gear_model() {
  Model model;
  model.name = "gear";
  model.picture = draw(101, 101, 50, 50, 0, 60, 180);
  model.mask = draw(101, 101, 50, 50, 0, 0, 255);
  model.ref_x_px = model.ref_y_px = 50;
  model.scale = {0.9, 1.1};
  model.learnt.second_best_self_match = 0.9;  // at its teeth
  return model;
}

/// The anchor is the centroid, which gap and hole draw away from the middle of the teeth. A find at any other tooth
/// leads to the true turn and place.
TEST(Turns, AGearFoundAtAWrongToothIsTurnedToItsPlace) {
  const Model model = gear_model();
  const BestModel best = prepare_model(model, {0.9, 1.1}, BestSettings());
  ASSERT_GT(std::hypot(best.ref_dx, best.ref_dy), 1);

  const Pose2d truth{160.3, 118.6, 25, 1};
  const image::Image picture = draw(320, 240, truth.x_px, truth.y_px, truth.angle_deg, 60, 180);
  image::Pyramid pyramid;
  pyramid.build(picture.view());
  BestScene scene;
  scene.start(pyramid);
  RefineScratch scratch;
  WorkBudget budget({}, [] { return 0.0; });
  for (int tooth = 1; tooth < kTeeth; ++tooth) {
    Pose2d wrong = truth;
    wrong.angle_deg += 360.0 / kTeeth * tooth;
    const Hypothesis found =
        settle(scene.level(0), best.levels[0], similarity_of(wrong, best.ref_dx, best.ref_dy), best.scale, scratch);
    const auto turns =
        settled_turns(found, best, {-180, 180}, scene, scratch, budget, std::pmr::get_default_resource());
    ASSERT_FALSE(turns.empty());
    const Pose2d pose = pose_of(turns.front().place, best.ref_dx, best.ref_dy);
    EXPECT_LT(testing::turn_deg(pose, truth), 0.2) << tooth;
    EXPECT_LT(testing::distance_px(pose, truth), 0.2) << tooth;
  }
}

/// The right tooth is found at whatever range holds it, and none beyond the range is reported.
TEST(Turns, ANarrowRangeHoldsTheTurnWithinIt) {
  const Model model = gear_model();
  const Model* const one[] = {&model};
  const Pose2d truth{160.3, 118.6, 40.2, 1};
  image::Image picture = draw(320, 240, truth.x_px, truth.y_px, truth.angle_deg, 60, 180);
  testing::add_noise(picture, 2, 3);
  image::Pyramid pyramid;
  pyramid.build(picture.view());
  BestEngine engine;
  for (const double within_deg : {0.0, 4.0, 15.0, 45.0, 180.0}) {
    SearchOptions options;
    options.angle_deg = Range{truth.angle_deg - within_deg, truth.angle_deg + within_deg};
    const auto found = engine.find(pyramid, one, options);
    ASSERT_TRUE(found && found->matches.size() == 1) << within_deg;
    EXPECT_LT(testing::turn_deg(found->matches[0].pose, truth), 0.2) << within_deg;
  }
}

/// Each turn of a gear of many teeth fits as well as the one found; all within the range are named.
TEST(Turns, AGearOfManyTeethNamesItsTurns) {
  const testing::KnownPart gear = testing::gear_part(24);
  testing::Shot shot;
  shot.radius_px = 44;
  const testing::Photo taught = testing::photograph(gear, shot);
  TeachInput input;
  input.name = "gear";
  input.picture = taught.picture.view();
  const auto model = teach(input);
  ASSERT_TRUE(model);
  ASSERT_EQ(model->model.learnt.symmetry_order, 24);
  const Model* const one[] = {&model->model};
  shot.turn_deg = 4;
  shot.off_x_px = 60;  // a picture with room around it
  const testing::Photo scene = testing::photograph(gear, shot);
  image::Pyramid pyramid;
  pyramid.build(scene.picture.view());
  BestEngine engine;
  const auto found = engine.find(pyramid, one, {});
  ASSERT_TRUE(found && found->matches.size() == 1);
  EXPECT_EQ(found->matches[0].ambiguous_deg.size(), 23u);
  SearchOptions narrow;
  narrow.angle_deg = Range{-12, 10};  // at 4 and at -11 degrees
  const auto within = engine.find(pyramid, one, narrow);
  ASSERT_TRUE(within && within->matches.size() == 1);
  EXPECT_LE(std::abs(within->matches[0].pose.angle_deg), 12);
  EXPECT_EQ(within->matches[0].ambiguous_deg.size(), 1u);
}

/// What contours say of their own certainty, over 40 noisy poses: the mean normalised squared error of x, y and angle
/// is 1 where it is right.
TEST(ContourCovariance, ForetellsTheScatterOfThePlace) {
  const Model model = gear_model();
  const BestModel best = prepare_model(model, {0.9, 1.1}, BestSettings());
  const ContourPoints& contours = best.levels[0].contours;
  ContourScratch scratch;
  double sum = 0;
  for (int i = 0; i < 40; ++i) {
    const Pose2d truth{150.0 + 0.37 * i, 110.0 + 0.23 * i, 8.7 * i - 180, 1};
    image::Image picture = draw(320, 240, truth.x_px, truth.y_px, truth.angle_deg, 60, 180);
    testing::add_noise(picture, 4, static_cast<unsigned>(i));
    const Similarity at = similarity_of(truth, best.ref_dx, best.ref_dy);
    ContourSearch search;
    search.iterations = 6;
    const auto placed = fit_contours(picture.view(), 0, contours, at, search, scratch);
    ASSERT_TRUE(placed);
    const auto C = contour_covariance(picture.view(), contours, *placed, scratch);
    ASSERT_TRUE(C);
    const double off[3] = {placed->x_px - at.x_px, placed->y_px - at.y_px, wrap_rad(placed->angle_rad - at.angle_rad)};
    for (int k = 0; k < 3; ++k) sum += off[k] * off[k] / (*C)(k, k) / 3;
  }
  EXPECT_GT(sum / 40, 0.3);
  EXPECT_LT(sum / 40, 3);
}

TEST(ContourCovariance, IsNoneWhereNoEdgesAre) {
  const BestModel best = prepare_model(gear_model(), {0.9, 1.1}, BestSettings());
  image::Image flat(200, 200);
  flat.fill(100);
  ContourScratch scratch;
  EXPECT_FALSE(contour_covariance(flat.view(), best.levels[0].contours, {100, 100, 0, 1}, scratch));
}

}  // namespace
}  // namespace pickcell::matches
