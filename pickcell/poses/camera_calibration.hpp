#pragma once
/// The lens from pictures of a board (Zhang's method, as in the paper), with a verdict. Built with
/// PICKCELL_WITH_CALIBRATION only.

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/core/transform.hpp"
#include "pickcell/poses/board.hpp"
#include "pickcell/poses/calibration.hpp"

namespace pickcell::poses {

/// A picture in which the board was found.
struct NamedView {
  std::string image;
  BoardView view;
};

struct LeftOut {
  std::string image;
  std::string reason;
};

/// One used picture after the fit.
struct CameraView {
  std::string image;
  BoardView view;
  std::vector<Eigen::Vector2d> residual_px;  ///< seen minus predicted, per point
  double rms_px = 0;
  core::Transform<core::Camera, core::Board> T_camera_board;
  double tilt_deg = 0;  ///< between the board's normal and the optical axis
};

struct LensSigma {
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  std::vector<double> distortion;
};

/// A lens model that was tried: the error on pictures that took no part in the fit.
struct ModelTrial {
  std::string model;
  double holdout_rms_px = 0;
};

struct CameraFit {
  CameraCalibration calibration;  ///< without camera_id and date
  std::vector<CameraView> views;
  std::vector<LeftOut> left_out;
  std::vector<ModelTrial> trials;
  LensSigma sigma;
  double coverage = 0;        ///< share of the picture's area that the boards together cover, 0..1
  double tilt_range_deg = 0;  ///< largest angle between the normals of two boards
  double largest_tilt_deg = 0;
  std::vector<std::string> advice;  ///< what pictures to add
  std::string why;                  ///< the verdict in a sentence
};

/// Tries none, k1k2, brown5 and rational distortion, takes the simplest one whose hold-out error is within 2 % of the
/// best, leaves out pictures that repeat another one and pictures that do not fit the others. All views must have one
/// size. Errors: negative, when fewer than three different pictures remain.
[[nodiscard]] core::Result<CameraFit> calibrate_camera(const Board& board, std::vector<NamedView> views);

}  // namespace pickcell::poses
