#include "pickcell/sim/camera_model.hpp"

#include <Eigen/LU>
#include <utility>

namespace pickcell::sim {

namespace {

/// Distorted image-plane coordinates of undistorted ones, and their derivative.
std::pair<Eigen::Vector2d, Eigen::Matrix2d> distort(const std::array<double, 5>& k, double x, double y) {
  const auto [k1, k2, p1, p2, k3] = k;
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3)), slope = k1 + r2 * (2 * k2 + 3 * k3 * r2);
  const Eigen::Vector2d to(x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                           y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y);
  const double mixed = 2 * x * y * slope + 2 * p1 * x + 2 * p2 * y;
  Eigen::Matrix2d J;
  J << radial + 2 * x * x * slope + 2 * p1 * y + 6 * p2 * x, mixed, mixed,
      radial + 2 * y * y * slope + 6 * p1 * y + 2 * p2 * x;
  return {to, J};
}

}  // namespace

Eigen::Vector2d project(const Intrinsics& camera, const Eigen::Vector3d& p_camera) {
  const Eigen::Vector2d d = distort(camera.distortion, p_camera.x() / p_camera.z(), p_camera.y() / p_camera.z()).first;
  return {camera.fx_px * d.x() + camera.cx_px, camera.fy_px * d.y() + camera.cy_px};
}

Eigen::Vector3d ray(const Intrinsics& camera, const Eigen::Vector2d& pixel, const Eigen::Vector3d* guess) {
  const Eigen::Vector2d seen((pixel.x() - camera.cx_px) / camera.fx_px, (pixel.y() - camera.cy_px) / camera.fy_px);
  Eigen::Vector2d p = guess != nullptr ? Eigen::Vector2d(guess->head<2>()) : seen;
  for (int i = 0; i < 12; ++i) {
    const auto [d, J] = distort(camera.distortion, p.x(), p.y());
    const Eigen::Vector2d step = J.inverse() * (seen - d);
    p += step;
    if (step.squaredNorm() < 1e-20) break;
  }
  return {p.x(), p.y(), 1};
}

Eigen::Vector2d cast_mm(const Intrinsics& camera, const core::Transform<core::Plane, core::Camera>& T_plane_camera,
                        const Eigen::Vector2d& pixel, double height_mm) {
  const Eigen::Vector3d along = T_plane_camera.rotation() * ray(camera, pixel);
  const Eigen::Vector3d from_mm = T_plane_camera.translation_m() * 1e3;
  const Eigen::Vector3d hit = from_mm + along * ((height_mm - from_mm.z()) / along.z());
  return hit.head<2>();
}

}  // namespace pickcell::sim
