#pragma once
/// The pieces of board detection, for board_detect.cpp only. Their pictures are OpenCV's, declared by name, because no
/// header of the house shows another library's types.

#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/image/image.hpp"
#include "pickcell/poses/board.hpp"

namespace cv {
class Mat;
template <typename T>
class Point_;
}  // namespace cv

namespace pickcell::poses::detail {

using CvPoints = std::vector<cv::Point_<float>>;

/// Inner corners, to about a pixel, row by row; empty when there is no such board.
[[nodiscard]] CvPoints find_chessboard(const cv::Mat& grey, const Board& board);
/// Moves corners to where the gradients meet; the window is a third of the smallest square in the picture.
void refine_corners(const cv::Mat& grey, const Board& board, CvPoints& corners);
/// Turns the numbering so that corner 0 lies at a black corner square, where the board allows it.
void turn_to_black_corner(const cv::Mat& grey, const Board& board, CvPoints& corners);
/// Where the pattern goes on beyond the stated corners, in words; "" when it does not.
[[nodiscard]] std::string larger_board(const cv::Mat& grey, const Board& board, const CvPoints& corners);

/// Centres of circles, dark on light or light on dark; empty when there is no such grid.
[[nodiscard]] CvPoints find_circles(const cv::Mat& grey, const Board& board);

[[nodiscard]] core::Result<BoardView> detect_charuco(image::ImageView picture, const Board& board,
                                                     const std::string& name);

}  // namespace pickcell::poses::detail
