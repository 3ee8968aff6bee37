#pragma once
/// The last look at a part whose outline was taught with a mask: grey values well inside, which no ground shines
/// through, and the contours at its rim, each counting as much as it knows.

#include <Eigen/Core>
#include <optional>

#include "pickcell/image/image.hpp"
#include "pickcell/matches/fields/template_pyramid.hpp"
#include "pickcell/matches/fit/edge_fit.hpp"
#include "pickcell/matches/fit/grey_points.hpp"
#include "pickcell/matches/fit/weighted_fit.hpp"
#include "pickcell/matches/similarity.hpp"

namespace pickcell::matches {

/// Of level 0; without a mask both are empty.
struct FinalPoints {
  GreyPoints inside;
  GreyPoints few;  ///< of them, for gain, offset and noise; empty where that saves nothing
  RimPoints rim;
};
[[nodiscard]] FinalPoints choose_final_points(const TemplatePyramid& t);

struct FinalFit {
  Similarity place;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  ///< of (x, y, turn, growth) about the anchor, pixels, radians
};

/// None where neither tells enough, or where they lead far away from the start.
[[nodiscard]] std::optional<FinalFit> fit_finally(image::ImageView picture, const FinalPoints& points,
                                                  const Similarity& start, WeightedSamples& samples,
                                                  ContourScratch& contours);

}  // namespace pickcell::matches
