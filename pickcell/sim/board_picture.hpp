#pragma once
/// Pictures of calibration boards through the simulated camera, for calibrations whose truth is known.

#include <cstdint>
#include <string>
#include <vector>

#include "pickcell/core/transform.hpp"
#include "pickcell/image/image.hpp"
#include "pickcell/sim/camera_model.hpp"

namespace pickcell::sim {

/// A chessboard or ChArUco board by its inner corners, a symmetric grid of dots, or a staggered one: every second row
/// shifted by one spacing, its dots two apart. Board frame: origin in the first corner or dot, x along a row, y to the
/// next row, z into the board; the chessboard's corner 0 lies at a black corner square.
struct BoardPattern {
  enum class Kind { chessboard, dots, staggered_dots, charuco } kind = Kind::chessboard;
  int cols = 9, rows = 6;
  double spacing_m = 0.025;
  double dot_radius_m = 0.008;  ///< of dots
  double marker_m = 0;          ///< of ChArUco
  /// Of ChArUco: what is in the white squares, row by row from the upper left; each a square of '0' (black) and '1'.
  std::vector<std::string> markers{};
};

struct BoardPictureSettings {
  double blur_px = 0.6;
  double noise_grey = 1;
  std::uint64_t seed = 1;
};

/// The board on a grey ground, 4x4 samples per pixel. Deterministic.
[[nodiscard]] image::Image board_picture(const Intrinsics& camera, const BoardPattern& pattern,
                                         const core::Transform<core::Camera, core::Board>& T_camera_board,
                                         const BoardPictureSettings& settings);

}  // namespace pickcell::sim
