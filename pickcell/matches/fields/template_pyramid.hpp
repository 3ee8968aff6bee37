#pragma once
/// The template and its mask at halved sizes.

#include <vector>

#include "pickcell/image/image.hpp"
#include "pickcell/matches/model.hpp"

namespace pickcell::matches {

using ByteMask = image::Plane<std::uint8_t>;  ///< 0 or 1

struct TemplateLevel {
  image::Image grey;
  image::Plane<float> coverage;  ///< how much of the pixel belongs to the part, 0..1
};

/// Levels as in image::Pyramid. The anchor is the centroid of the mask: the point about which the engine turns the
/// template.
struct TemplatePyramid {
  std::vector<TemplateLevel> levels;
  bool masked = false;
  double anchor_x_px = 0;
  double anchor_y_px = 0;
  double area_px = 0;        ///< of the mask
  double rms_radius_px = 0;  ///< of the mask about the anchor

  [[nodiscard]] int width() const { return levels.front().grey.width(); }
  [[nodiscard]] int height() const { return levels.front().grey.height(); }
};

/// Halves while the shorter side stays >= min_side_px. The model's mask must be empty or of the picture's size (throws
/// std::invalid_argument) and hold at least one pixel of the part.
[[nodiscard]] TemplatePyramid build_template_pyramid(const Model& model, int min_side_px = 4);

/// Pixels whose coverage exceeds the limit.
[[nodiscard]] ByteMask mask_above(const image::Plane<float>& coverage, float limit);
/// Grown by a disc; nothing lies outside the picture.
[[nodiscard]] ByteMask dilate(const ByteMask& mask, int radius_px);
/// Shrunk by a disc; outside the picture the part goes on.
[[nodiscard]] ByteMask erode(const ByteMask& mask, int radius_px);
[[nodiscard]] int count(const ByteMask& mask);

}  // namespace pickcell::matches
