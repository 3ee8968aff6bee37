#pragma once
/// Pinhole camera with the distortion of Brown and Conrady, in OpenCV's order (k1 k2 p1 p2 k3 [k4 k5 k6]); Zhang's
/// model as the paper uses it.

#include <Eigen/Core>
#include <array>
#include <optional>

namespace pickcell::poses {

/// Pixel centres at integers.
struct Lens {
  int width_px = 0, height_px = 0;
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  std::array<double, 8> distortion{};  ///< k1 k2 p1 p2 k3 k4 k5 k6; unused ones are 0
};

/// Picture place of a direction (x/z, y/z) in the camera frame.
[[nodiscard]] Eigen::Vector2d project(const Lens& lens, const Eigen::Vector2d& direction);

/// The direction (x/z, y/z) seen at a pixel, by Newton's method to 1e-12; nothing where the distortion model folds over
/// and no unique direction exists.
[[nodiscard]] std::optional<Eigen::Vector2d> undistort(const Lens& lens, const Eigen::Vector2d& pixel);

}  // namespace pickcell::poses
