/// The kernels of refinement on every SIMD target against their formulas in double precision.

#include "pickcell/matches/fit/point_kernels.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "pickcell/matches/fields/orientation_field.hpp"
#include "pickcell/matches/fit/contour_kernel.hpp"
#include "pickcell/matches/fit/kernels_test.hpp"
#include "pickcell/matches/fit/score_kernels.hpp"

namespace pickcell::matches {
namespace {

using Column = std::vector<float>;

Column random_column(std::mt19937& rng, int count, double lo, double hi) {
  Column out(padded_to_blocks(static_cast<std::size_t>(count)), 0.f);
  std::uniform_real_distribution<double> value(lo, hi);
  for (int i = 0; i < count; ++i) out[static_cast<std::size_t>(i)] = static_cast<float>(value(rng));
  return out;
}

image::Image random_picture(std::mt19937& rng, int width, int height) {
  image::Image out(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) out.at(x, y) = static_cast<std::uint8_t>(rng() & 255U);
  return out;
}

/// Bilinear, the border repeated.
double bilinear(image::ImageView p, double x, double y) {
  x = std::clamp(x, 0.0, p.width() - 1.0);
  y = std::clamp(y, 0.0, p.height() - 1.0);
  const int ix = std::min(static_cast<int>(x), p.width() - 2), iy = std::min(static_cast<int>(y), p.height() - 2);
  const double fx = x - ix, fy = y - iy;
  return (1 - fy) * ((1 - fx) * p.at(ix, iy) + fx * p.at(ix + 1, iy)) +
         fy * ((1 - fx) * p.at(ix, iy + 1) + fx * p.at(ix + 1, iy + 1));
}

struct At {
  double x, y;
  [[nodiscard]] bool inside(int width, int height) const {
    return x >= 0 && y >= 0 && x <= width - 1 && y <= height - 1;
  }
};
At mapped(const LevelMap& m, double qx, double qy) {
  return {m.x + static_cast<double>(m.a) * qx + static_cast<double>(m.b) * qy,
          m.y - static_cast<double>(m.b) * qx + static_cast<double>(m.a) * qy};
}

/// Points of a part 60 px wide, somewhere in or partly outside a picture of 90 x 70.
class PointKernels : public ::testing::TestWithParam<int> {
 protected:
  std::mt19937 rng{static_cast<unsigned>(GetParam())};
  int count = GetParam();
  image::Image picture = random_picture(rng, 90, 70);
  Column qx = random_column(rng, count, -30, 30), qy = random_column(rng, count, -30, 30);
  Column t = random_column(rng, count, -100, 100);
  std::array<Column, 4> j{random_column(rng, count, -50, 50), random_column(rng, count, -50, 50),
                          random_column(rng, count, -50, 50), random_column(rng, count, -50, 50)};
  PointColumns points{qx.data(), qy.data(), t.data(), {j[0].data(), j[1].data(), j[2].data(), j[3].data()}, count};
  LevelMap inside{44.3f, 33.8f, 0.5f, 0.3f}, outside{12.25f, 60.5f, 0.8f, -0.6f};
};

TEST_P(PointKernels, SamplesAreBilinear) {
  Column s(qx.size()), weight(qx.size());
  for (const LevelMap& map : {inside, outside})
    testing::on_every_target([&] {
      std::fill(weight.begin(), weight.end(), 9.f);
      const int seen = sample_points(picture.view(), points, map, s.data(), weight.data());
      ASSERT_EQ(seen, std::count(weight.begin(), weight.begin() + count, 1.f));
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        const At at = mapped(map, qx[i], qy[i]);
        ASSERT_NEAR(s[i], bilinear(picture.view(), at.x, at.y), 0.02)
            << i;  // 255 per pixel times rounding of the place
        const At near{std::round(at.x * 1e4) / 1e4, std::round(at.y * 1e4) / 1e4};
        if (near.x > 0 && near.y > 0 && near.x < 89 && near.y < 69) {
          ASSERT_EQ(weight[i], 1.f) << i;
        } else if (near.x < 0 || near.y < 0 || near.x > 89 || near.y > 69) {
          ASSERT_EQ(weight[i], 0.f) << i;
        }
      }
    });
}

TEST_P(PointKernels, SumsAreThoseOfTheFormula) {
  PointSums expected;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const At at = mapped(inside, qx[i], qy[i]);
    const double s = bilinear(picture.view(), at.x, at.y) - 128;
    expected.s += s, expected.ss += s * s, expected.st += s * t[i];
    for (std::size_t k = 0; k < 4; ++k) expected.sj[k] += s * j[k][i];
  }
  testing::on_every_target([&] {
    const PointSums sums = sum_points(picture.view(), points, inside);
    EXPECT_NEAR(sums.s, expected.s, 0.01 * count);
    EXPECT_NEAR(sums.ss, expected.ss, 1.0 * count);
    EXPECT_NEAR(sums.st, expected.st, 1.0 * count);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(sums.sj[k], expected.sj[k], 0.5 * count);
  });
}

