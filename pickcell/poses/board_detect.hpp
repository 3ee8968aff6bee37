#pragma once
/// Finds a calibration board in a picture: built with PICKCELL_WITH_CALIBRATION only.

#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/image/image.hpp"
#include "pickcell/poses/board.hpp"

namespace pickcell::poses {

/// The points of the board, to a fraction of a pixel. The window of the corner search follows the size of the squares
/// in the picture. Chessboards and grids of circles must be seen whole; a ChArUco board may be covered in part (at
/// least 6 corners). Numbering is right-handed (Board) and canonical up to board_symmetries. Thread-safe. Errors:
/// negative, `name` and why: no board, a larger board than stated, the mirrored board. Usage: the dictionary is unknown
/// or has too few markers.
[[nodiscard]] core::Result<BoardView> detect_board(image::ImageView picture, const Board& board,
                                                   const std::string& name);

/// For a picture in which detect_board found nothing: what is there instead ("it shows a chessboard of 9x6 inner
/// corners"), or "". Slow.
[[nodiscard]] std::string what_else_is_seen(image::ImageView picture, const Board& board);

/// What the markers of a ChArUco board look like, in the order of its white squares: each a square of '0' (black) and
/// '1' without the black border. Errors: usage: no such dictionary, or one with too few markers.
[[nodiscard]] core::Result<std::vector<std::string>> marker_bits(const Board& board);

}  // namespace pickcell::poses
