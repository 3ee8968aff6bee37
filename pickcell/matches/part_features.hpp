#pragma once
/// What there is in a template to find it by.

#include "pickcell/image/image.hpp"
#include "pickcell/matches/template_pyramid.hpp"

namespace pickcell::matches {

struct PartFeatures {
  double part_pixels = 0;   ///< in the mask
  double long_side_px = 0;  ///< of a rectangle with the part's second moments
  double short_side_px = 0;
  double coarse_std = 0;       ///< grey values, inside the mask, at the level where the part is about 24 pixels wide
  double direction_ratio = 1;  ///< weaker over stronger eigenvalue of the gradients' structure tensor, 0..1
};

/// mask: same size, >= 128 is part; empty: everything.
[[nodiscard]] PartFeatures measure_features(image::ImageView picture, image::ImageView mask);

/// Length of all contours over the part's side, times the entropy (bits) of their directions in eight sectors: about 3
/// for two parallel edges, 10 for a plain outline, 30 and more for lettering, coins, insects.
[[nodiscard]] double contour_variety(const TemplatePyramid& part);

}  // namespace pickcell::matches
