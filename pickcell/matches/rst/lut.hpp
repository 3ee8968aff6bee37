#pragma once
/// The look-up tables of the paper: which pixels a circle (LUT_S) or a radial line (LUT_R) touches.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pickcell::matches {

struct PixelOffset {
  int dx = 0;
  int dy = 0;
  bool operator==(const PixelOffset&) const = default;
};

/// Several lists of pixels about a common centre, each in the order of rows.
struct PixelLists {
  std::vector<PixelOffset> pixels;
  std::vector<int> start{0};  ///< list k is pixels[start[k]] .. pixels[start[k + 1] - 1]

  [[nodiscard]] int lists() const { return static_cast<int>(start.size()) - 1; }
  void add(const std::vector<PixelOffset>& list);
};

/// The same for a picture with the given stride.
struct OffsetLists {
  std::vector<std::int32_t> offsets;
  std::vector<int> start{0};
  std::vector<float> inverse_length;

  [[nodiscard]] int lists() const { return static_cast<int>(start.size()) - 1; }
};
[[nodiscard]] OffsetLists offsets_for(const PixelLists& lists, std::ptrdiff_t stride);

/// Radii of `count` circles from 0 to r_max, duplicates of small templates dropped; ascending.
[[nodiscard]] std::vector<int> circle_radii(int r_max, int count);

/// The circle of the midpoint algorithm, every pixel once; symmetric under quarter turns and mirroring.
[[nodiscard]] std::vector<PixelOffset> circle_pixels(int radius);

/// Bresenham's line from the centre to length * (cos a, -sin a), both ends included. Turned by 90 degrees it is exactly
/// the line at a + 90.
[[nodiscard]] std::vector<PixelOffset> line_pixels(double angle_deg, int length);

[[nodiscard]] PixelLists circle_lists(const std::vector<int>& radii);
/// Lines at 0, 360 / count, ... degrees, counter-clockwise on the screen.
[[nodiscard]] PixelLists line_lists(int count, int length);

}  // namespace pickcell::matches
