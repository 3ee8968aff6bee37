#include "pickcell/matches/learn/rings.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "pickcell/matches/learn/known_parts.hpp"
#include "pickcell/matches/learn/turned_rest.hpp"

namespace pickcell::matches {
namespace {

testing::Photo of(const testing::KnownPart& part, double off_x_px = 0, double off_y_px = 0) {
  testing::Shot shot;
  shot.radius_px = 30;
  shot.off_x_px = off_x_px;
  shot.off_y_px = off_y_px;
  return testing::photograph(part, shot);
}

/// Of four turns, which fall on samples: the mean of the four samples.
TEST(Rings, TheMeanOfTurnsIsTheirMean) {
  const testing::Photo photo = of(testing::l_part());
  const PartPicture part = make_part_picture(photo.picture.view(), {});
  const Rings rings(part, 32.3, 33.1, 31);
  std::vector<Rings::Sample> mean;
  rings.mean_of_turns(4, mean);
  const int quarter = rings.angles() / 4;
  for (int r = 0; r < rings.rings(); ++r)
    for (int a = 0; a < rings.angles(); a += 5) {
      Rings::Sample sum = 0;
      for (int k = 0; k < 4; ++k) sum += rings.ring(r)[(a + k * quarter) % rings.angles()];
      EXPECT_NEAR(std::abs(mean[rings.offset(r) + static_cast<std::size_t>(a)] - sum / 4.0f), 0, 1e-2);
    }
  rings.mean_of_turns(0, mean);
  for (int r = 0; r < rings.rings(); ++r)
    for (int a = 1; a < rings.angles(); ++a)
      EXPECT_EQ(mean[rings.offset(r) + static_cast<std::size_t>(a)], mean[rings.offset(r)]);
}

TEST(TurnedRest, AGearOffTheCentreSaysWhereItIs) {
  const testing::Photo photo = of(testing::gear_part(10), 0.4, -0.3);
  const PartPicture part = make_part_picture(photo.picture.view(), {});
  const double middle = (photo.picture.width() - 1) / 2.0;
  const TurnedRest rest = compare_turns(Rings(part, middle, middle, 33), part, 10);
  EXPECT_NEAR(rest.dx, 0.4, 0.05);
  EXPECT_NEAR(rest.dy, -0.3, 0.05);
  const TurnedRest there = compare_turns(Rings(part, middle + 0.4, middle - 0.3, 33), part, 10);
  EXPECT_LT(there.unlike, 0.002);
  EXPECT_EQ(there.mark_px, 0);
  EXPECT_GT(compare_turns(Rings(part, middle + 0.4, middle - 0.3, 33), part, 9).unlike, 0.05);
}

}  // namespace
}  // namespace pickcell::matches
