#pragma once
/// What there is in a template to find it by.

#include "pickcell/image/image.hpp"
#include "pickcell/matches/fields/template_pyramid.hpp"

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

/// Entropy of the directions of all contours in eight sectors of half a turn: 1 for two parallel edges, 3 for a disc.
[[nodiscard]] double direction_bits(const TemplatePyramid& part);

/// How far all contours run around the anchor: the mean square of the cosine between a contour's normal and the way to
/// the anchor. 1 for a disc, 0.5 for contours that have nothing to do with it.
[[nodiscard]] double roundness(const TemplatePyramid& part);

}  // namespace pickcell::matches
