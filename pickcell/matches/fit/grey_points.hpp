#pragma once
/// The template's grey values at one pyramid level, prepared for Gauss-Newton.

#include <Eigen/Core>
#include <array>
#include <vector>

#include "pickcell/matches/fields/template_pyramid.hpp"
#include "pickcell/matches/fit/score_kernels.hpp"

namespace pickcell::matches {

/// Points of the part (away from its outline), at most one per grid cell: the one with the strongest gradient.
/// Columns over the points, each with its mean taken off: t the grey value, j[0..3] its derivatives by dx, dy (pixels
/// of the level), turn (radians) and growth of an Increment.
struct GreyPoints {
  static constexpr double kFlatStd = 4;  ///< grey values
  std::vector<float> qx, qy;             ///< place relative to the anchor, pixels of the level
  std::vector<float> t;
  std::array<std::vector<float>, 4> j;
  /// Of the normal matrix of (t, j).
  Eigen::Matrix<double, 5, 5> inverse = Eigen::Matrix<double, 5, 5>::Zero();
  double energy = 0;                             ///< sum of t^2
  float radius = 1;                              ///< of the furthest point from the anchor, pixels of the level
  float x_lo = 0, x_hi = 0, y_lo = 0, y_hi = 0;  ///< box of (qx, qy)
  double pixels_per_point = 1;                   ///< how many pixels of the part one point stands for

  BlockBegins blocks{};  ///< of the score: the points lie block by block

  int count = 0;  ///< points; the columns are padded with zeros to whole kPointBlocks

  [[nodiscard]] int size() const { return count; }
  [[nodiscard]] PointColumns columns() const {
    return {qx.data(), qy.data(), t.data(), {j[0].data(), j[1].data(), j[2].data(), j[3].data()}, count};
  }
  /// Nothing inside but what a sensor's noise would leave: then the edges alone tell the part.
  [[nodiscard]] bool flat() const { return energy < kFlatStd * kFlatStd * size(); }
  /// Whether the grey values can tell a place: enough points, some contrast, an invertible normal matrix.
  [[nodiscard]] bool usable() const {
    return size() >= 12 && energy > size() && inverse.allFinite() && inverse(0, 0) > 0;
  }
};

[[nodiscard]] GreyPoints choose_grey_points(const TemplatePyramid& t, int level, int max_points);
/// Only those at least this far inside the mask: whatever ground the part lies on, it does not shine through there.
/// None where too few are left.
[[nodiscard]] GreyPoints choose_inner_grey_points(const TemplatePyramid& t, int level, int max_points, int rim_px);

}  // namespace pickcell::matches
