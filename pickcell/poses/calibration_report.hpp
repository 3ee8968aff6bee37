#pragma once
/// What a person looks at before trusting a calibration: one HTML file that needs nothing else. Built with
/// PICKCELL_WITH_CALIBRATION only.

#include <filesystem>

#include "pickcell/core/result.hpp"
#include "pickcell/poses/board.hpp"
#include "pickcell/poses/camera_calibration.hpp"
#include "pickcell/poses/handeye.hpp"
#include "pickcell/poses/plane_calibration.hpp"
#include "pickcell/poses/verify.hpp"

namespace pickcell::poses {

/// Verdict, figures, coverage map, histogram of residuals, table of pictures, each used picture with its corners and
/// enlarged residuals. The pictures are read again from their paths (CameraView::image). Errors: unreadable.
[[nodiscard]] core::Status write_camera_report(const std::filesystem::path& path, const Board& board,
                                               const CameraFit& fit);
[[nodiscard]] core::Status write_handeye_report(const std::filesystem::path& path, const Board& board,
                                                const HandeyeFit& fit);

/// Every touched point with its error; its arrow points from where the result expects it to where it was seen. image:
/// the board's picture, "" for touched points alone.
[[nodiscard]] core::Status write_plane_report(const std::filesystem::path& path, const std::string& image,
                                              const Lens& lens, const PlaneFit& fit);
/// The board as it is seen now, with arrows from where the calibration expects it.
[[nodiscard]] core::Status write_verify_report(const std::filesystem::path& path, const std::string& image,
                                               const VerifyResult& result);

}  // namespace pickcell::poses
