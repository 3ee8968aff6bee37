#include "pickcell/matches/rst/kernels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "pickcell/matches/fit/kernels_test.hpp"

#include "pickcell/matches/rst/radial_kernels.hpp"
#include "pickcell/matches/rst/smooth.hpp"

namespace pickcell::matches {
namespace {

image::Image noise(int w, int h, unsigned seed) {
  std::mt19937 rng(seed);
  image::Image out(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) out.at(x, y) = static_cast<std::uint8_t>(rng() & 255);
  return out;
}

TEST(RstKernels, FeaturesAndRingScoresEqualThePlainFormOnEveryTarget) {
  image::Image picture = noise(150, 130, 3);
  for (int y = 0; y < picture.height(); ++y)  // bright: a circle of more than 256 pixels does not fit 16 bits
    for (int x = 0; x < picture.width(); ++x) picture.at(x, y) |= 192;
  for (const int r : {3, 17, 60}) {
    const OffsetLists lists = offsets_for(circle_lists(circle_radii(r, 10)), picture.stride());
    const int n = picture.width() - 2 * r;
    const std::ptrdiff_t stride = 160;
    RingQuery query;
    std::mt19937 rng(static_cast<unsigned>(r));
    std::normal_distribution<float> value;
    for (std::size_t size = lists.inverse_length.size() - 1; size <= lists.inverse_length.size(); ++size) {
      query.q.emplace_back(size);
      for (float& v : query.q.back()) v = value(rng);
    }
    const std::size_t room = static_cast<std::size_t>(stride) * lists.inverse_length.size();
    for (const bool negative : {false, true}) {
      query.negative = negative;
      std::vector<float> plain_means(room), plain_best(160);
      std::vector<std::int32_t> plain_scale(160);
      plain::mean_lists(picture.row(65) + r, lists, n, plain_means.data(), stride);
      plain::score_rings(plain_means.data(), stride, n, query, plain_best.data(), plain_scale.data());
      testing::on_every_target([&] {
        std::vector<float> means(room), best(160);
        std::vector<std::int32_t> scale(160);
        mean_lists(picture.row(65) + r, lists, n, means.data(), stride);
        score_rings(means.data(), stride, n, query, best.data(), scale.data());
        for (int i = 0; i < n; ++i) {
          const auto at = static_cast<std::size_t>(i);
          for (std::size_t k = 0; k < lists.inverse_length.size(); ++k)
            ASSERT_EQ(means[k * 160 + at], plain_means[k * 160 + at]) << i;
          ASSERT_EQ(best[at], plain_best[at]) << i;
          ASSERT_EQ(scale[at], plain_scale[at]) << i;
        }
      });
    }
  }
}

TEST(RstKernels, DotProductsEqualThePlainFormOnEveryTarget) {
  std::mt19937 rng(4);
  std::uniform_int_distribution<int> value(-2040, 2040);
  std::vector<std::int16_t> a(384), b(1200);
  for (auto& v : a) v = static_cast<std::int16_t>(value(rng));
  for (auto& v : b) v = static_cast<std::int16_t>(value(rng));
  std::vector<int> starts;
  for (int i = 0; i < 361; i += 7) starts.push_back(i);
  std::vector<std::int32_t> expected(starts.size());
  plain::dots(a.data(), b.data(), 384, starts, expected.data());
  testing::on_every_target([&] {
    std::vector<std::int32_t> out(starts.size());
    dots(a.data(), b.data(), 384, starts, out.data());
    EXPECT_EQ(out, expected);
  });
  for (const int count : {1, 2, 3, 15, 16, 17, 18, 180}) {
    std::vector<std::int32_t> every_second(static_cast<std::size_t>(count));
    plain::stepped_dots(a.data(), b.data() + 1, count, count, every_second.data());
    testing::on_every_target([&] {
      std::vector<std::int32_t> out(static_cast<std::size_t>(count + kStepBlock));
      stepped_dots(a.data(), b.data() + 1, count, count, out.data());
      out.resize(static_cast<std::size_t>(count));
      EXPECT_EQ(out, every_second) << count;
    });
  }
}

/// Inside the picture and over every border, sums and score.
TEST(RstKernels, WindowSumsEqualThePlainFormOnEveryTarget) {
  const image::Image part = noise(37, 23, 5), picture = noise(120, 80, 6);
  for (const WindowMask mask : {WindowMask::rect, WindowMask::disc})
    for (const int angle : {0, 33, 90, 200}) {
      const Window window = make_window({part.view(), {}, 18, 11, mask}, angle, 1.1);
      for (const auto& [x, y] :
           {std::pair{60, 40}, {3, 40}, {117, 40}, {60, 2}, {60, 79}, {0, 0}, {119, 79}, {-200, 0}}) {
        const WindowSums expected = plain::sum_window(picture.view(), window, x, y);
        testing::on_every_target(
            [&] { EXPECT_EQ(sum_window(picture.view(), window, x, y), expected) << x << " " << y; });
      }
    }
}

/// [1 3 3 1] / 8 in both directions by its definition; pixel x stands at 2x + 1/2, so that a ramp stays where it is.
TEST(RstSmooth, BinomialHalvingEqualsThePlainFormAndKeepsARampInPlace) {
  for (const auto& [w, h] : {std::pair{331, 6}, {150, 41}, {53, 40}, {16, 9}, {6, 5}, {2, 2}}) {
    const image::Image picture = noise(w, h, 12);
    image::Image expected(w / 2, h / 2);
    constexpr int kTaps[] = {1, 3, 3, 1};
    for (int y = 0; y < h / 2; ++y)
      for (int x = 0; x < w / 2; ++x) {
        int sum = 32;
        for (int j = 0; j < 4; ++j)
          for (int i = 0; i < 4; ++i)
            sum += kTaps[i] * kTaps[j] *
                   picture.at(std::clamp(2 * x - 1 + i, 0, w - 1), std::clamp(2 * y - 1 + j, 0, h - 1));
        expected.at(x, y) = static_cast<std::uint8_t>(sum / 64);
      }
    testing::on_every_target([&, w = w, h = h] {
      image::Image out;
      halve_binomially(picture.view(), out);
      ASSERT_EQ(out.width(), w / 2);
      ASSERT_EQ(out.height(), h / 2);
      for (int y = 0; y < h / 2; ++y)
        for (int x = 0; x < w / 2; ++x) ASSERT_EQ(out.at(x, y), expected.at(x, y)) << w << ": " << x << " " << y;
    });
  }
  image::Image ramp(64, 8), half;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 64; ++x) ramp.at(x, y) = static_cast<std::uint8_t>(2 * x);
  halve_binomially(ramp.view(), half);
  for (int x = 1; x < 31; ++x) EXPECT_EQ(half.at(x, 2), 2 * (2 * x) + 1);
}

/// [1 2 1] / 4 in both directions by its definition.
TEST(RstSmooth, EqualsThePlainFormOnEveryTarget) {
  for (const auto& [w, h] : {std::pair{167, 5}, {31, 20}, {3, 2}, {1, 1}}) {
    const image::Image picture = noise(w, h, 13);
    testing::on_every_target([&, w = w, h = h] {
      image::Image out;
      smooth(picture.view(), out);
      constexpr int kTaps[] = {1, 2, 1};
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
          int sum = 8;
          for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i)
              sum += kTaps[i] * kTaps[j] * picture.at(std::clamp(x - 1 + i, 0, w - 1), std::clamp(y - 1 + j, 0, h - 1));
          ASSERT_EQ(out.at(x, y), sum / 16) << w << ": " << x << " " << y;
        }
    });
  }
}

