#pragma once
/// Whether a camera still stands where it was calibrated. Built with PICKCELL_WITH_CALIBRATION only.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/poses/board.hpp"
#include "pickcell/poses/calibration.hpp"

namespace pickcell::poses {

enum class Drift { ok, drifted, reject };
[[nodiscard]] const char* name(Drift drift);

struct VerifyResult {
  double drift_mm = 0;   ///< RMS shift, at the board, of what the old calibration makes of the new picture
  double drift_deg = 0;  ///< turn of the same about the plane's normal
  double rms_px = 0;     ///< of the board's pose in the new picture
  Drift verdict = Drift::reject;
  std::string why;
  BoardView view;                            ///< numbered as the reference is
  std::vector<Eigen::Vector2d> residual_px;  ///< seen now minus expected
};

/// Bounds of ok, and of the picture's error beyond which the picture says nothing.
constexpr double kDriftOkMm = 0.5, kDriftOkDeg = 0.1, kDriftPicturePx = 1.5;

/// The board must lie in its reference place (plane.T_camera_board). ok up to 0.5 mm and 0.1 deg; reject when the
/// picture does not fit the lens (over 1.5 px), for then it says nothing. Errors: negative: no pose; unreadable: the
/// plane has no reference.
[[nodiscard]] core::Result<VerifyResult> verify(const Lens& lens, const PlaneCalibration& plane, const Board& board,
                                                const BoardView& view);

}  // namespace pickcell::poses
