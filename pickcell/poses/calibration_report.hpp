#pragma once
/// What a person looks at before trusting a calibration: one HTML file that needs nothing else. Built with
/// PICKCELL_WITH_CALIBRATION only.

#include <filesystem>

#include "pickcell/core/result.hpp"
#include "pickcell/poses/board.hpp"
#include "pickcell/poses/camera_calibration.hpp"
#include "pickcell/poses/handeye.hpp"

namespace pickcell::poses {

/// Verdict, figures, coverage map, histogram of residuals, table of pictures, each used picture with its corners and
/// enlarged residuals. The pictures are read again from their paths (CameraView::image). Errors: unreadable.
[[nodiscard]] core::Status write_camera_report(const std::filesystem::path& path, const Board& board,
                                               const CameraFit& fit);
[[nodiscard]] core::Status write_handeye_report(const std::filesystem::path& path, const Board& board,
                                                const HandeyeFit& fit);

}  // namespace pickcell::poses
