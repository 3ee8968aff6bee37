#include "pickcell/matches/fit/grey_points.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace pickcell::matches {
namespace {

constexpr int kOutlineErosion_px = 1;  // pixels of the outline mix part and background
constexpr int kFewestPoints = 40;

struct Point {
  float x, y, t, gx, gy;
  [[nodiscard]] float strength() const { return gx * gx + gy * gy; }
};

/// Pixels wholly of the part, without its rim unless the part is so thin that too little would be left.
ByteMask inner(const TemplatePyramid& t, const TemplateLevel& l) {
  if (!t.masked) return mask_above(l.coverage, 0.5f);
  const ByteMask whole = mask_above(l.coverage, 0.98f);
  ByteMask eroded = erode(whole, kOutlineErosion_px);
  const int left = count(eroded);
  if (left >= kFewestPoints && 4 * left >= count(whole)) return eroded;
  return count(whole) >= kFewestPoints ? whole : mask_above(l.coverage, 0.4f);
}

std::vector<Point> points_of(const TemplatePyramid& t, int level, const ByteMask& wanted) {
  const TemplateLevel& l = t.levels[static_cast<std::size_t>(level)];
  const double k = std::ldexp(1.0, -level);
  const double ax = (t.anchor_x_px + 0.5) * k - 0.5;
  const double ay = (t.anchor_y_px + 0.5) * k - 0.5;
  std::vector<Point> out;
  for (int y = 1; y + 1 < l.grey.height(); ++y)
    for (int x = 1; x + 1 < l.grey.width(); ++x) {
      if (!wanted.at(x, y)) continue;
      out.push_back({static_cast<float>(x - ax), static_cast<float>(y - ay), static_cast<float>(l.grey.at(x, y)),
                     0.5f * static_cast<float>(l.grey.at(x + 1, y) - l.grey.at(x - 1, y)),
                     0.5f * static_cast<float>(l.grey.at(x, y + 1) - l.grey.at(x, y - 1))});
    }
  return out;
}

/// The strongest point of each cell of a grid with about max_points cells on the part.
std::vector<Point> thinned(const std::vector<Point>& all, int max_points) {
  if (static_cast<int>(all.size()) <= max_points) return all;
  const float cell = std::sqrt(static_cast<float>(all.size()) / static_cast<float>(max_points));
  float x0 = all[0].x;
  float x1 = x0;
  const float y0 = all[0].y;
  for (const Point& p : all) {
    x0 = std::min(x0, p.x);
    x1 = std::max(x1, p.x);
  }
  const auto columns = static_cast<std::size_t>((x1 - x0) / cell) + 1;
  const auto rows = static_cast<std::size_t>((all.back().y - y0) / cell) + 1;
  std::vector<const Point*> best(columns * rows, nullptr);
  for (const Point& p : all) {
    const Point*& b =
        best[static_cast<std::size_t>((p.y - y0) / cell) * columns + static_cast<std::size_t>((p.x - x0) / cell)];
    if (!b || p.strength() > b->strength()) b = &p;
  }
  std::vector<Point> out;
  for (const Point* p : best)
    if (p) out.push_back(*p);
  return out;
}

void take_mean_off(std::vector<float>& v) {
  double sum = 0;
  for (float x : v) sum += x;
  const auto mean = static_cast<float>(sum / static_cast<double>(v.size()));
  for (float& x : v) x -= mean;
}

void set_normal_matrix(GreyPoints& g) {
  const std::array<const std::vector<float>*, 5> columns{&g.t, &g.j[0], &g.j[1], &g.j[2], &g.j[3]};
  Eigen::Matrix<double, 5, 5> normal;
  for (int a = 0; a < 5; ++a)
    for (int b = 0; b < 5; ++b) {
      double sum = 0;
      for (std::size_t i = 0; i < g.qx.size(); ++i)
        sum += static_cast<double>((*columns[static_cast<std::size_t>(a)])[i]) *
               static_cast<double>((*columns[static_cast<std::size_t>(b)])[i]);
      normal(a, b) = sum;
    }
  g.energy = normal(0, 0);
  for (int a = 1; a < 5; ++a) normal(a, a) *= 1.0001;  // keeps round parts (no torque) invertible
  const Eigen::FullPivLU<Eigen::Matrix<double, 5, 5>> lu(normal);
  g.inverse = lu.isInvertible() ? Eigen::Matrix<double, 5, 5>(lu.inverse()) : Eigen::Matrix<double, 5, 5>::Zero();
}

GreyPoints chosen_of(const std::vector<Point>& all, int max_points) {
  std::vector<Point> chosen = thinned(all, max_points);
  GreyPoints g;
  if (chosen.empty()) return g;
  g.pixels_per_point = static_cast<double>(all.size()) / static_cast<double>(chosen.size());
  const auto [x_lo, x_hi] =
      std::minmax_element(chosen.begin(), chosen.end(), [](const Point& a, const Point& b) { return a.x < b.x; });
  const auto [y_lo, y_hi] =
      std::minmax_element(chosen.begin(), chosen.end(), [](const Point& a, const Point& b) { return a.y < b.y; });
  g.x_lo = x_lo->x, g.x_hi = x_hi->x, g.y_lo = y_lo->y, g.y_hi = y_hi->y;
  g.blocks = BlockGrid(g.x_lo, g.x_hi, g.y_lo, g.y_hi).sort(chosen);
  float radius2 = 1;
  for (const Point& p : chosen) {
    g.qx.push_back(p.x);
    g.qy.push_back(p.y);
    g.t.push_back(p.t);
    g.j[0].push_back(p.gx);
    g.j[1].push_back(p.gy);
    g.j[2].push_back(p.gx * p.y - p.gy * p.x);  // R(turn) moves (x, y) by turn * (y, -x)
    g.j[3].push_back(p.gx * p.x + p.gy * p.y);
    radius2 = std::max(radius2, p.x * p.x + p.y * p.y);
  }
  g.radius = std::sqrt(radius2);
  take_mean_off(g.t);
  for (auto& column : g.j) take_mean_off(column);
  set_normal_matrix(g);
  g.count = static_cast<int>(chosen.size());
  const std::size_t padded = padded_to_blocks(chosen.size());
  for (auto* column : {&g.qx, &g.qy, &g.t, &g.j[0], &g.j[1], &g.j[2], &g.j[3]}) column->resize(padded, 0.f);
  return g;
}

}  // namespace

GreyPoints choose_grey_points(const TemplatePyramid& t, int level, int max_points) {
  return chosen_of(points_of(t, level, inner(t, t.levels[static_cast<std::size_t>(level)])), max_points);
}

GreyPoints choose_inner_grey_points(const TemplatePyramid& t, int level, int max_points, int rim_px) {
  const ByteMask whole = mask_above(t.levels[static_cast<std::size_t>(level)].coverage, 0.98f);
  return chosen_of(points_of(t, level, erode(whole, rim_px)), max_points);
}

}  // namespace pickcell::matches
