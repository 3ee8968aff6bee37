#pragma once
/// Forward projection of the simulated camera, written on its own: the cell's lens model in poses is judged against it.

#include <Eigen/Core>
#include <array>

#include "pickcell/core/transform.hpp"

namespace pickcell::sim {

/// Pinhole with the distortion of Brown and Conrady (k1, k2, p1, p2, k3), pixel centres at integers.
struct Intrinsics {
  int width_px = 1280;
  int height_px = 1024;
  double fx_px = 2560;
  double fy_px = 2560;
  double cx_px = 639.5;
  double cy_px = 511.5;
  std::array<double, 5> distortion{};
};

/// Pixel of a point in the camera's frame (any unit); its z must be positive.
[[nodiscard]] Eigen::Vector2d project(const Intrinsics& camera, const Eigen::Vector3d& p_camera);

/// The ray (x, y, 1) of a pixel, by Newton's method on project, to 1e-9 px for lenses that are invertible there. guess:
/// a ray near by, to be quicker.
[[nodiscard]] Eigen::Vector3d ray(const Intrinsics& camera, const Eigen::Vector2d& pixel,
                                  const Eigen::Vector3d* guess = nullptr);

/// The point where the ray of a pixel meets the plane z = height_mm of a frame; mm. T_plane_camera in metres.
[[nodiscard]] Eigen::Vector2d cast_mm(const Intrinsics& camera,
                                      const core::Transform<core::Plane, core::Camera>& T_plane_camera,
                                      const Eigen::Vector2d& pixel, double height_mm);

}  // namespace pickcell::sim
