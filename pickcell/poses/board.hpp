#pragma once
/// Calibration boards: what is printed on them and where. The BOARD argument of docs/interfaces.md.

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "pickcell/core/result.hpp"

namespace pickcell::poses {

enum class BoardKind { chessboard, circles, asymmetric_circles, charuco };

/// A flat board. Its points (inner corners, centres of circles) are numbered row by row: index = row * point_cols() +
/// col. Board frame: origin in point 0, x along a row, y towards the next row, z into the board (right-handed when x
/// points right and y down for somebody who looks at the print). Point 0 of a chessboard or ChArUco board is the inner
/// corner next to a black corner square (ChArUco: next to the square left above marker 0 and 1, as OpenCV numbers
/// them).
struct Board {
  BoardKind kind = BoardKind::chessboard;
  int cols = 0;            ///< as given: inner corners, circles, or squares of a ChArUco board
  int rows = 0;            ///< as given
  double spacing_m = 0;    ///< side of a square, distance of circles (asymmetric: between a row and the next)
  double marker_m = 0;     ///< side of a ChArUco marker
  std::string dictionary;  ///< OpenCV's name without DICT_: "6X6_250"
  std::string text;        ///< as it was given

  [[nodiscard]] int point_cols() const { return kind == BoardKind::charuco ? cols - 1 : cols; }
  [[nodiscard]] int point_rows() const { return kind == BoardKind::charuco ? rows - 1 : rows; }
  [[nodiscard]] int points() const { return point_cols() * point_rows(); }
};

/// `chessboard:9x6:25mm`, `circles:10x10:25.4mm`, `acircles:4x11:20mm`, `charuco:5x7:36.195mm:18.256mm:6X6_250`.
/// Errors: usage, naming what is wrong and the form.
[[nodiscard]] core::Result<Board> parse_board(std::string_view text);

/// The nominal places of all points in the board's plane, metres.
[[nodiscard]] std::vector<Eigen::Vector2d> board_points_m(const Board& board);

/// The turns of the board that cannot be told from it by its print: for each the new index of every point. The first is
/// the identity. A symmetric grid of circles has 2, a square one 4; a chessboard has 1 when one of its numbers of inner
/// corners is odd and the other even.
[[nodiscard]] std::vector<std::vector<int>> board_symmetries(const Board& board);

/// What a picture shows of a board.
struct BoardView {
  std::vector<int> ids;                 ///< indices of points, ascending
  std::vector<Eigen::Vector2d> pixels;  ///< their places, pixel centres at integers
  int width_px = 0, height_px = 0;      ///< of the picture
};

/// The view with every point renumbered by one of board_symmetries.
[[nodiscard]] BoardView renumbered(const BoardView& view, const std::vector<int>& new_index);

}  // namespace pickcell::poses