TEST_P(PointKernels, WeightedSumsAreThoseOfTheFormula) {
  const Column s = random_column(rng, count, 0, 255), weight = random_column(rng, count, 0, 1);
  std::array<double, 27> expected{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const double c[6] = {1, t[i], j[0][i], j[1][i], j[2][i], j[3][i]};
    std::size_t k = 0;
    for (std::size_t a = 0; a < 6; ++a) {
      for (std::size_t b = a; b < 6; ++b) expected[k++] += weight[i] * c[a] * c[b];
      expected[21 + a] += weight[i] * c[a] * (s[i] - 128.0);
    }
  }
  testing::on_every_target([&] {
    std::array<float, 27> sums{};
    sum_weighted(points, s.data(), weight.data(), sums.data());
    for (std::size_t k = 0; k < 27; ++k) ASSERT_NEAR(sums[k], expected[k], 0.01 * count) << k;
  });
}

TEST_P(PointKernels, PointsThatAgreeAreKept) {
  const Column s = random_column(rng, count, 0, 255), seen = random_column(rng, count, -0.3, 1);
  testing::on_every_target([&] {
    Column weight = seen;
    const Agreement agreement = keep_agreeing(points, s.data(), 100, 0.9f, 60, weight.data());
    int kept = 0;
    double square = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const double r = s[i] - 100.0 - 0.9 * t[i];
      const bool agrees = seen[i] > 0 && std::abs(r) <= 60;
      ASSERT_EQ(weight[i], agrees ? 1.f : 0.f) << i;
      kept += agrees;
      square += agrees ? r * r : 0;
    }
    EXPECT_EQ(agreement.points, kept);
    EXPECT_NEAR(agreement.square, square, 0.01 * count);
  });
}