TEST(RstWindow, QuarterTurnsCopyThePixels) {
  const image::Image part = noise(21, 21, 8);
  const Window w = make_window({part.view(), {}, 10, 10, WindowMask::rect}, 90, 1);
  ASSERT_EQ(w.pixels, 21 * 21);
  for (const Window::Run& run : w.runs)
    for (int k = 0; k < run.length; ++k) {
      const int dx = run.dx + k, dy = run.dy;  // counter-clockwise on the screen: (x, y) of the part goes to (y, -x)
      EXPECT_EQ(w.values[run.first + static_cast<std::size_t>(k)], part.at(10 - dy, 10 + dx));
    }
}

TEST(RstWindow, AgreesWithTheFormulaOfCorrelation) {
  const image::Image part = noise(31, 31, 9), picture = noise(100, 100, 10);
  const Window w = make_window({part.view(), {}, 15, 15, WindowMask::rect}, 0, 1);
  double n = 0, mi = 0, mt = 0, xy = 0, xx = 0, yy = 0;
  for (int y = 0; y < 31; ++y)
    for (int x = 0; x < 31; ++x) n += 1, mi += picture.at(35 + x, 25 + y), mt += part.at(x, y);
  mi /= n, mt /= n;
  for (int y = 0; y < 31; ++y)
    for (int x = 0; x < 31; ++x) {
      const double a = picture.at(35 + x, 25 + y) - mi, b = part.at(x, y) - mt;
      xy += a * b, xx += a * a, yy += b * b;
    }
  EXPECT_NEAR(score_window(picture.view(), w, 50, 40).ncc, xy / std::sqrt(xx * yy), 1e-12);
  EXPECT_EQ(score_window(picture.view(), w, 50, 40).inside, 1);
  EXPECT_NEAR(score_window(picture.view(), w, 0, 40).inside, 16.0 / 31, 1e-12);
}

}  // namespace
}  // namespace pickcell::matches
