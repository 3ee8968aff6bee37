#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "pickcell/poses/board_detect_parts.hpp"

namespace pickcell::poses::detail {

namespace {

constexpr int kFindSidePx =
    1400;  ///< larger pictures are searched at this size first: quicker, and less of their noise

/// Distance to the nearest neighbour in the grid, the smallest over the board.
double smallest_square_px(const Board& board, const CvPoints& corners) {
  const int cols = board.point_cols(), rows = board.point_rows();
  double least = std::numeric_limits<double>::max();
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col) {
      const auto at = [&](int c, int r) { return corners[static_cast<std::size_t>(r * cols + c)]; };
      if (col + 1 < cols) least = std::min(least, cv::norm(at(col + 1, row) - at(col, row)));
      if (row + 1 < rows) least = std::min(least, cv::norm(at(col, row + 1) - at(col, row)));
    }
  return least;
}

bool find_in(const cv::Mat& grey, const Board& board, CvPoints& corners) {
  const cv::Size size(board.cols, board.rows);
  if (cv::findChessboardCorners(grey, size, corners, cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE))
    return true;
  return cv::findChessboardCornersSB(grey, size, corners, cv::CALIB_CB_NORMALIZE_IMAGE);
}

double sample(const cv::Mat& grey, const cv::Point2d& p) {
  const int x = static_cast<int>(std::lround(p.x)), y = static_cast<int>(std::lround(p.y));
  if (x < 0 || y < 0 || x >= grey.cols || y >= grey.rows) return -1;
  return grey.at<std::uint8_t>(y, x);
}

/// Board coordinates in squares, corner 0 at the origin, to pixels.
class Grid {
 public:
  Grid(const Board& board, const CvPoints& corners) {
    CvPoints nominal;
    for (int row = 0; row < board.point_rows(); ++row)
      for (int col = 0; col < board.point_cols(); ++col) nominal.emplace_back(col, row);
    H_ = cv::findHomography(nominal, corners, 0);
  }
  [[nodiscard]] cv::Point2d operator()(double x, double y) const {
    const cv::Vec3d p = H_ * cv::Vec3d(x, y, 1);
    return {p[0] / p[2], p[1] / p[2]};
  }

 private:
  cv::Matx33d H_;
};

/// Contrast of the saddle at a grid point: positive and negative squares alternate around it. 0 where it is none, or
/// out of the picture.
double saddle(const cv::Mat& grey, const Grid& grid, double x, double y) {
  constexpr double kStep = 0.3;
  const double a = sample(grey, grid(x - kStep, y - kStep)), b = sample(grey, grid(x + kStep, y - kStep));
  const double c = sample(grey, grid(x - kStep, y + kStep)), d = sample(grey, grid(x + kStep, y + kStep));
  if (a < 0 || b < 0 || c < 0 || d < 0) return 0;
  const double first = std::min(a - b, d - c), second = std::min(b - a, c - d);
  return std::max({first, second, 0.0});
}

double mean_saddle(const cv::Mat& grey, const Grid& grid, double x0, double y0, double dx, double dy, int n) {
  double sum = 0;
  for (int i = 0; i < n; ++i) sum += saddle(grey, grid, x0 + i * dx, y0 + i * dy);
  return sum / n;
}

}  // namespace

CvPoints find_chessboard(const cv::Mat& grey, const Board& board) {
  CvPoints corners;
  const int side = std::max(grey.cols, grey.rows);
  if (side > kFindSidePx) {
    const double factor = static_cast<double>(kFindSidePx) / side;
    cv::Mat small;
    cv::resize(grey, small, {}, factor, factor, cv::INTER_AREA);
    if (find_in(small, board, corners)) {
      for (auto& p : corners)
        p = {static_cast<float>((p.x + 0.5) / factor - 0.5), static_cast<float>((p.y + 0.5) / factor - 0.5)};
      return corners;
    }
  }
  if (!find_in(grey, board, corners)) corners.clear();
  return corners;
}

void refine_corners(const cv::Mat& grey, const Board& board, CvPoints& corners) {
  const double square = smallest_square_px(board, corners);
  const int half = std::clamp(static_cast<int>(std::lround(square * 0.3)), 2, 15);
  const cv::TermCriteria until(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 60, 1e-3);
  cv::cornerSubPix(grey, corners, {half, half}, {-1, -1}, until);
}

void turn_to_black_corner(const cv::Mat& grey, const Board& board, CvPoints& corners) {
  const int cols = board.point_cols(), rows = board.point_rows();
  const bool half_turn_tells = (cols + rows) % 2 == 1;
  const bool quarter_turn_tells = cols == rows && cols % 2 == 1;
  if (!half_turn_tells && !quarter_turn_tells) return;
  const Grid grid(board, corners);
  double dark_minus_light = 0;  // squares whose column and row have an even sum are black when corner 0 lies at one
  for (int row = 0; row + 1 < rows; ++row)
    for (int col = 0; col + 1 < cols; ++col)
      dark_minus_light += ((col + row) % 2 == 0 ? 1 : -1) * sample(grey, grid(col + 0.5, row + 0.5));
  if (dark_minus_light < 0) return;
  if (half_turn_tells) {
    std::reverse(corners.begin(), corners.end());
    return;
  }
  CvPoints turned(corners.size());
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col)
      turned[static_cast<std::size_t>(col * cols + (cols - 1 - row))] =
          corners[static_cast<std::size_t>(row * cols + col)];
  corners = std::move(turned);
}

std::string larger_board(const cv::Mat& grey, const Board& board, const CvPoints& corners) {
  const int cols = board.point_cols(), rows = board.point_rows();
  const Grid grid(board, corners);
  double inside = 0;
  for (int row = 0; row < rows; ++row) inside += mean_saddle(grey, grid, 0, row, 1, 0, cols) / rows;
  const double needed = 0.5 * inside;
  const bool column =
      mean_saddle(grey, grid, -1, 0, 0, 1, rows) > needed || mean_saddle(grey, grid, cols, 0, 0, 1, rows) > needed;
  const bool row =
      mean_saddle(grey, grid, 0, -1, 1, 0, cols) > needed || mean_saddle(grey, grid, 0, rows, 1, 0, cols) > needed;
  if (!column && !row) return {};
  return std::string("the board has more ") + (column ? (row ? "columns and rows" : "columns") : "rows") + " than " +
         board.text + " says";
}

}  // namespace pickcell::poses::detail
