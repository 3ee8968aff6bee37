#include "pickcell/poses/board_detect.hpp"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "pickcell/poses/board_detect_parts.hpp"

namespace pickcell::poses {

namespace {

using core::ErrorCode;
using core::failure;

/// The same pixels for OpenCV, which only reads them.
cv::Mat wrap(image::ImageView picture) {
  return cv::Mat(picture.height(), picture.width(), CV_8U, const_cast<std::uint8_t*>(picture.row(0)),
                 static_cast<std::size_t>(picture.stride()));
}

bool complete(const std::vector<cv::Point2f>& points, const Board& board) {
  return points.size() == static_cast<std::size_t>(board.points());
}

BoardView as_view(const std::vector<cv::Point2f>& points, image::ImageView picture) {
  BoardView view;
  view.width_px = picture.width();
  view.height_px = picture.height();
  for (std::size_t i = 0; i < points.size(); ++i) {
    view.ids.push_back(static_cast<int>(i));
    view.pixels.emplace_back(points[i].x, points[i].y);
  }
  return view;
}

/// Reverses every row when the rows run so that the numbering is left-handed.
void make_right_handed(std::vector<cv::Point2f>& points, const Board& board) {
  const int cols = board.point_cols(), rows = board.point_rows();
  const auto at = [&](int col, int row) { return points[static_cast<std::size_t>(row * cols + col)]; };
  const cv::Point2f x = at(cols - 1, 0) - at(0, 0), y = at(0, rows - 1) - at(0, 0);
  if (x.cross(y) >= 0) return;
  for (int row = 0; row < rows; ++row) std::reverse(points.begin() + row * cols, points.begin() + (row + 1) * cols);
}

core::Result<BoardView> detect_chessboard(image::ImageView picture, const Board& board, const std::string& name) {
  const cv::Mat grey = wrap(picture);
  std::vector<cv::Point2f> corners = detail::find_chessboard(grey, board);
  if (!complete(corners, board))
    return failure(ErrorCode::negative, name, "no whole " + board.text + " is seen", "show the whole board, sharp");
  make_right_handed(corners, board);
  detail::refine_corners(grey, board, corners);
  detail::turn_to_black_corner(grey, board, corners);
  if (const std::string larger = detail::larger_board(grey, board, corners); !larger.empty())
    return failure(ErrorCode::negative, name, larger, "count the inner corners of the board again");
  return as_view(corners, picture);
}

core::Result<BoardView> detect_circles(image::ImageView picture, const Board& board, const std::string& name) {
  const cv::Mat grey = wrap(picture);
  std::vector<cv::Point2f> centres = detail::find_circles(grey, board);
  if (!complete(centres, board))
    return failure(ErrorCode::negative, name, "no whole " + board.text + " is seen", "show the whole board, sharp");
  if (board.kind == BoardKind::circles) make_right_handed(centres, board);
  return as_view(centres, picture);
}

}  // namespace

core::Result<BoardView> detect_board(image::ImageView picture, const Board& board, const std::string& name) {
  switch (board.kind) {
    case BoardKind::chessboard:
      return detect_chessboard(picture, board, name);
    case BoardKind::circles:
    case BoardKind::asymmetric_circles:
      return detect_circles(picture, board, name);
    case BoardKind::charuco:
      return detail::detect_charuco(picture, board, name);
  }
  throw std::logic_error("kind of board");
}

std::string what_else_is_seen(image::ImageView picture, const Board& board) {
  if (board.kind == BoardKind::charuco) return {};
  std::vector<cv::Point2f> corners;
  cv::Mat meta;
  const double factor = std::min(1.0, 1000.0 / std::max(picture.width(), picture.height()));
  cv::Mat small;
  cv::resize(wrap(picture), small, {}, factor, factor, cv::INTER_AREA);
  if (!cv::findChessboardCornersSB(small, {3, 3}, corners, cv::CALIB_CB_LARGER | cv::CALIB_CB_NORMALIZE_IMAGE, meta))
    return {};
  return "it shows a chessboard of " + std::to_string(meta.cols) + "x" + std::to_string(meta.rows) + " inner corners";
}

}  // namespace pickcell::poses
