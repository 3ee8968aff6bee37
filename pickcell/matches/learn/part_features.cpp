#include "pickcell/matches/learn/part_features.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "pickcell/image/pyramid.hpp"
#include "pickcell/matches/fit/edge_points.hpp"

namespace pickcell::matches {

namespace {

constexpr double kCoarseSidePx = 24;
constexpr double kContourSidePx = 48;

struct Moments {
  double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
  void add(double px, double py) {
    n += 1;
    x += px;
    y += py;
    xx += px * px;
    yy += py * py;
    xy += px * py;
  }
};

struct Eigen2 {
  double high = 0, low = 0;
};

/// Of the symmetric matrix [[a, b], [b, c]].
Eigen2 eigenvalues(double a, double b, double c) {
  const double middle = (a + c) / 2, spread = std::hypot((a - c) / 2, b);
  return {middle + spread, std::max(0.0, middle - spread)};
}

void measure_shape(image::ImageView mask, PartFeatures& out) {
  Moments m;
  for (int y = 0; y < mask.height(); ++y)
    for (int x = 0; x < mask.width(); ++x)
      if (mask.at(x, y) >= 128) m.add(x, y);
  out.part_pixels = m.n;
  if (m.n == 0) return;
  const double mx = m.x / m.n, my = m.y / m.n;
  const auto [high, low] = eigenvalues(m.xx / m.n - mx * mx, m.xy / m.n - mx * my, m.yy / m.n - my * my);
  out.long_side_px = std::sqrt(12 * high + 1);  // a row of n pixels has variance (n^2 - 1) / 12
  out.short_side_px = std::sqrt(12 * low + 1);
}

double standard_deviation(image::ImageView picture, image::ImageView mask) {
  double n = 0, sum = 0, squares = 0;
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) {
      if (mask.at(x, y) < 128) continue;
      const double v = picture.at(x, y);
      n += 1;
      sum += v;
      squares += v * v;
    }
  return n > 0 ? std::sqrt(std::max(0.0, squares / n - sum / n * (sum / n))) : 0;
}

/// Scharr's weights: gradients of slanted edges keep their direction.
double weighted(int before, int here, int after) { return (3 * before + 10 * here + 3 * after) / 32.0; }

double direction_ratio(image::ImageView picture, image::ImageView mask) {
  double xx = 0, xy = 0, yy = 0;
  for (int y = 1; y + 1 < picture.height(); ++y)
    for (int x = 1; x + 1 < picture.width(); ++x) {
      if (mask.at(x, y) < 128) continue;
      const auto column = [&](int dx) {
        return weighted(picture.at(x + dx, y - 1), picture.at(x + dx, y), picture.at(x + dx, y + 1));
      };
      const auto line = [&](int dy) {
        return weighted(picture.at(x - 1, y + dy), picture.at(x, y + dy), picture.at(x + 1, y + dy));
      };
      const double gx = column(1) - column(-1), gy = line(1) - line(-1);
      xx += gx * gx;
      xy += gx * gy;
      yy += gy * gy;
    }
  const auto [high, low] = eigenvalues(xx, xy, yy);
  return high > 0 ? low / high : 1;
}

/// At the level where the part is about kContourSidePx wide.
ContourPoints all_contours(const TemplatePyramid& t) {
  int level = 0;
  double side = std::sqrt(t.area_px);
  for (; side > kContourSidePx && level + 1 < static_cast<int>(t.levels.size()); side /= 2) ++level;
  return choose_contour_points(t, level, std::numeric_limits<int>::max());
}

}  // namespace

double direction_bits(const TemplatePyramid& t) {
  const ContourPoints contours = all_contours(t);
  std::array<double, 8> sector{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(contours.count); ++i) {
    const double turn = std::atan2(contours.ny[i], contours.nx[i]) / std::numbers::pi;  // half a turn is the same line
    sector[static_cast<std::size_t>(std::floor(8 * (turn - std::floor(turn)))) % 8] += 1;
  }
  double entropy = 0;
  for (const double n : sector)
    if (n > 0) entropy -= n / contours.count * std::log2(n / contours.count);
  return entropy;
}

double roundness(const TemplatePyramid& t) {
  const ContourPoints contours = all_contours(t);
  double sum = 0, n = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(contours.count); ++i) {
    const double radius = std::hypot(contours.x[i], contours.y[i]);
    if (radius < 1) continue;
    const double along = (contours.nx[i] * contours.x[i] + contours.ny[i] * contours.y[i]) / radius;
    sum += along * along;
    n += 1;
  }
  return n > 0 ? sum / n : 0.5;
}

PartFeatures measure_features(image::ImageView picture, image::ImageView mask) {
  image::Image full;
  if (mask.empty()) {
    full.resize(picture.width(), picture.height());
    full.fill(255);
  }
  image::Pyramid pictures, masks;
  pictures.build(picture, 3);
  masks.build(mask.empty() ? full.view() : mask, 3);
  PartFeatures out;
  measure_shape(masks.level(0), out);
  int level = 0;
  for (double side = std::sqrt(out.part_pixels); side > kCoarseSidePx && level + 1 < pictures.levels(); side /= 2)
    ++level;
  out.coarse_std = standard_deviation(pictures.level(level), masks.level(level));
  const int finer = std::max(0, level - 1);
  out.direction_ratio = direction_ratio(pictures.level(finer), masks.level(finer));
  return out;
}

}  // namespace pickcell::matches
