#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "pickcell/poses/aruco_dictionary.hpp"
#include "pickcell/poses/board_detect.hpp"
#include "pickcell/poses/board_detect_parts.hpp"

namespace pickcell::poses::detail {

namespace {

using core::ErrorCode;
using core::failure;

constexpr std::size_t kFewestCorners = 6;

struct Markers {
  std::vector<int> ids;
  std::vector<CvPoints> corners;  ///< clockwise from the marker's upper left
};

/// Which squares carry markers, in their order. OpenCV changed it for boards with an even number of rows: first_row_odd
/// means that the first marker is in the second square of the first row.
std::map<int, cv::Point> marker_squares(const Board& board, bool first_row_odd) {
  std::map<int, cv::Point> out;
  for (int y = 0; y < board.rows; ++y)
    for (int x = 0; x < board.cols; ++x)
      if (((x + y) % 2 == 1) == first_row_odd) out.emplace(static_cast<int>(out.size()), cv::Point(x, y));
  return out;
}

/// Corners of the marker in a square, board frame in squares with point 0 (the first inner corner) at the origin.
CvPoints marker_corners(const Board& board, cv::Point square) {
  const float m = static_cast<float>(board.marker_m / board.spacing_m), inset = (1 - m) / 2;
  const float x = static_cast<float>(square.x) - 1 + inset, y = static_cast<float>(square.y) - 1 + inset;
  return {{x, y}, {x + m, y}, {x + m, y + m}, {x, y + m}};
}

core::Result<cv::Ptr<cv::aruco::Dictionary>> dictionary_of(const Board& board) {
  const auto number = aruco_dictionary(board.dictionary);
  if (!number)
    return failure(ErrorCode::usage, board.text, "'" + board.dictionary + "' is no dictionary",
                   "use an OpenCV name like 4X4_50, 5X5_100, 6X6_250, ARUCO_ORIGINAL, APRILTAG_36h11");
  cv::Ptr<cv::aruco::Dictionary> dictionary = cv::aruco::getPredefinedDictionary(*number);
  if (dictionary->bytesList.rows < board.cols * board.rows / 2)
    return failure(ErrorCode::usage, board.text, "the dictionary has fewer markers than the board",
                   "look at the print again");
  return dictionary;
}

Markers find_markers(const cv::Mat& grey, const cv::Ptr<cv::aruco::Dictionary>& dictionary) {
  auto settings = cv::aruco::DetectorParameters::create();
  settings->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  settings->cornerRefinementWinSize = 3;
  settings->adaptiveThreshWinSizeMax = std::clamp(std::max(grey.cols, grey.rows) / 25, 23, 103) | 1;
  Markers out;
  cv::aruco::detectMarkers(grey, dictionary, out.corners, out.ids, settings);
  return out;
}

struct Layout {
  std::map<int, cv::Point> squares;
  std::vector<std::size_t> fitting;  ///< indices of markers that agree with one plane
};

/// The markers that fit the layout as one plane (loosely: the lens bends it).
Layout fit_layout(const Board& board, const Markers& markers, bool first_row_odd) {
  Layout out{marker_squares(board, first_row_odd), {}};
  CvPoints from, to;
  std::vector<std::size_t> owner;
  for (std::size_t i = 0; i < markers.ids.size(); ++i) {
    const auto square = out.squares.find(markers.ids[i]);
    if (square == out.squares.end()) continue;
    const CvPoints nominal = marker_corners(board, square->second);
    from.insert(from.end(), nominal.begin(), nominal.end());
    to.insert(to.end(), markers.corners[i].begin(), markers.corners[i].end());
    owner.insert(owner.end(), 4, i);
  }
  if (owner.empty()) return out;
  if (owner.size() == 4) {
    out.fitting = {owner.front()};
    return out;
  }
  const double square_px = cv::norm(to[0] - to[1]) * board.spacing_m / board.marker_m;
  cv::Mat inliers;
  const cv::Mat H = cv::findHomography(from, to, cv::RANSAC, std::max(3.0, 0.25 * square_px), inliers);
  if (H.empty()) return out;
  for (std::size_t i = 0; i < owner.size(); i += 4) {
    int agree = 0;
    for (std::size_t k = 0; k < 4; ++k) agree += inliers.at<std::uint8_t>(static_cast<int>(i + k)) ? 1 : 0;
    if (agree == 4) out.fitting.push_back(owner[i]);
  }
  return out;
}

/// Place of an inner corner from the markers next to it: markers of the squares that touch it at a point.
std::optional<cv::Point2f> from_neighbours(const Board& board, const Markers& markers, const Layout& layout, int col,
                                           int row) {
  CvPoints from, to;
  for (const std::size_t i : layout.fitting) {
    const cv::Point square = layout.squares.at(markers.ids[i]);
    if (square.x < col || square.x > col + 1 || square.y < row || square.y > row + 1) continue;
    const CvPoints nominal = marker_corners(board, square);
    from.insert(from.end(), nominal.begin(), nominal.end());
    to.insert(to.end(), markers.corners[i].begin(), markers.corners[i].end());
  }
  if (from.empty()) return std::nullopt;
  const cv::Mat H = cv::findHomography(from, to, 0);
  if (H.empty()) return std::nullopt;
  CvPoints place;
  cv::perspectiveTransform(CvPoints{{static_cast<float>(col), static_cast<float>(row)}}, place, H);
  return place[0];
}

/// Half the window for the corner search: a third of the local square, and clear of the markers' own edges.
int half_window(const Board& board, const Markers& markers, const Layout& layout) {
  double side = 1e9;
  for (const std::size_t i : layout.fitting)
    for (std::size_t k = 0; k < 4; ++k)
      side = std::min(side, cv::norm(markers.corners[i][k] - markers.corners[i][(k + 1) % 4]));
  const double square = side * board.spacing_m / board.marker_m;
  const double clear = square * (1 - board.marker_m / board.spacing_m) / 2;
  return std::clamp(static_cast<int>(std::lround(std::min(0.3 * square, 0.9 * clear))), 2, 15);
}

BoardView corners_of(const cv::Mat& grey, const Board& board, const Markers& markers, const Layout& layout) {
  BoardView view;
  view.width_px = grey.cols;
  view.height_px = grey.rows;
  const int half = half_window(board, markers, layout);
  CvPoints guesses;
  for (int row = 0; row < board.point_rows(); ++row)
    for (int col = 0; col < board.point_cols(); ++col) {
      const auto guess = from_neighbours(board, markers, layout, col, row);
      const float margin = static_cast<float>(half + 2);
      if (!guess || guess->x < margin || guess->y < margin || guess->x > static_cast<float>(grey.cols - 1) - margin ||
          guess->y > static_cast<float>(grey.rows - 1) - margin)
        continue;
      view.ids.push_back(row * board.point_cols() + col);
      guesses.push_back(*guess);
    }
  if (guesses.empty()) return view;
  CvPoints refined = guesses;
  cv::cornerSubPix(grey, refined, {half, half}, {-1, -1}, {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 60, 1e-3});
  std::vector<int> kept;
  for (std::size_t i = 0; i < refined.size(); ++i) {
    if (cv::norm(refined[i] - guesses[i]) > half) continue;
    kept.push_back(view.ids[i]);
    view.pixels.emplace_back(refined[i].x, refined[i].y);
  }
  view.ids = std::move(kept);
  return view;
}

}  // namespace

core::Result<BoardView> detect_charuco(image::ImageView picture, const Board& board, const std::string& name) {
  const auto known = dictionary_of(board);
  if (!known) return tl::unexpected(known.error());
  const cv::Ptr<cv::aruco::Dictionary>& dictionary = *known;
  const cv::Mat grey(picture.height(), picture.width(), CV_8U, const_cast<std::uint8_t*>(picture.row(0)),
                     static_cast<std::size_t>(picture.stride()));
  const Markers markers = find_markers(grey, dictionary);
  Layout layout = fit_layout(board, markers, true);
  if (Layout other = fit_layout(board, markers, false); other.fitting.size() > layout.fitting.size())
    layout = std::move(other);
  if (layout.fitting.empty()) {
    cv::Mat mirrored;
    cv::flip(grey, mirrored, 1);
    if (find_markers(mirrored, dictionary).ids.size() >= 3)
      return failure(ErrorCode::negative, name, "the board is mirrored", "switch off mirroring in camera or print");
    return failure(ErrorCode::negative, name, "no marker of " + board.text + " is seen", "show the board, sharp");
  }
  BoardView view = corners_of(grey, board, markers, layout);
  if (view.ids.size() < std::min(kFewestCorners, static_cast<std::size_t>(board.points())))
    return failure(ErrorCode::negative, name,
                   "only " + std::to_string(view.ids.size()) + " corners of " + board.text + " are seen",
                   "show more of the board");
  return view;
}

}  // namespace pickcell::poses::detail

namespace pickcell::poses {

core::Result<std::vector<std::string>> marker_bits(const Board& board) {
  const auto dictionary = detail::dictionary_of(board);
  if (!dictionary) return tl::unexpected(dictionary.error());
  std::vector<std::string> out;
  for (int id = 0; id < board.cols * board.rows / 2; ++id) {
    const cv::Mat bits = cv::aruco::Dictionary::getBitsFromByteList((*dictionary)->bytesList.rowRange(id, id + 1),
                                                                    (*dictionary)->markerSize);
    out.emplace_back();
    for (int i = 0; i < static_cast<int>(bits.total()); ++i) out.back() += bits.data[i] ? '1' : '0';
  }
  return out;
}

}  // namespace pickcell::poses
