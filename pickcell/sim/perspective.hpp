#pragma once
/// Renders the work plane with its parts through a camera: height, side walls, shadow, lens distortion.

#include <cstdint>
#include <utility>
#include <vector>

#include "pickcell/sim/camera_model.hpp"
#include "pickcell/sim/layout.hpp"
#include "pickcell/sim/sensor.hpp"
#include "pickcell/sim/surface.hpp"

namespace pickcell::sim {

/// A piece of a surface larger than the field of view of 400 mm; a moving belt continues it by mirroring.
[[nodiscard]] SurfaceTexture seen_surface(Surface surface, std::uint64_t seed);

/// Keeps, for one camera in one place, the point of the plane behind every pixel and the last background. One thread at
/// a time.
class Perspective {
 public:
  Perspective(const Intrinsics& camera, const core::Transform<core::Plane, core::Camera>& T_plane_camera,
              SurfaceTexture surface, Light light);

  /// The plane, its surface moved by shift_mm along +x, and the parts on it; light 1 = full scale.
  [[nodiscard]] LightPlane render(const std::vector<LaidPart>& parts, double shift_mm);

  /// Pixels whose centre shows the top face of the part (255, others 0).
  [[nodiscard]] image::Image mask(const LaidPart& part) const;

  /// Pixel of a point of the plane's frame, mm.
  [[nodiscard]] Eigen::Vector2d pixel(const Eigen::Vector3d& plane_mm) const;

 private:
  struct Window {
    int x0, y0, x1, y1;
  };
  struct Sight;
  [[nodiscard]] Window window(const LaidPart& part, double margin_mm) const;
  [[nodiscard]] Eigen::Vector2f ground(int x, int y) const { return {ground_x_.at(x, y), ground_y_.at(x, y)}; }
  void lay_background(double shift_mm);
  void draw(LightPlane& scene, const LaidPart& part) const;
  void draw_pixel(float& out, int x, int y, const Sight& sight, const Lighting& lit) const;

  Intrinsics camera_;
  core::Transform<core::Plane, core::Camera> T_plane_camera_;
  Eigen::Vector3f eye_mm_;  ///< the camera's centre in the plane's frame
  SurfaceTexture surface_;
  Light light_;
  image::Plane<float> ground_x_, ground_y_;  ///< point of z = 0 behind each pixel, mm; one column and row more
  LightPlane background_;
  double background_shift_mm_ = 0;
};

}  // namespace pickcell::sim
