#pragma once
/// Lines and small words on a colour picture, for overlays. Antialiased, with a dark edge so that they can be read on
/// bright and on dark ground. Coordinates are pixels, centres at integers; what lies outside the picture is cut off.

#include <span>
#include <string_view>
#include <vector>

#include "pickcell/image/image.hpp"
#include "pickcell/image/rgb_image.hpp"

namespace pickcell::image {

struct Point {
  double x = 0;
  double y = 0;
};

/// Points joined by straight lines; a single point is a dot.
using Path = std::vector<Point>;

struct Pen {
  Rgb colour{255, 255, 255};
  double width_px = 1.5;
  double opacity = 1;    ///< 0..1
  double halo_px = 1.5;  ///< dark edge on either side of the line; 0: none
  Rgb halo{0, 0, 0};
};

/// The grey picture in colour.
[[nodiscard]] RgbImage to_rgb(ImageView picture);

/// All paths as one stroke: where they cross or meet nothing is painted twice.
void draw_paths(RgbImage& picture, std::span<const Path> paths, const Pen& pen);
void draw_path(RgbImage& picture, const Path& path, const Pen& pen);
/// The path back to its first point.
[[nodiscard]] Path closed(Path path);
/// A circle as a path.
[[nodiscard]] Path circle(Point centre, double radius_px);

/// One line of ASCII text in strokes; top_left is the upper left corner of its first capital. Other bytes are drawn as
/// '?'.
void draw_text(RgbImage& picture, Point top_left, std::string_view text, double height_px, const Pen& pen);
[[nodiscard]] double text_width(std::string_view text, double height_px);

}  // namespace pickcell::image
