#include "pickcell/matches/fit/final_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "pickcell/matches/best/engine.hpp"
#include "pickcell/matches/test_scenes.hpp"

namespace pickcell::matches {
namespace {

constexpr int kSide = 100;

/// A textured part with a bay, alone on a flat ground, taught with a mask that ends at its outline.
Model taught_on(const testing::Texture& texture, std::uint8_t ground) {
  Model m = testing::texture_model(texture, kSide, kSide);
  m.mask.resize(kSide, kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const bool on = std::hypot(x - 49.5, 1.3 * (y - 49.5)) < 40 && std::hypot(x - 85, y - 40) > 14;
      m.mask.at(x, y) = on ? 255 : 0;
    }
  m.picture.fill(ground);
  testing::draw_part(m.picture, texture, m, {m.ref_x_px, m.ref_y_px, 0, 1});
  return m;
}

/// Exact, and as certain as it says, though the ground changed from dark to bright.
TEST(FinalFit, AMaskedPartIsPlacedWhateverItLiesOn) {
  const testing::Texture texture(kSide, kSide, 5);
  const Model model = taught_on(texture, 25);
  const Model* const one[] = {&model};
  BestEngine engine;
  Eigen::Vector4d bias = Eigen::Vector4d::Zero();
  double nees = 0;
  constexpr int kPoses = 30;
  for (int i = 0; i < kPoses; ++i) {
    const Pose2d truth{100.3 + 0.37 * i, 96.1 + 0.23 * i, 12.3 * i - 180, 0.93 + 0.005 * i};
    image::Image picture(220, 200);
    picture.fill(230);
    testing::draw_part(picture, texture, model, truth);
    testing::add_noise(picture, 4, static_cast<unsigned>(i));
    image::Pyramid pyramid;
    pyramid.build(picture.view());
    const auto found = engine.find(pyramid, one, {});
    ASSERT_TRUE(found && found->matches.size() == 1) << i;
    const Match& m = found->matches.front();
    const Eigen::Vector4d off(m.pose.x_px - truth.x_px, m.pose.y_px - truth.y_px,
                              std::remainder(m.pose.angle_deg - truth.angle_deg, 360.0), m.pose.scale - truth.scale);
    bias += off / kPoses;
    nees += off.dot(m.covariance.inverse() * off) / 4 / kPoses;
  }
  EXPECT_LT(std::abs(bias[0]), 0.01);
  EXPECT_LT(std::abs(bias[1]), 0.01);
  EXPECT_LT(std::abs(bias[2]), 0.01);
  EXPECT_LT(std::abs(bias[3]), 0.0003);
  EXPECT_GT(nees, 0.5);
  EXPECT_LT(nees, 2);
}

/// A mask that is too large is noticed by the contours inside it.
TEST(FinalFit, GreyValuesKeepAwayFromTheOutlineNotFromTheMask) {
  const testing::Texture texture(kSide, kSide, 6);
  Model model = taught_on(texture, 25);
  const FinalPoints exact = choose_final_points(build_template_pyramid(model));
  const image::Image mask = model.mask;
  for (int y = 2; y + 2 < kSide; ++y)
    for (int x = 2; x + 2 < kSide; ++x)
      for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx)
          if (dx * dx + dy * dy <= 5 && mask.at(x + dx, y + dy) >= 128) model.mask.at(x, y) = 255;
  const FinalPoints large = choose_final_points(build_template_pyramid(model));
  EXPECT_GT(exact.inside.size(), 1000);
  EXPECT_NEAR(large.inside.size(), exact.inside.size(), 0.1 * exact.inside.size());
}

TEST(FinalFit, WithoutAMaskThereIsNoOutline) {
  const testing::Texture texture(kSide, kSide, 7);
  const FinalPoints none = choose_final_points(build_template_pyramid(testing::texture_model(texture, kSide, kSide)));
  EXPECT_EQ(none.inside.size(), 0);
  EXPECT_EQ(none.rim.points.count, 0);
  image::Image picture(200, 200);
  picture.fill(90);
  WeightedSamples samples;
  ContourScratch contours;
  EXPECT_FALSE(fit_finally(picture.view(), none, {100, 100, 0, 1}, samples, contours));
}

}  // namespace
}  // namespace pickcell::matches
