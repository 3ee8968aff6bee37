#pragma once
/// Boards in picture files: what all modes of calibrate begin with.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pickcell/core/json.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/poses/camera_calibration.hpp"

namespace pickcell::cli {

/// A picture file and the board in it.
struct BoardPicture {
  std::filesystem::path path;
  std::string name;  ///< for reports: the path as given
  int width_px = 0, height_px = 0;
  core::Result<poses::BoardView> view;
};

/// Reads the pictures and looks for the board, on all cores, in the order given. Errors: the first picture that cannot
/// be read; a dictionary that is none. A picture without a board is no error.
[[nodiscard]] core::Result<std::vector<BoardPicture>> find_boards(const std::vector<std::filesystem::path>& paths,
                                                                  const poses::Board& board);

/// Why no board was found in any of the pictures (at least one), as one error of kind negative: what is seen instead.
[[nodiscard]] core::Error no_board(const std::vector<BoardPicture>& pictures, const poses::Board& board);

/// `[{"image", "reason"}]`
[[nodiscard]] core::Json left_out_json(const std::vector<poses::LeftOut>& left_out);

/// Now in ISO 8601.
[[nodiscard]] std::string today();

/// A 4x4 matrix, row by row.
[[nodiscard]] core::Json matrix_json(const Eigen::Matrix4d& matrix);

/// With --json: a line with verdict "reject" and the reason for programs; then hands the error on for people.
[[nodiscard]] core::Error rejected(core::Error error, bool json, std::ostream& out);

}  // namespace pickcell::cli
