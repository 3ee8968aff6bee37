#pragma once
/// The pose of a board from one picture and a known lens. Built with PICKCELL_WITH_CALIBRATION only.

#include <Eigen/Core>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/core/transform.hpp"
#include "pickcell/poses/board.hpp"
#include "pickcell/poses/lens.hpp"

namespace pickcell::poses {

struct BoardPose {
  core::Transform<core::Camera, core::Board> T_camera_board;
  double rms_px = 0;  ///< sqrt(mean(dx^2 + dy^2)) over the view's points
};

/// Least squares of the reprojection, begun from both poses that a plane in perspective allows. Thread-safe. Errors:
/// negative, when the points do not fix a pose (fewer than 4, in one line).
[[nodiscard]] core::Result<BoardPose> board_pose(const Lens& lens, const Board& board, const BoardView& view);

/// The same for any points of known place: p_frame = T_camera_frame^-1 * p_camera. Used with touched points.
struct PointsPose {
  Eigen::Isometry3d T_camera_points = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Vector2d> residual_px;  ///< seen minus predicted
  double rms_px = 0;
};
[[nodiscard]] core::Result<PointsPose> points_pose(const Lens& lens, const std::vector<Eigen::Vector3d>& points_m,
                                                   const std::vector<Eigen::Vector2d>& pixels);

/// Pixels of board points for a pose.
[[nodiscard]] std::vector<Eigen::Vector2d> predicted_pixels(
    const Lens& lens, const Board& board, const std::vector<int>& ids,
    const core::Transform<core::Camera, core::Board>& T_camera_board);

}  // namespace pickcell::poses