/// Blocks of any size, empty ones too, that begin anywhere.
TEST_P(PointKernels, SumsOfBlocksAreThoseOfTheFormula) {
  struct Point {
    float x, y;
  };
  std::vector<Point> sorted;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) sorted.push_back({qx[i], qy[i]});
  const BlockGrid grid(-30, 30, -30, 45);  // nothing in the last row
  const BlockBegins begin = grid.sort(sorted);
  ASSERT_EQ(begin.back(), count);
  for (std::size_t i = 0; i < sorted.size(); ++i) qx[i] = sorted[i].x, qy[i] = sorted[i].y;
  const Column s = random_column(rng, count, 0, 255), weight = random_column(rng, count, 0, 1);
  const Column c2 = random_column(rng, count, -1, 1), s2 = random_column(rng, count, -1, 1);
  OrientationField field;
  orientation_field(picture.view(), field);
  for (const LevelMap& map : {inside, outside})
    testing::on_every_target([&] {
      std::array<BlockMoments, kBlocks> moments;
      std::array<BlockEdges, kBlocks> edges;
      sum_block_moments(points, s.data(), weight.data(), begin, moments);
      sum_block_edges(field.view(), {qx.data(), qy.data(), c2.data(), s2.data(), count}, map, begin, edges);
      const double turn = 2 * std::atan2(map.b, map.a);
      for (std::size_t b = 0; b < kBlocks; ++b) {
        double m[6] = {}, e[3] = {};
        for (auto i = static_cast<std::size_t>(begin[b]); i < static_cast<std::size_t>(begin[b + 1]); ++i) {
          ASSERT_EQ(grid.at(qx[i], qy[i]), b);
          const double v = s[i] - 128.0, w = weight[i];
          const double terms[6] = {w, w * v, w * v * v, w * t[i], w * t[i] * t[i], w * v * t[i]};
          for (std::size_t k = 0; k < 6; ++k) m[k] += terms[k];
          const double c = c2[i] * std::cos(turn) + s2[i] * std::sin(turn);
          const double n = s2[i] * std::cos(turn) - c2[i] * std::sin(turn);
          e[2] += c * c + n * n;
          const auto x = std::lrintf(map.x + map.a * qx[i] + map.b * qy[i]);
          const auto y = std::lrintf(map.y - map.b * qx[i] + map.a * qy[i]);
          if (x < 0 || y < 0 || x >= 90 || y >= 70) continue;
          const double fc = field.at(static_cast<int>(2 * x), static_cast<int>(y)) / 127.0;
          const double fs = field.at(static_cast<int>(2 * x + 1), static_cast<int>(y)) / 127.0;
          e[0] += fc * c + fs * n;
          e[1] += fc * fc + fs * fs;
        }
        const BlockMoments& own = moments[b];
        const float sums[6] = {own.n, own.s, own.ss, own.t, own.tt, own.st};
        for (std::size_t k = 0; k < 6; ++k) ASSERT_NEAR(sums[k], m[k], 0.01 * count) << b << " " << k;
        ASSERT_NEAR(edges[b].both, e[0], 1e-3 * count) << b;
        ASSERT_NEAR(edges[b].scene, e[1], 1e-3 * count) << b;
        ASSERT_NEAR(edges[b].own, e[2], 1e-3 * count) << b;
      }
    });
}

TEST_P(PointKernels, EdgesAgreeAsTheFormulaSays) {
  OrientationField field;
  orientation_field(picture.view(), field);
  const Column c2 = random_column(rng, count, -1, 1), s2 = random_column(rng, count, -1, 1);
  const auto component = [&](const At& at, int part) {
    const int ix = std::min(static_cast<int>(at.x), 88), iy = std::min(static_cast<int>(at.y), 68);
    const double fx = at.x - ix, fy = at.y - iy;
    const auto v = [&](int x, int y) { return static_cast<double>(field.at(2 * x + part, y)); };
    return (1 - fy) * ((1 - fx) * v(ix, iy) + fx * v(ix + 1, iy)) +
           fy * ((1 - fx) * v(ix, iy + 1) + fx * v(ix + 1, iy + 1));
  };
  for (const LevelMap& map : {inside, outside}) {
    double expected = 0;
    const double angle = 2 * std::atan2(map.b, map.a);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const At at = mapped(map, qx[i], qy[i]);
      if (!at.inside(90, 70)) continue;
      const double turned_c = c2[i] * std::cos(angle) + s2[i] * std::sin(angle);
      const double turned_s = s2[i] * std::cos(angle) - c2[i] * std::sin(angle);
      expected += component(at, 0) * turned_c + component(at, 1) * turned_s;
    }
    testing::on_every_target([&] {
      const float sum = sum_edges(field.view(), {qx.data(), qy.data(), c2.data(), s2.data(), count}, map);
      EXPECT_NEAR(sum, expected, 0.02 * count);
    });
  }
}

INSTANTIATE_TEST_SUITE_P(Counts, PointKernels, ::testing::Values(1, 15, 16, 17, 200));

