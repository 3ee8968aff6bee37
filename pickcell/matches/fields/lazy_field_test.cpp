#include "pickcell/matches/fields/lazy_field.hpp"

#include <gtest/gtest.h>

#include <random>
#include <thread>

namespace pickcell::matches {
namespace {

image::Image noise(int width, int height) {
  std::mt19937 rng(3);
  image::Image out(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) out.at(x, y) = static_cast<std::uint8_t>(rng() & 255U);
  return out;
}

/// Whatever is asked for, in whatever order and by however many, is what the whole field has there.
TEST(LazyField, EveryBoxEqualsTheWholeField) {
  for (const auto& [width, height] : {std::pair{200, 150}, {64, 32}, {65, 33}, {7, 5}}) {
    const image::Image picture = noise(width, height);
    OrientationField whole;
    orientation_field(picture.view(), whole);
    LazyField lazy;
    for (int round = 0; round < 2; ++round) {  // the second with the first one's memory
      lazy.start(picture.view());
      std::vector<std::jthread> threads;
      for (int t = 0; t < 3; ++t)
        threads.emplace_back([&, t, w = width, h = height] {
          std::mt19937 rng(static_cast<unsigned>(t));
          for (int i = 0; i < 20; ++i) {
            const int x0 = static_cast<int>(rng() % 300) - 50, y0 = static_cast<int>(rng() % 300) - 50;
            const int x1 = x0 + static_cast<int>(rng() % 60), y1 = y0 + static_cast<int>(rng() % 60);
            lazy.need(x0, y0, x1, y1);
            for (int y = std::max(0, y0); y <= std::min(h - 1, y1); ++y)
              for (int x = 2 * std::max(0, x0); x <= 2 * std::min(w - 1, x1) + 1; ++x)
                ASSERT_EQ(lazy.view().at(x, y), whole.at(x, y)) << x << ", " << y;
          }
        });
    }
  }
}

}  // namespace
}  // namespace pickcell::matches
