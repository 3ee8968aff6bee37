#include "pickcell/poses/view_coverage.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pickcell/core/units.hpp"
#include "pickcell/poses/verdicts.hpp"

namespace pickcell::poses {

namespace {

constexpr int kCols = 48, kRows = 36;
using Map = std::array<std::array<bool, kCols>, kRows>;
using Polygon = std::vector<Eigen::Vector2d>;

/// Convex hull by Andrew's monotone chain.
Polygon hull(Polygon points) {
  std::sort(points.begin(), points.end(),
            [](const auto& a, const auto& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
  const auto turn = [](const Eigen::Vector2d& o, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
  };
  Polygon out;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t begin = out.size();
    for (const auto& p : points) {
      while (out.size() >= begin + 2 && turn(out[out.size() - 2], out.back(), p) <= 0) out.pop_back();
      out.push_back(p);
    }
    out.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return out;
}

bool inside(const Polygon& convex, const Eigen::Vector2d& p) {
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Eigen::Vector2d a = convex[i], b = convex[(i + 1) % convex.size()];
    if ((b.x() - a.x()) * (p.y() - a.y()) - (b.y() - a.y()) * (p.x() - a.x()) < 0) return false;
  }
  return convex.size() >= 3;
}

void mark(Map& map, const BoardView& view) {
  const Polygon outline = hull(view.pixels);
  for (int r = 0; r < kRows; ++r)
    for (int c = 0; c < kCols; ++c) {
      const Eigen::Vector2d cell((c + 0.5) / kCols * view.width_px - 0.5, (r + 0.5) / kRows * view.height_px - 0.5);
      map[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] |= inside(outline, cell);
    }
}

double share(const Map& map, int c0, int c1, int r0, int r1) {
  int marked = 0;
  for (int r = r0; r < r1; ++r)
    for (int c = c0; c < c1; ++c) marked += map[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] ? 1 : 0;
  return static_cast<double>(marked) / ((c1 - c0) * (r1 - r0));
}

std::vector<std::string> empty_parts(const Map& map) {
  constexpr std::array<const char*, 9> kNames{"upper left", "top",        "upper right", "left",       "middle",
                                              "right",      "lower left", "bottom",      "lower right"};
  constexpr double kEnough = 0.1;
  std::vector<std::string> out;
  for (int part = 0; part < 9; ++part) {
    const int c = part % 3 * kCols / 3, r = part / 3 * kRows / 3;
    if (share(map, c, c + kCols / 3, r, r + kRows / 3) < kEnough)
      out.push_back(std::string("no view covers the ") + kNames[static_cast<std::size_t>(part)] + ": add one there");
  }
  return out;
}

}  // namespace

ViewCoverage view_coverage(const std::vector<CameraView>& views) {
  ViewCoverage out;
  Map map{};
  for (const CameraView& v : views) {
    mark(map, v.view);
    out.largest_tilt_deg = std::max(out.largest_tilt_deg, v.tilt_deg);
    for (const CameraView& other : views) {
      const double c = v.T_camera_board.rotation().col(2).dot(other.T_camera_board.rotation().col(2));
      out.tilt_range_deg = std::max(out.tilt_range_deg, core::deg_from_rad(std::acos(std::clamp(c, -1.0, 1.0))));
    }
  }
  out.area = share(map, 0, kCols, 0, kRows);
  out.advice = empty_parts(map);
  if (out.largest_tilt_deg < 10)
    out.advice.insert(out.advice.begin(),
                      "all views are parallel to the sensor: add some with the board inclined by 20 to 40 degrees");
  else if (out.tilt_range_deg < 20)
    out.advice.insert(out.advice.begin(), "all views show the board inclined alike (within " +
                                              figure(out.tilt_range_deg, 0) +
                                              " degrees): incline it in other directions by 20 to 40 degrees");
  return out;
}

std::vector<Eigen::Vector2d> outline(const BoardView& view) {
  return view.pixels.size() < 3 ? view.pixels : hull(view.pixels);
}

}  // namespace pickcell::poses
