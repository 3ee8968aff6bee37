#pragma once
/// A template turned and scaled onto the pixel grid: what steps 3 and 4 lay over the picture.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pickcell/image/image.hpp"
#include "pickcell/matches/rst/settings.hpp"

namespace pickcell::matches {

/// Grey values by runs of pixels relative to the anchor, which lies at a whole pixel of the picture. Runs are padded
/// with 128 to whole kWindowBlocks.
constexpr int kWindowBlock = 32;

struct Window {
  struct Run {
    int dy, dx, length;
    std::size_t first;  ///< place of its values
  };
  std::vector<Run> runs;
  std::vector<std::uint8_t> values;
  int pixels = 0;
  std::int64_t sum = 0;                          ///< of value - 128
  std::int64_t sum_sq = 0;                       ///< of (value - 128)^2
  int x_lo = 0, x_hi = -1, y_lo = 0, y_hi = -1;  ///< box of the runs

  [[nodiscard]] std::size_t bytes() const { return values.capacity() + runs.capacity() * sizeof(Run); }
};

/// What a window is made from: one level of the template.
struct WindowSource {
  image::ImageView grey;
  image::View<float> coverage;  ///< empty: the whole rectangle is part
  double anchor_x = 0, anchor_y = 0;
  WindowMask mask = WindowMask::rect;
};

/// Bilinear; a pixel belongs to the window when its whole footprint lies in the template (and in its mask, and in the
/// inscribed disc where that is asked for). Angle: counter-clockwise on the screen.
[[nodiscard]] Window make_window(const WindowSource& source, double angle_deg, double scale);

/// Sums over the pixels of a window that lie in the picture, all of value - 128: i of the picture, t of the window.
struct WindowSums {
  std::int64_t n = 0, i = 0, ii = 0, t = 0, tt = 0, it = 0;
  bool operator==(const WindowSums&) const = default;
};

/// Normalised cross-correlation with the window's anchor at (x, y). Pixels outside the picture are left out of both
/// sides; inside: their share. 0 where either side is flat.
struct WindowScore {
  double ncc = 0;
  double inside = 1;
};
[[nodiscard]] WindowScore score_window(image::ImageView picture, const Window& window, int x, int y);

}  // namespace pickcell::matches
