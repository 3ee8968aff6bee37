#pragma once
/// What the residuals at a place say: how much of the part agrees, and how certain the pose is.

#include <Eigen/Core>

#include "pickcell/image/image.hpp"
#include "pickcell/matches/fit/grey_points.hpp"
#include "pickcell/matches/fit/weighted_fit.hpp"
#include "pickcell/matches/similarity.hpp"

namespace pickcell::matches {

struct FitQuality {
  double visible = 0;  ///< share of all points that are inside the picture and whose residual is small
  double noise = 0;    ///< standard deviation of the residuals of those points, grey values
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  ///< of (dx, dy, turn, growth), pixels of the level
  Increment step;                                        ///< to the place that those points want
};

/// few: of the same part; gain, offset and noise are taken from them, unless they are none.
/// covariance = noise^2 / gain^2 * inverse of the normal matrix of the agreeing points, offset and gain eliminated.
[[nodiscard]] FitQuality judge_fit(image::ImageView level, const GreyPoints& points, const GreyPoints& few,
                                   const LevelMap& map, WeightedSamples& scratch);

/// The covariance of a fit at level 0 as that of the reported pose (x_px, y_px, angle_deg, scale): Match::covariance.
/// ref_dx, ref_dy: the reference point less the template's anchor, pixels of the template.
[[nodiscard]] Eigen::Matrix4d covariance_at_reference(const FitQuality& quality, const Similarity& place, double ref_dx,
                                                      double ref_dy);

}  // namespace pickcell::matches
