#include "pickcell/image/pyramid.hpp"

#include <gtest/gtest.h>

#include <random>

namespace pickcell::image {
namespace {

TEST(Pyramid, EveryPixelIsTheRoundedMeanOfFour) {
  std::mt19937 rng(5);
  for (const auto& [width, height] : {std::pair{2, 2}, {9, 7}, {33, 18}, {64, 40}, {131, 77}}) {
    Image picture(width, height);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) picture.at(x, y) = static_cast<std::uint8_t>(rng() % 4 == 0 ? 255 : rng() % 256);
    Pyramid pyramid;
    pyramid.build(picture.view());
    for (int l = 1; l < pyramid.levels(); ++l) {
      const ImageView fine = pyramid.level(l - 1), coarse = pyramid.level(l);
      ASSERT_EQ(coarse.width(), fine.width() / 2);
      ASSERT_EQ(coarse.height(), fine.height() / 2);
      for (int y = 0; y < coarse.height(); ++y)
        for (int x = 0; x < coarse.width(); ++x)
          ASSERT_EQ(coarse.at(x, y), (fine.at(2 * x, 2 * y) + fine.at(2 * x + 1, 2 * y) + fine.at(2 * x, 2 * y + 1) +
                                      fine.at(2 * x + 1, 2 * y + 1) + 2) /
                                         4);
    }
  }
}

TEST(Pyramid, StopsWhenAsked) {
  Image picture(300, 500);
  picture.fill(7);
  Pyramid pyramid;
  int asked = 0;
  ASSERT_TRUE(pyramid.build_unless([&] { return ++asked < 0; }, picture.view()));
  EXPECT_GT(asked, 500 / 64);
  const int all = asked;
  for (int last = 1; last <= all; ++last) {
    asked = 0;
    EXPECT_FALSE(pyramid.build_unless([&] { return ++asked == last; }, picture.view()));
    EXPECT_EQ(asked, last);
  }
}

}  // namespace
}  // namespace pickcell::image
