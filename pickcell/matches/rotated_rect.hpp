#pragma once
/// Rectangles at any angle, and how much two of them share.

#include <array>

namespace pickcell::matches {

/// Corners in order around the rectangle (either sense), pixels.
struct RotatedRect {
  std::array<std::array<double, 2>, 4> corner;
};

[[nodiscard]] double area(const RotatedRect& r);
[[nodiscard]] double intersection_area(const RotatedRect& a, const RotatedRect& b);
/// Intersection over the smaller area, 0..1.
[[nodiscard]] double overlap(const RotatedRect& a, const RotatedRect& b);

}  // namespace pickcell::matches
