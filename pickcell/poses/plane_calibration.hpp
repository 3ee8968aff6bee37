#pragma once
/// A fixed camera over a work plane, from places that the tool touched. Built with PICKCELL_WITH_CALIBRATION only.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/poses/board.hpp"
#include "pickcell/poses/calibration.hpp"
#include "pickcell/poses/pose_files.hpp"

namespace pickcell::poses {

struct PlaneFit {
  PlaneCalibration calibration;         ///< without camera checksum and date
  std::vector<double> error_mm;         ///< per point: the pixel cast onto the touched plane against the touched place
  std::vector<Eigen::Vector2d> pixels;  ///< of the same points
  std::vector<Eigen::Vector2d> residual_px;  ///< seen minus where the result expects the touched place
  double rms_mm = 0, worst_mm = 0;
  std::optional<double> loo_mm;  ///< RMS over points that took no part in the fit; from five points
  double picture_rms_px = 0;     ///< of the board's pose in the picture, with a board
  std::string why;
};

/// From at least four touched points seen in the picture. height_m: of the touched surface above the work plane.
/// Errors: negative: too few, in a line, no pose fits; unreadable: a point outside the picture.
[[nodiscard]] core::Result<PlaneFit> plane_from_points(const Lens& lens, const std::vector<TouchedPixel>& points,
                                                       double height_m);

/// From a picture of the board and at least three of its points touched, not in a line. height_m: of the board's
/// surface above the work plane. A board that is too large or small against the touched places is named.
[[nodiscard]] core::Result<PlaneFit> plane_from_touched_board(const Lens& lens, const Board& board,
                                                              const BoardView& view,
                                                              const std::vector<TouchedCorner>& touched,
                                                              double height_m);

/// From a picture of the board alone: base is the board's frame turned so that z points at the camera, and marked as
/// such. A cell that moves an arm refuses it.
[[nodiscard]] core::Result<PlaneFit> plane_from_board(const Lens& lens, const Board& board, const BoardView& view,
                                                      double height_m);

}  // namespace pickcell::poses
