#include "pickcell/matches/overlay.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pickcell::matches {
namespace {

Model part(bool masked) {
  Model m;
  m.name = "part";
  m.picture.resize(41, 21);
  m.picture.fill(100);
  m.ref_x_px = 20;
  m.ref_y_px = 10;
  if (masked) {
    m.mask.resize(41, 21);
    for (int y = 5; y < 16; ++y)
      for (int x = 5; x < 36; ++x) m.mask.at(x, y) = 255;
  }
  return m;
}

bool coloured(const image::Rgb& p) { return std::abs(p[0] - p[1]) > 60 || std::abs(p[1] - p[2]) > 60; }

TEST(Overlay, TemplatePointsGoWhereTheConventionSays) {
  const Model model = part(false);
  const Pose2d pose{100, 80, 90, 2};
  const ScenePoint right = to_scene(model, pose, 30, 10);  // ten to the right: after a left turn twenty up
  EXPECT_NEAR(right.x_px, 100, 1e-9);
  EXPECT_NEAR(right.y_px, 60, 1e-9);
  const ScenePoint below = to_scene(model, pose, 20, 15);  // five below: ten to the right
  EXPECT_NEAR(below.x_px, 110, 1e-9);
  EXPECT_NEAR(below.y_px, 80, 1e-9);
}

TEST(Overlay, TheOutlineIsDrawnWhereThePartLies) {
  image::Image scene(240, 160);
  for (const bool masked : {false, true})
    for (const int grey : {0, 128, 255}) {
      scene.fill(static_cast<std::uint8_t>(grey));
      const Model model = part(masked);
      FindResult found;
      found.matches.push_back({"part", 0, {100, 80, 90, 2}, 0.93, {}, 1, {}});
      const Model* models[] = {&model};
      const image::RgbImage out = draw_overlay(scene.view(), found, models);
      ASSERT_EQ(out.width, 240);
      const int half = masked ? 10 : 20;  // the part's lower side lies to the right: half of 10.5 or 5.5, times 2
      bool edge = false;
      for (int x = 100 + half; x <= 100 + half + 3; ++x) edge = edge || coloured(out.at(x, 60));
      EXPECT_TRUE(edge) << masked << " on " << grey;
      EXPECT_TRUE(coloured(out.at(100, 70))) << "the axis points up";
      EXPECT_FALSE(coloured(out.at(10, 10)));
    }
}

TEST(Overlay, RejectedOnesAreDimmedAndFew) {
  image::Image scene(240, 160);
  scene.fill(90);
  const Model model = part(false);
  const Model* models[] = {&model};
  FindResult found;
  for (int i = 0; i < 50; ++i)
    found.rejected.push_back(
        {{"part", 0, {60.0 + 3 * i, 80, 10.0 * i, 1}, 0.3, {}, 1, {}}, RejectReason::score, Stage::fine});
  const image::RgbImage out = draw_overlay(scene.view(), found, models);
  EXPECT_TRUE(coloured(out.at(60, 70)) || coloured(out.at(60, 69)));
  EXPECT_FALSE(coloured(out.at(220, 80)));  // the fiftieth is not drawn
}

}  // namespace
}  // namespace pickcell::matches
