#pragma once
/// Parts seen straight from above: a similarity between the part and the picture, for data sets with exact truth.

#include "pickcell/sim/part_texture.hpp"
#include "pickcell/sim/sensor.hpp"
#include "pickcell/sim/surface.hpp"

namespace pickcell::sim {

/// Where the point anchor_mm of the part lies in the picture; angle counter-clockwise on the screen.
struct FlatPose {
  double x_px = 0;
  double y_px = 0;
  double angle_deg = 0;
  double px_per_mm = 1;
  Point2 anchor_mm = Point2::Zero();
};

/// Fills the plane with a piece of a surface, turned by angle_deg, whose point at the plane's (0,0) is x_mm, y_mm.
void lay_surface(LightPlane& scene, const SurfaceTexture& surface, double px_per_mm, double x_mm, double y_mm,
                 double angle_deg);

/// Draws shadow and part over what is there, with 3x3 samples per pixel.
void lay_part(LightPlane& scene, const PartTexture& part, const FlatPose& pose, const Light& light);

/// Fraction of each pixel that the part covers, 0..1.
[[nodiscard]] LightPlane coverage(int width, int height, const PartTexture& part, const FlatPose& pose);

}  // namespace pickcell::sim
