#pragma once
/// Where the camera sits on the arm, or beside it, from pictures of a board and arm poses. Built with
/// PICKCELL_WITH_CALIBRATION only.
///
/// Both mountings are one equation. Eye-in-hand: T_base_board = T_base_flange * T_flange_camera * T_camera_board.
/// Eye-to-hand: T_flange_board = T_base_flange^-1 * T_base_camera * T_camera_board. With M ("moves") for T_base_flange
/// or its inverse, X for the wanted transform and Y for the place of the board: Y = M * X * T_camera_board.

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/poses/board.hpp"
#include "pickcell/poses/calibration.hpp"
#include "pickcell/poses/camera_calibration.hpp"
#include "pickcell/poses/pose_files.hpp"

namespace pickcell::poses {

enum class Mounting { eye_in_hand, eye_to_hand };

/// A picture with a board and the pose of the arm when it was taken.
struct ArmView {
  NamedView picture;
  ArmPose arm;
};

struct HandeyeInput {
  Lens lens;
  Board board;
  Mounting mounting = Mounting::eye_in_hand;
  Eigen::Isometry3d T_flange_tool = Eigen::Isometry3d::Identity();  ///< the poses are T_base_flange * T_flange_tool
  std::vector<ArmView> views;
  bool keep_lens = false;  ///< use the given lens even where the pictures contradict it
};

/// Scatter of the board's place Y over the pictures, each by its own board pose: RMS distance from their mean.
struct Spread {
  double mm = 0, deg = 0;
};

/// One used picture after the fit.
struct HandeyeView {
  std::string image;
  BoardView view;                            ///< numbered as the fit has it
  std::vector<Eigen::Vector2d> residual_px;  ///< seen minus predicted by arm, X and Y
  double rms_px = 0;
  double picture_rms_px = 0;       ///< of the board's pose in this picture alone: what the arm has no part in
  double plane_error_mm = 0;       ///< mean over the points
  double arm_mm = 0, arm_deg = 0;  ///< likeliest error of the arm's pose, in the arm's own frame
};

struct HandeyeFit {
  HandeyeCalibration calibration;                         ///< without camera checksum and date
  std::string method;                                     ///< the solver whose refined result is used
  std::vector<std::pair<std::string, Spread>> by_method;  ///< before refinement
  std::vector<HandeyeView> views;
  std::vector<LeftOut> left_out;
  double rms_px = 0;
  Spread spread;
  double plane_error_mm = 0, holdout_mm = 0;
  double picture_rms_px = 0;  ///< median over the pictures of HandeyeView::picture_rms_px
  /// Set when the given lens does not fit the pictures: the lens that the fit was made with instead.
  std::optional<CameraFit> own_lens;
  std::string fault;  ///< the kind of fault that explains a bad result, "" when none is seen
  std::string why;    ///< the verdict in a sentence
};

/// Checks the motions, runs five solvers, refines by reprojection over all pictures, leaves out poses that do not fit
/// the others, looks for the kind of fault when the result is not good. Where the given lens does not fit the pictures,
/// one calibrated from the same pictures is used, if poses that took no part in the fit agree better with it; own_lens
/// and why say so. Deterministic.
/// Errors: negative: fewer than three pictures with a board, motions that cannot be solved (named).
[[nodiscard]] core::Result<HandeyeFit> calibrate_handeye(const HandeyeInput& input);

}  // namespace pickcell::poses
