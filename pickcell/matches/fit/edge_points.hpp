#pragma once
/// The template's edges at one pyramid level: for scoring a place, and for moving to a better one.

#include <vector>

#include "pickcell/matches/fields/template_pyramid.hpp"
#include "pickcell/matches/fit/contour_kernel.hpp"
#include "pickcell/matches/fit/score_kernels.hpp"

namespace pickcell::matches {

/// Places where the template's orientation field is strong, relative to the anchor, pixels of the level. Columns over
/// the points, padded with zeros to whole kPointBlocks.
struct EdgePoints {
  std::vector<float> x, y;
  std::vector<float> c2, s2;  ///< field, |(c2, s2)| <= 1
  int count = 0;
  float norm = 0;                                ///< 1 / sum |field|^2: the template scores 1 against itself
  float x_lo = 0, x_hi = 0, y_lo = 0, y_hi = 0;  ///< box of (x, y)
  BlockBegins blocks{};                          ///< of the score: the points lie block by block

  [[nodiscard]] EdgeColumns columns() const { return {x.data(), y.data(), c2.data(), s2.data(), count}; }
};

/// Points on contours, relative to the anchor, pixels of the level, with unit normals along the gradient. Columns as
/// above.
struct ContourPoints {
  std::vector<float> x, y;
  std::vector<float> nx, ny;
  int count = 0;
  float radius = 1;  ///< of the furthest point from the anchor

  [[nodiscard]] ContourColumns columns() const { return {x.data(), y.data(), nx.data(), ny.data(), count}; }
};

/// Both take the outline in: points up to 2 px outside the mask. Strongest point per grid cell, about max_points in
/// all.
[[nodiscard]] EdgePoints choose_edge_points(const TemplatePyramid& t, int level, int max_points);
[[nodiscard]] ContourPoints choose_contour_points(const TemplatePyramid& t, int level, int max_points);

/// Contour points of level 0 at the rim of the mask, up to rim_px inside of it and outside_px outside, or also further
/// inside; clusters of them lie together. Each lies where find_edges sees it in the template, so that a picture's
/// contours, seen the same way, are off by as much.
struct RimPoints {
  ContourPoints points;
  std::vector<int> cluster_begin;  ///< the points of cluster c are cluster_begin[c] .. cluster_begin[c + 1]
};
[[nodiscard]] RimPoints choose_rim_points(const TemplatePyramid& t, int max_points, int rim_px, int outside_px,
                                          bool inside_too);

}  // namespace pickcell::matches