/// A straight edge with a known place: every point finds it, at the distance that geometry says.
TEST(ContourKernel, FindsAnEdgeWhereItIs) {
  constexpr double kAngle = 0.4, kOffset = 45;
  image::Image picture(100, 100);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) {
      const double far = x * std::cos(kAngle) + y * std::sin(kAngle) - kOffset;
      picture.at(x, y) = static_cast<std::uint8_t>(std::lround(128 + 100 * std::tanh(far / 1.2)));
    }
  std::mt19937 rng(5);
  const int count = 37;
  Column x = random_column(rng, count, -15, 15), y = random_column(rng, count, -1.5, 1.5), nx(x.size()), ny(x.size());
  std::fill(ny.begin(), ny.end(), 1.f);                // the part's normal is its y axis ...
  const double turn = -kAngle + std::numbers::pi / 2;  // ... which this turn carries onto the edge's normal
  const double cx = kOffset * std::cos(kAngle) - 25 * std::sin(kAngle) + 3;  // near it, and far from the border
  const double cy = kOffset * std::sin(kAngle) + 25 * std::cos(kAngle) - 1;
  const LevelMap map{static_cast<float>(cx), static_cast<float>(cy), static_cast<float>(std::cos(turn)),
                     static_cast<float>(std::sin(turn))};
  for (const EdgeReading reading : {EdgeReading::plain, EdgeReading::smooth, EdgeReading::exact})
    testing::on_every_target([&] {
      Column distance(x.size());
      find_edges(picture.view(), {x.data(), y.data(), nx.data(), ny.data(), count}, map, 6, reading, distance.data());
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        const At at = mapped(map, x[i], y[i]);
        const double normal_x = map.b, normal_y = map.a;
        const double to_edge = (kOffset - at.x * std::cos(kAngle) - at.y * std::sin(kAngle)) /
                               (normal_x * std::cos(kAngle) + normal_y * std::sin(kAngle));
        ASSERT_NEAR(distance[i], to_edge, reading == EdgeReading::exact ? 0.03 : 0.1) << i;
      }
    });
}

TEST(ContourKernel, LinesAndTheirSumsAreThoseOfTheFormula) {
  std::mt19937 rng(6);
  const int count = 45;
  const auto column = [&](double lo, double hi) { return random_column(rng, count, lo, hi); };
  const Column x = column(-30, 30), y = column(-30, 30);
  Column nx(x.size()), ny(x.size()), seen = column(-2, 2);
  for (std::size_t i = 0; i < x.size(); ++i)
    nx[i] = std::cos(static_cast<float>(i)), ny[i] = std::sin(static_cast<float>(i));
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); i += 7) seen[i] = kNoEdge;
  const LevelMap map{10, 20, 0.9f, 0.5f};
  const double size = std::hypot(map.a, map.b);
  const Column weight = column(0, 1);
  testing::on_every_target([&] {
    Column row[4] = {Column(x.size()), Column(x.size()), Column(x.size()), Column(x.size())};
    Column distance = seen, found(x.size()), residual(x.size());
    const LineOutput out{row[0].data(), row[1].data(), row[2].data(), row[3].data(), distance.data(), found.data()};
    EXPECT_EQ(make_lines({x.data(), y.data(), nx.data(), ny.data(), count}, map, out), count - 7);
    const LineColumns lines{row[0].data(),   row[1].data(), row[2].data(), row[3].data(),
                            distance.data(), weight.data(), count};
    float sums[14];
    sum_lines(lines, sums);
    const float movement[4] = {0.3f, -0.2f, 0.01f, 0.02f};
    line_residuals(lines, movement, residual.data());
    double expected[14] = {};
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const At arm = mapped({0, 0, map.a, map.b}, x[i], y[i]), normal = mapped({0, 0, map.a, map.b}, nx[i], ny[i]);
      const double u = normal.x / size, v = normal.y / size;
      const double c[4] = {u, v, u * arm.y - v * arm.x, u * arm.x + v * arm.y};
      const double d = i % 7 == 0 ? 0 : seen[i];
      ASSERT_EQ(found[i], i % 7 == 0 ? 0.f : 1.f) << i;
      double left = d;
      std::size_t k = 0;
      for (std::size_t p = 0; p < 4; ++p) {
        ASSERT_NEAR(row[p][i], c[p], 1e-4) << p << ", " << i;
        left -= c[p] * static_cast<double>(movement[p]);
        expected[10 + p] += weight[i] * c[p] * d;
        for (std::size_t q = p; q < 4; ++q, ++k) expected[k] += weight[i] * c[p] * c[q];
      }
      ASSERT_NEAR(residual[i], std::abs(left), 1e-4) << i;
    }
    for (std::size_t k = 0; k < 14; ++k) EXPECT_NEAR(sums[k], expected[k], 2e-3 * count) << k;
  });
}

