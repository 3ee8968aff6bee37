#include "pickcell/matches/rst/lut.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace pickcell::matches {
namespace {

bool in_row_order(const PixelOffset& a, const PixelOffset& b) { return a.dy != b.dy ? a.dy < b.dy : a.dx < b.dx; }

/// A quarter turn counter-clockwise on the screen (y down).
PixelOffset quarter_turn(const PixelOffset& p) { return {p.dy, -p.dx}; }

std::vector<PixelOffset> bresenham(int x1, int y1) {
  std::vector<PixelOffset> out;
  const int dx = std::abs(x1), dy = -std::abs(y1);
  const int sx = x1 > 0 ? 1 : -1, sy = y1 > 0 ? 1 : -1;
  int error = dx + dy;
  for (int x = 0, y = 0;;) {
    out.push_back({x, y});
    if (x == x1 && y == y1) return out;
    const int twice = 2 * error;
    if (twice >= dy) {
      error += dy;
      x += sx;
    }
    if (twice <= dx) {
      error += dx;
      y += sy;
    }
  }
}

}  // namespace

void PixelLists::add(const std::vector<PixelOffset>& list) {
  const auto added = pixels.insert(pixels.end(), list.begin(), list.end());
  std::sort(added, pixels.end(), in_row_order);
  start.push_back(static_cast<int>(pixels.size()));
}

OffsetLists offsets_for(const PixelLists& lists, std::ptrdiff_t stride) {
  OffsetLists out;
  out.offsets.reserve(lists.pixels.size());
  for (int k = 0; k < lists.lists(); ++k) {
    const auto from = lists.pixels.begin() + lists.start[static_cast<std::size_t>(k)];
    const auto to = lists.pixels.begin() + lists.start[static_cast<std::size_t>(k) + 1];
    for (auto p = from; p != to; ++p) out.offsets.push_back(static_cast<std::int32_t>(p->dy * stride + p->dx));
    out.start.push_back(static_cast<int>(out.offsets.size()));
    out.inverse_length.push_back(1.0f / static_cast<float>(to - from));
  }
  return out;
}

std::vector<int> circle_radii(int r_max, int count) {
  std::vector<int> out;
  for (int k = 0; k < count; ++k) {
    const int r = static_cast<int>(std::lround(static_cast<double>(k) * r_max / (count - 1)));
    if (out.empty() || out.back() != r) out.push_back(r);
  }
  return out;
}

std::vector<PixelOffset> circle_pixels(int radius) {
  std::vector<PixelOffset> out;
  int x = radius, y = 0, d = 1 - radius;
  while (x >= y) {
    for (const PixelOffset& octant : {PixelOffset{x, y}, PixelOffset{y, x}, PixelOffset{x, -y}, PixelOffset{y, -x},
                                      PixelOffset{-x, y}, PixelOffset{-y, x}, PixelOffset{-x, -y}, PixelOffset{-y, -x}})
      out.push_back(octant);
    ++y;
    if (d < 0) {
      d += 2 * y + 1;
    } else {
      --x;
      d += 2 * (y - x) + 1;
    }
  }
  std::sort(out.begin(), out.end(), in_row_order);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::vector<PixelOffset> line_pixels(double angle_deg, int length) {
  double rest = std::fmod(angle_deg, 360.0);
  if (rest < 0) rest += 360;
  const int quarters = static_cast<int>(rest / 90);
  const double a = (rest - 90 * quarters) * std::numbers::pi / 180;
  std::vector<PixelOffset> out = bresenham(static_cast<int>(std::lround(length * std::cos(a))),
                                           static_cast<int>(-std::lround(length * std::sin(a))));
  for (PixelOffset& p : out)
    for (int i = 0; i < quarters; ++i) p = quarter_turn(p);
  return out;
}

PixelLists circle_lists(const std::vector<int>& radii) {
  PixelLists out;
  for (const int r : radii) out.add(circle_pixels(r));
  return out;
}

PixelLists line_lists(int count, int length) {
  PixelLists out;
  for (int j = 0; j < count; ++j) out.add(line_pixels(j * 360.0 / count, length));
  return out;
}

}  // namespace pickcell::matches
