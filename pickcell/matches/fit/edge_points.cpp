#include "pickcell/matches/fit/edge_points.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "pickcell/matches/fields/orientation_field.hpp"

namespace pickcell::matches {
namespace {

constexpr int kOutline_px = 2;
constexpr float kLeastField = 0.35f;
constexpr float kLeastGradient = 6.f;  // grey values per pixel
constexpr int kCluster_px = 12;        // further than what a ground's texture does to neighbours alike

/// Chooses about max_items: the strongest of each cell, with cells as large as needed.
template <class Item, class Strength>
std::vector<Item> strongest_per_cell(const std::vector<Item>& all, int max_items, int width, int height,
                                     Strength strength) {
  std::vector<Item> chosen = all;
  for (float cell = 1.f; static_cast<int>(chosen.size()) > max_items; cell *= 1.15f) {
    const int columns = static_cast<int>(static_cast<float>(width + 4) / cell) + 1;
    const int rows = static_cast<int>(static_cast<float>(height + 4) / cell) + 1;
    std::vector<const Item*> best(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), nullptr);
    for (const Item& item : all) {
      const int x = std::clamp(static_cast<int>((item.x + 2) / cell), 0, columns - 1);
      const int y = std::clamp(static_cast<int>((item.y + 2) / cell), 0, rows - 1);
      const Item*& b =
          best[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x)];
      if (!b || strength(item) > strength(*b)) b = &item;
    }
    chosen.clear();
    for (const Item* item : best)
      if (item) chosen.push_back(*item);
  }
  return chosen;
}

/// Zeros up to whole kPointBlocks, as the kernels want them.
void pad(std::initializer_list<std::vector<float>*> columns) {
  for (auto* c : columns) c->resize(padded_to_blocks(c->size()), 0.f);
}

struct Anchor {
  float x, y;
};

Anchor anchor_at(const TemplatePyramid& t, int level) {
  const double k = std::ldexp(1.0, -level);
  return {static_cast<float>((t.anchor_x_px + 0.5) * k - 0.5), static_cast<float>((t.anchor_y_px + 0.5) * k - 0.5)};
}

struct Gradient {
  float x, y;
};

/// Central differences smoothed across by 1-2-1; one pixel inside the picture.
Gradient smooth_gradient(image::ImageView p, int x, int y) {
  const auto d = [&](int x1, int y1, int x0, int y0) { return static_cast<float>(p.at(x1, y1) - p.at(x0, y0)); };
  return {(2 * d(x + 1, y, x - 1, y) + d(x + 1, y - 1, x - 1, y - 1) + d(x + 1, y + 1, x - 1, y + 1)) / 8,
          (2 * d(x, y + 1, x, y - 1) + d(x - 1, y + 1, x - 1, y - 1) + d(x + 1, y + 1, x + 1, y - 1)) / 8};
}

struct EdgePoint {
  float x, y;
  float c2, s2;
};

struct Found {
  float x, y;
  float nx, ny;
  float strength;
};

/// Keeps a pixel whose gradient is a maximum along its own direction, at the maximum's sub-pixel place.
bool on_contour(image::ImageView p, int x, int y, Found& out) {
  const Gradient g = smooth_gradient(p, x, y);
  const float strength = std::hypot(g.x, g.y);
  if (strength < kLeastGradient) return false;
  const float nx = g.x / strength;
  const float ny = g.y / strength;
  const int sx = static_cast<int>(std::lrintf(1.3f * nx));
  const int sy = static_cast<int>(std::lrintf(1.3f * ny));
  if (x + sx < 1 || y + sy < 1 || x - sx < 1 || y - sy < 1) return false;
  if (x + sx > p.width() - 2 || y + sy > p.height() - 2 || x - sx > p.width() - 2 || y - sy > p.height() - 2)
    return false;
  const auto along = [&](int u, int v) {
    const Gradient h = smooth_gradient(p, u, v);
    return std::abs(h.x * nx + h.y * ny);
  };
  const float ahead = along(x + sx, y + sy);
  const float behind = along(x - sx, y - sy);
  if (strength < ahead || strength <= behind) return false;
  const float bend = ahead + behind - 2 * strength;
  float shift =
      bend < 0 ? 0.5f * (behind - ahead) / bend * std::hypot(static_cast<float>(sx), static_cast<float>(sy)) : 0.f;
  if (std::abs(shift) > 1) shift = 0;
  out.x = static_cast<float>(x) + nx * shift;
  out.y = static_cast<float>(y) + ny * shift;
  out.nx = nx;
  out.ny = ny;
  out.strength = strength;
  return true;
}

std::vector<Found> found_contours(const TemplatePyramid& t, int level, int max_points, const ByteMask& wanted) {
  const TemplateLevel& l = t.levels[static_cast<std::size_t>(level)];
  std::vector<Found> all;
  for (int y = 1; y + 1 < wanted.height(); ++y)
    for (int x = 1; x + 1 < wanted.width(); ++x) {
      Found f{};
      if (wanted.at(x, y) && on_contour(l.grey.view(), x, y, f)) all.push_back(f);
    }
  return strongest_per_cell(all, max_points, wanted.width(), wanted.height(),
                            [](const Found& p) { return p.strength; });
}