TEST(PointKernels, ResidualsAndTheirWeightsAreThoseOfTheFormula) {
  std::mt19937 rng(11);
  const int count = 45;
  const Column t = random_column(rng, count, -60, 60), scene = random_column(rng, count, 0, 255);
  Column inside(t.size());
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) inside[i] = i % 5 == 0 ? 0.f : 1.f;
  const PointColumns points{nullptr, nullptr, t.data(), {}, count};
  testing::on_every_target([&] {
    Column size(t.size()), weight = inside, lines(t.size());
    residual_sizes(points, scene.data(), 100, 0.8f, size.data());
    weigh_points(size.data(), 70, 1e-6f, count, weight.data());
    weigh_lines(size.data(), inside.data(), 70, count, lines.data());
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const double r = std::abs(scene[i] - 100 - static_cast<double>(0.8f) * t[i]);
      ASSERT_NEAR(size[i], r, 1e-3) << i;
      const double u = std::max(0.0, 1 - r * r / (70.0 * 70.0));
      ASSERT_NEAR(lines[i], inside[i] * u * u, 1e-4) << i;
      ASSERT_NEAR(weight[i], inside[i] * std::max(1e-6, u * u), 1e-4) << i;
      ASSERT_EQ(weight[i] > 0, inside[i] > 0) << i;  // an outlier still counts as inside
    }
  });
}

/// Rounded to bytes, so at most one unit from the formula, on every target.
TEST(OrientationKernel, IsTheSmoothedTensorOfTheFormula) {
  std::mt19937 rng(7);
  const image::Image picture = random_picture(rng, 83, 29);
  const auto grey = [&](int x, int y) -> double { return picture.at(std::clamp(x, 0, 82), std::clamp(y, 0, 28)); };
  const auto tensor = [&](int x, int y) {
    x = std::clamp(x, 0, 82), y = std::clamp(y, 0, 28);
    const double gx = (grey(x + 1, y) - grey(x - 1, y)) / 2, gy = (grey(x, y + 1) - grey(x, y - 1)) / 2;
    return std::array<double, 3>{gx * gx - gy * gy, 2 * gx * gy, gx * gx + gy * gy};
  };
  testing::on_every_target([&] {
    OrientationField field;
    orientation_field(picture.view(), field);
    for (int y = 0; y < 29; ++y)
      for (int x = 0; x < 83; ++x) {
        std::array<double, 3> sum{};
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx)
            for (std::size_t q = 0; q < 3; ++q)
              sum[q] += (2 - std::abs(dx)) * (2 - std::abs(dy)) * tensor(x + dx, y + dy)[q] / 16;
        const double k = 127 / (sum[2] + kEdgeGrey * kEdgeGrey);
        ASSERT_NEAR(field.at(2 * x, y), k * sum[0], 0.51) << x << ", " << y;
        ASSERT_NEAR(field.at(2 * x + 1, y), k * sum[1], 0.51) << x << ", " << y;
      }
  });
}

}  // namespace
}  // namespace pickcell::matches
