#pragma once
/// A template as its symmetry is looked for: smoothed, so that reading it between pixels costs nothing, with what is
/// known about its ground and its noise.

#include <array>

#include "pickcell/image/image.hpp"

namespace pickcell::matches {

struct PartPicture {
  /// a + bx x + by y, grey values.
  struct Ground {
    double a = 0, bx = 0, by = 0;
    [[nodiscard]] double at(double x, double y) const { return a + bx * x + by * y; }
  };
  struct Point {
    double x = 0, y = 0;
  };

  image::Plane<float> grey;
  image::Plane<float> cover;  ///< share of the part, 0..1; without a mask 1
  bool masked = false;
  bool on_ground = false;    ///< without a mask: the part lies on even ground, which goes on beyond the picture
  double cover_outside = 0;  ///< beyond the picture
  Ground ground;             ///< there
  double noise = 0;          ///< sigma of grey
  double contrast = 0;       ///< between the brightest and the darkest two percent of the part and its outline

  /// Middle of the mask, or of the picture; of the part's edges without a mask.
  [[nodiscard]] std::array<Point, 2> likely_centres() const;
  /// Of the farthest pixel that is part.
  [[nodiscard]] double radius(Point centre) const;
};

/// mask: same size, >= 128 is part; empty: none.
[[nodiscard]] PartPicture make_part_picture(image::ImageView picture, image::ImageView mask);

}  // namespace pickcell::matches
