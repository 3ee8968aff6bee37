#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "pickcell/poses/board_detect_parts.hpp"

namespace pickcell::poses::detail {

namespace {

/// Blobs of one colour between two areas; thresholds close together, because a centre is the mean over them.
cv::Ptr<cv::Feature2D> blobs(std::uint8_t colour, double min_area_px, double max_area_px, float roundness) {
  cv::SimpleBlobDetector::Params p;
  p.minThreshold = 20;
  p.maxThreshold = 230;
  p.thresholdStep = 10;
  p.minRepeatability = 3;
  p.minDistBetweenBlobs = static_cast<float>(std::max(4.0, std::sqrt(min_area_px)));
  p.filterByColor = true;
  p.blobColor = colour;
  p.filterByArea = true;
  p.minArea = static_cast<float>(min_area_px);
  p.maxArea = static_cast<float>(max_area_px);
  p.filterByConvexity = true;
  p.minConvexity = roundness;
  p.filterByInertia = true;
  p.minInertiaRatio = 0.1f;
  p.filterByCircularity = false;
  return cv::SimpleBlobDetector::create(p);
}

bool find_with(const cv::Mat& grey, const Board& board, const cv::Ptr<cv::Feature2D>& detector, CvPoints& centres) {
  const int grid = board.kind == BoardKind::circles ? cv::CALIB_CB_SYMMETRIC_GRID : cv::CALIB_CB_ASYMMETRIC_GRID;
  for (const int how : {0, int{cv::CALIB_CB_CLUSTERING}}) {
    try {
      if (cv::findCirclesGrid(grey, {board.cols, board.rows}, centres, grid | how, detector)) return true;
    } catch (const cv::Exception&) {
      // 4.6 throws instead of saying no for some sets of blobs that are far from a grid.
    }
  }
  return false;
}

bool find_at(const cv::Mat& grey, const Board& board, CvPoints& centres) {
  // A circle is at most the share of the picture that its place in a board that fills it takes.
  const double pixels = static_cast<double>(grey.cols) * grey.rows;
  const double largest = std::max(5000.0, pixels / board.points());
  for (const float roundness : {0.92f, 0.8f})
    for (const std::uint8_t colour : {std::uint8_t{0}, std::uint8_t{255}})
      for (const double smallest : {25.0, 10.0})
        if (find_with(grey, board, blobs(colour, smallest, largest, roundness), centres)) return true;
  return false;
}

}  // namespace

CvPoints find_circles(const cv::Mat& grey, const Board& board) {
  CvPoints centres;
  if (find_at(grey, board, centres)) return centres;
  // Coarse structure only: smoothed, and at half the size.
  cv::Mat half;
  cv::resize(grey, half, {}, 0.5, 0.5, cv::INTER_AREA);
  if (!find_at(half, board, centres)) return {};
  for (auto& p : centres) p = {2 * p.x + 0.5f, 2 * p.y + 0.5f};
  return centres;
}

}  // namespace pickcell::poses::detail
