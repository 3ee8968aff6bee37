#pragma once
/// How well the pictures of a board fill the picture and the directions, and what to add.

#include <string>
#include <vector>

#include "pickcell/poses/camera_calibration.hpp"

namespace pickcell::poses {

struct ViewCoverage {
  double area = 0;            ///< share of the picture inside the outline of at least one board
  double tilt_range_deg = 0;  ///< largest angle between the normals of two boards
  double largest_tilt_deg = 0;
  std::vector<std::string> advice;
};

/// views: not empty, with poses.
[[nodiscard]] ViewCoverage view_coverage(const std::vector<CameraView>& views);

/// The convex hull of a view's points, in order.
[[nodiscard]] std::vector<Eigen::Vector2d> outline(const BoardView& view);

}  // namespace pickcell::poses
