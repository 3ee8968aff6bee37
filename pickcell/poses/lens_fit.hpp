#pragma once
/// One least-squares fit of a lens to views of a board, by OpenCV's calibrateCamera. Built with
/// PICKCELL_WITH_CALIBRATION only.

#include <array>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/poses/camera_calibration.hpp"

namespace pickcell::poses {

enum class LensModel { pinhole, k1k2, brown5, rational };
constexpr std::array<LensModel, 4> kLensModels{LensModel::pinhole, LensModel::k1k2, LensModel::brown5,
                                               LensModel::rational};
[[nodiscard]] const char* name(LensModel model);

struct LensFit {
  Lens lens;
  LensSigma sigma;
  double rms_px = 0;
  std::vector<CameraView> views;  ///< in the order given
};

/// Errors: negative, when the numbers do not converge to a camera.
[[nodiscard]] core::Result<LensFit> fit_lens(const Board& board, const std::vector<NamedView>& views, LensModel model);

}  // namespace pickcell::poses
