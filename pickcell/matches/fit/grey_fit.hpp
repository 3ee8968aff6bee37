#pragma once
/// One Gauss-Newton step on grey values, and the correlation at the place where it was taken.

#include "pickcell/image/image.hpp"
#include "pickcell/matches/fit/grey_points.hpp"
#include "pickcell/matches/fit/weighted_fit.hpp"
#include "pickcell/matches/similarity.hpp"

namespace pickcell::matches {

/// scene(W q) = gain (t + j d) + offset, fitted at one place. W then becomes W o V(d)^-1 (compose_inverse).
struct GreyFit {
  double ncc = -1;  ///< over the points inside the picture; -1 where the scene is flat
  double gain = 0;
  double inside = 0;    ///< share of the points that lie inside the picture
  double contrast = 0;  ///< standard deviation of the scene under the points
  bool can_step = false;
  Increment step;  ///< d; dx, dy in pixels of the level
};

/// The normal matrix is constant when every point is inside the picture; otherwise the points outside are left out and
/// the matrix is summed anew. Source: Baker & Matthews, Lucas-Kanade 20 years on (inverse compositional), with gain and
/// offset.
[[nodiscard]] GreyFit fit_grey(image::ImageView level, const GreyPoints& points, const LevelMap& map,
                               WeightedSamples& scratch);

/// The same with the outliers of a first fit weighed down (Tukey's biweight, cut at 4 robust standard deviations),
/// which an occluder or a highlight makes necessary. For stepping only: ncc and contrast are not measured.
[[nodiscard]] GreyFit fit_grey_robust(image::ImageView level, const GreyPoints& points, const LevelMap& map,
                                      WeightedSamples& scratch);

/// The step with its rim movement limited to limit_px pixels of the level.
[[nodiscard]] Increment limited(const Increment& step, float radius, double limit_px);
/// How far the step moves the part's rim, pixels of the level.
[[nodiscard]] double rim_movement(const Increment& step, float radius);

}  // namespace pickcell::matches