ContourPoints columns_of(const std::vector<Found>& all, const Anchor& anchor) {
  ContourPoints out;
  for (const Found& f : all) {
    out.x.push_back(f.x - anchor.x);
    out.y.push_back(f.y - anchor.y);
    out.nx.push_back(f.nx);
    out.ny.push_back(f.ny);
    out.radius = std::max(out.radius, std::hypot(out.x.back(), out.y.back()));
    ++out.count;
  }
  pad({&out.x, &out.y, &out.nx, &out.ny});
  return out;
}

/// Points too near to the template's border for that stay where they are.
void move_to_seen(image::ImageView picture, const Anchor& anchor, ContourPoints& p) {
  constexpr float kReach_px = 1.5f;
  constexpr int kRounds = 2;
  std::vector<float> distance(p.x.size());
  for (int round = 0; round < kRounds; ++round) {
    find_edges(picture, p.columns(), {anchor.x, anchor.y, 1, 0}, kReach_px, EdgeReading::exact, distance.data());
    for (std::size_t i = 0; i < static_cast<std::size_t>(p.count); ++i) {
      if (std::abs(distance[i]) > kReach_px) continue;
      p.x[i] += p.nx[i] * distance[i];
      p.y[i] += p.ny[i] * distance[i];
    }
  }
}

}  // namespace

EdgePoints choose_edge_points(const TemplatePyramid& t, int level, int max_points) {
  const TemplateLevel& l = t.levels[static_cast<std::size_t>(level)];
  OrientationField field;
  orientation_field(l.grey.view(), field);
  const ByteMask wanted = dilate(mask_above(l.coverage, 0.5f), kOutline_px);
  std::vector<EdgePoint> all;
  for (int y = 1; y + 1 < wanted.height(); ++y)
    for (int x = 1; x + 1 < wanted.width(); ++x) {
      if (!wanted.at(x, y)) continue;
      const float c2 = static_cast<float>(field.at(2 * x, y)) / 127.f;
      const float s2 = static_cast<float>(field.at(2 * x + 1, y)) / 127.f;
      if (std::hypot(c2, s2) >= kLeastField) all.push_back({static_cast<float>(x), static_cast<float>(y), c2, s2});
    }
  const Anchor anchor = anchor_at(t, level);
  EdgePoints out;
  float sum = 0;
  std::vector<EdgePoint> chosen = strongest_per_cell(all, max_points, wanted.width(), wanted.height(),
                                                     [](const EdgePoint& e) { return e.c2 * e.c2 + e.s2 * e.s2; });
  if (!chosen.empty()) {
    const auto [x_lo, x_hi] = std::minmax_element(chosen.begin(), chosen.end(),
                                                  [](const EdgePoint& a, const EdgePoint& b) { return a.x < b.x; });
    const auto [y_lo, y_hi] = std::minmax_element(chosen.begin(), chosen.end(),
                                                  [](const EdgePoint& a, const EdgePoint& b) { return a.y < b.y; });
    const BlockGrid grid(x_lo->x, x_hi->x, y_lo->y, y_hi->y);
    out.x_lo = x_lo->x - anchor.x, out.x_hi = x_hi->x - anchor.x;
    out.y_lo = y_lo->y - anchor.y, out.y_hi = y_hi->y - anchor.y;
    out.blocks = grid.sort(chosen);
  }
  for (const EdgePoint& p : chosen) {
    out.x.push_back(p.x - anchor.x);
    out.y.push_back(p.y - anchor.y);
    out.c2.push_back(p.c2);
    out.s2.push_back(p.s2);
    sum += p.c2 * p.c2 + p.s2 * p.s2;
    ++out.count;
  }
  out.norm = sum > 0 ? 1 / sum : 0.f;
  pad({&out.x, &out.y, &out.c2, &out.s2});
  return out;
}

ContourPoints choose_contour_points(const TemplatePyramid& t, int level, int max_points) {
  const ByteMask wanted = dilate(mask_above(t.levels[static_cast<std::size_t>(level)].coverage, 0.5f), kOutline_px);
  return columns_of(found_contours(t, level, max_points, wanted), anchor_at(t, level));
}

RimPoints choose_rim_points(const TemplatePyramid& t, int max_points, int rim_px, int outside_px, bool inside_too) {
  const ByteMask part = mask_above(t.levels.front().coverage, 0.5f);
  ByteMask wanted = dilate(part, outside_px);
  const ByteMask beyond = erode(part, rim_px);
  if (!inside_too)
    for (int y = 0; y < wanted.height(); ++y)
      for (int x = 0; x < wanted.width(); ++x) wanted.at(x, y) &= static_cast<std::uint8_t>(1 - beyond.at(x, y));
  std::vector<Found> all = found_contours(t, 0, max_points, wanted);
  const auto cluster = [](const Found& f) {
    return std::pair(static_cast<int>(f.y) / kCluster_px, static_cast<int>(f.x) / kCluster_px);
  };
  std::stable_sort(all.begin(), all.end(), [&](const Found& a, const Found& b) { return cluster(a) < cluster(b); });
  const Anchor anchor = anchor_at(t, 0);
  RimPoints out;
  out.points = columns_of(all, anchor);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (i == 0 || cluster(all[i]) != cluster(all[i - 1])) out.cluster_begin.push_back(static_cast<int>(i));
  out.cluster_begin.push_back(out.points.count);
  move_to_seen(t.levels.front().grey.view(), anchor, out.points);
  return out;
}

}  // namespace pickcell::matches
