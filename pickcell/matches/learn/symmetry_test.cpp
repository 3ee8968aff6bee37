#include "pickcell/matches/learn/symmetry.hpp"

#include <gtest/gtest.h>

#include <iterator>
#include <vector>

#include "pickcell/image/codec.hpp"
#include "pickcell/matches/learn/known_parts.hpp"
#include "pickcell/matches/learn/self_match.hpp"

namespace pickcell::matches {
namespace {

using namespace testing;

Symmetry seen(const KnownPart& part, const Shot& shot) {
  const Photo photo = photograph(part, shot);
  return find_symmetry(photo.picture.view(), photo.mask.view());
}

constexpr MaskKind kMasks[] = {MaskKind::none, MaskKind::outline, MaskKind::generous};

TEST(Symmetry, TeethCornersAndSpokesAreCountedOffTheGridToo) {
  std::vector<KnownPart> parts = {annulus_part(0.35), annulus_part(0), rectangle_part(2), ellipse_part(1.5),
                                  s_part(),           l_part(),        spoked_part(7),    star_part(9)};
  for (const int corners : {3, 4, 5, 6, 8}) parts.push_back(polygon_part(corners));
  for (const int teeth : {5, 8, 12, 17, 24, 36, 48, 60}) parts.push_back(gear_part(teeth));
  unsigned seed = 0;
  for (const KnownPart& part : parts) {
    Shot shot;
    shot.seed = ++seed;
    shot.radius_px = 57.3;
    shot.off_x_px = 0.37;
    shot.off_y_px = -0.21;
    shot.turn_deg = 13.0 * seed;
    shot.noise_grey = 1.5;
    shot.mask = kMasks[seed % std::size(kMasks)];
    ASSERT_TRUE(resolvable(part, shot));
    EXPECT_EQ(seen(part, shot).order, part.order) << words(part, shot);
  }
}

/// A slot, a notch or a dot that only one place has makes the order 1; without it the part would be what it nearly is.
TEST(Symmetry, ASmallMarkBreaksItAndTheRestIsTold) {
  const std::vector<KnownPart> parts = {
      with_keyway(gear_part(8), 0.3, 0.12, 0.12),      with_keyway(gear_part(24), 0.3, 0.12, 0.12),
      with_dot(gear_part(12), 0.55, 0.05, 0.6),        with_notch(polygon_part(6), 0.12, 0.25),
      with_keyway(annulus_part(0.4), 0.4, 0.12, 0.12), with_dot(annulus_part(0), 0.5, 0.05, 0.6),
      with_dot(rectangle_part(2), 0.5, 0.05, 0.6)};
  unsigned seed = 0;
  for (const KnownPart& part : parts)
    for (const MaskKind mask : kMasks) {
      Shot shot;
      shot.seed = ++seed;
      shot.turn_deg = 29.0 * seed;
      shot.noise_grey = 2;
      shot.mask = mask;
      const Symmetry found = seen(part, shot);
      EXPECT_EQ(found.order, 1) << words(part, shot);
      EXPECT_EQ(found.nearly, part.order_but_for_mark) << words(part, shot);
    }
}

TEST(Symmetry, LightJpegAndNoiseDoNotBreakIt) {
  for (const KnownPart& part : {gear_part(16), annulus_part(0.4), polygon_part(6), s_part()})
    for (const MaskKind mask : kMasks) {
      Shot shot;
      shot.light = 0.25;
      shot.noise_grey = 3;
      shot.blur_px = 1;
      shot.turn_deg = 21;
      shot.mask = mask;
      const Photo photo = photograph(part, shot);
      const auto picture = image::decode_grey(image::encode_jpeg(photo.picture.view(), 85), "part");
      ASSERT_TRUE(picture);
      EXPECT_EQ(find_symmetry(picture->view(), photo.mask.view()).order, part.order) << words(part, shot);
    }
}

/// Teeth too fine for the picture are not guessed at.
TEST(Symmetry, WhatCannotBeResolvedIsADisc) {
  Shot shot;
  shot.radius_px = 18;
  shot.blur_px = 1.5;
  shot.noise_grey = 1;
  EXPECT_EQ(seen(gear_part(48, 0.08), shot).order, kAnyAngle);
}

TEST(Symmetry, NothingIsSaidOfNothing) {
  EXPECT_EQ(find_symmetry({}, {}).order, 1);
  image::Image flat(40, 30), speck(40, 30);
  flat.fill(100);
  speck.at(20, 15) = 255;
  image::Image thin(600, 9);
  for (int y = 3; y < 6; ++y)
    for (int x = 40; x < 560; ++x) thin.at(x, y) = 200;
  EXPECT_NO_THROW({ [[maybe_unused]] const auto s = find_symmetry(thin.view(), {}); });
  EXPECT_NO_THROW({ [[maybe_unused]] const auto s = find_symmetry(flat.view(), {}); });
  EXPECT_NO_THROW({ [[maybe_unused]] const auto s = find_symmetry(flat.view(), speck.view()); });
}

TEST(SelfMatch, AKeyedGearIsToldItsNearlySameTurns) {
  Shot shot;
  shot.turn_deg = 17;
  const Photo photo = photograph(with_keyway(gear_part(24), 0.3, 0.12, 0.12), shot);
  const SelfMatch found = self_match(photo.picture.view(), photo.mask.view());
  EXPECT_EQ(found.symmetry_order, 1);
  ASSERT_EQ(found.ambiguous_deg.size(), 23u);
  for (std::size_t i = 0; i < 23; ++i) EXPECT_NEAR(found.ambiguous_deg[i], 15.0 * static_cast<double>(i + 1), 0.01);
  EXPECT_GT(found.second_best, 0.9);
}

}  // namespace
}  // namespace pickcell::matches
