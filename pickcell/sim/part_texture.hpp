#pragma once
/// A part's top face as a raster, so that a renderer can ask for any point of it millions of times.

#include <string_view>
#include <vector>

#include "pickcell/image/image.hpp"
#include "pickcell/sim/part_pictures.hpp"

namespace pickcell::sim {

/// The surface at one point of the top face.
struct Surfel {
  float coverage = 0;  ///< 1 on the part, 0 off it or in a hole
  float albedo = 0;    ///< 0..1; continued smoothly beyond the outline
  float nx = 0;        ///< tilt of the surface in the part's frame, 0 where it is level
  float ny = 0;
};

/// Directional part of the light: from where (degrees counter-clockwise from +x, in the frame the part lies in) and how
/// strong compared with the diffuse rest.
struct Light {
  double from_deg = 120;
  double strength = 0.4;
};

/// How a part lies to the light, worked out once per part.
struct Lighting {
  double c = 1, s = 0;    ///< cosine and sine of the part's angle
  double lx = 1, ly = 0;  ///< towards the light, in the frame the part lies in
  double strength = 0;
  Lighting(double angle_deg, const Light& light);
};

/// Immutable after construction; thread-safe.
class PartTexture {
 public:
  explicit PartTexture(const PartKind& kind);

  [[nodiscard]] const PartKind& kind() const { return kind_; }
  /// Bilinear; coverage 0 beyond the raster. Millimetres in the part's frame.
  [[nodiscard]] Surfel sample(double x_mm, double y_mm) const;
  /// mm to the outline, negative inside; from a coarse raster, about 0.1 mm exact up to 14 mm outside, a lower
  /// bound beyond.
  [[nodiscard]] float distance(double x_mm, double y_mm) const;
  /// Points of the outline and its holes, and points of the covered area on a 1 mm grid; in the part's frame.
  [[nodiscard]] const std::vector<Point2>& rim() const { return rim_; }
  [[nodiscard]] const std::vector<Point2>& inside() const { return inside_; }
  /// Of a circle about the centre of the outline's bounds that encloses the part.
  [[nodiscard]] double radius_mm() const { return kind_.outline.bounds().size().norm() / 2; }
  /// Reflected light of the top face for illumination 1.
  [[nodiscard]] float shade(const Surfel& s, double x_mm, double y_mm, const Lighting& lit) const;
  /// Reflected light of the side wall whose outward normal in the part's frame is (nx, ny).
  [[nodiscard]] float shade_wall(double nx, double ny, const Lighting& lit) const;
  /// Light that reaches the ground at a point of the part's frame, 0..1: contact shadow and a soft cast one. 1 from
  /// 3/4 of the part's height away.
  [[nodiscard]] float ground_light(double x_mm, double y_mm, const Lighting& lit) const;

 private:
  void collect_points();
  void paint(const Point2& p, Surfel& out) const;
  [[nodiscard]] double material(const Point2& p) const;

  PartKind kind_;
  Box2 face_;                    ///< of the surfel raster
  Box2 surround_;                ///< of the distance raster
  Point2 brush_;                 ///< direction of the grinding marks
  image::Plane<float> surfels_;  ///< four per pixel
  image::Plane<float> distance_;
  std::vector<Point2> rim_;
  std::vector<Point2> inside_;
};

/// The texture of a kind of the catalogue; made on first use, then kept. Thread-safe.
[[nodiscard]] const PartTexture& part_texture(std::string_view name);

}  // namespace pickcell::sim
