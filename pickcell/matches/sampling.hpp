#pragma once
/// Reading a picture between its pixels.

#include <algorithm>
#include <cstdint>

#include "pickcell/image/image.hpp"

namespace pickcell::matches {

/// Whether bilinear() may be called: x in [0, width - 1], y in [0, height - 1].
[[nodiscard]] inline bool inside(image::ImageView p, float x, float y) {
  return x >= 0 && y >= 0 && x <= static_cast<float>(p.width() - 1) && y <= static_cast<float>(p.height() - 1);
}

/// Bilinear interpolation of a place that is inside; the picture must be at least 2 x 2.
[[nodiscard]] inline float bilinear(image::ImageView p, float x, float y) {
  // At the last row and column the fraction becomes 1 instead of reading past the end.
  const int ix = std::min(static_cast<int>(x), p.width() - 2);
  const int iy = std::min(static_cast<int>(y), p.height() - 2);
  const float fx = x - static_cast<float>(ix);
  const float fy = y - static_cast<float>(iy);
  const std::uint8_t* a = p.row(iy) + ix;
  const std::uint8_t* b = a + p.stride();
  const float up = static_cast<float>(a[0]) + fx * static_cast<float>(a[1] - a[0]);
  const float down = static_cast<float>(b[0]) + fx * static_cast<float>(b[1] - b[0]);
  return up + fy * (down - up);
}

}  // namespace pickcell::matches
