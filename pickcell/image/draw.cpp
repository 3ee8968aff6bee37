#include "pickcell/image/draw.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pickcell/image/stroke_font.hpp"

namespace pickcell::image {

namespace {

struct Box {
  int x0, y0, x1, y1;  ///< inclusive
  [[nodiscard]] bool empty() const { return x1 < x0 || y1 < y0; }
  [[nodiscard]] int width() const { return x1 - x0 + 1; }
};

Box box_around(std::span<const Path> paths, double reach, const RgbImage& picture) {
  double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
  for (const Path& path : paths)
    for (const Point& p : path) {
      x0 = std::min(x0, p.x);
      y0 = std::min(y0, p.y);
      x1 = std::max(x1, p.x);
      y1 = std::max(y1, p.y);
    }
  const auto within = [](double v, int last) { return static_cast<int>(std::clamp(v, -1.0, last + 1.0)); };
  return {std::max(0, within(std::floor(x0 - reach), picture.width)),
          std::max(0, within(std::floor(y0 - reach), picture.height)),
          std::min(picture.width - 1, within(std::ceil(x1 + reach), picture.width)),
          std::min(picture.height - 1, within(std::ceil(y1 + reach), picture.height))};
}

/// Far away is far enough.
int whole(double v) { return static_cast<int>(std::clamp(v, -1e6, 1e6)); }

double distance_to_segment(double x, double y, Point a, Point b) {
  const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
  const double t = length2 > 0 ? std::clamp(((x - a.x) * dx + (y - a.y) * dy) / length2, 0.0, 1.0) : 0;
  return std::hypot(x - a.x - t * dx, y - a.y - t * dy);
}

/// The distance of every pixel of a box to the nearest path, as far as reach.
class DistanceMap {
 public:
  DistanceMap(Box box, double reach)
      : box_(box),
        reach_(reach),
        values_(static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.y1 - box.y0 + 1),
                static_cast<float>(reach)) {}

  void add(Point a, Point b) {
    const int first = std::max(box_.y0, whole(std::ceil(std::min(a.y, b.y) - reach_)));
    const int last = std::min(box_.y1, whole(std::floor(std::max(a.y, b.y) + reach_)));
    for (int y = first; y <= last; ++y) add_row(a, b, y);
  }
  [[nodiscard]] float at(int x, int y) const { return values_[index(x, y)]; }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - box_.y0) * static_cast<std::size_t>(box_.width()) +
           static_cast<std::size_t>(x - box_.x0);
  }

  /// Only the pixels beside the part of the segment that is near this row.
  void add_row(Point a, Point b, int y) {
    double t0 = 0, t1 = 1;
    if (std::abs(b.y - a.y) > 1e-9) {
      const double u = (y - reach_ - a.y) / (b.y - a.y), v = (y + reach_ - a.y) / (b.y - a.y);
      t0 = std::clamp(std::min(u, v), 0.0, 1.0);
      t1 = std::clamp(std::max(u, v), 0.0, 1.0);
    }
    const double xa = a.x + t0 * (b.x - a.x), xb = a.x + t1 * (b.x - a.x);
    const int first = std::max(box_.x0, whole(std::ceil(std::min(xa, xb) - reach_)));
    const int last = std::min(box_.x1, whole(std::floor(std::max(xa, xb) + reach_)));
    for (int x = first; x <= last; ++x) {
      float& value = values_[index(x, y)];
      value = std::min(value, static_cast<float>(distance_to_segment(x, y, a, b)));
    }
  }

  Box box_;
  double reach_;
  std::vector<float> values_;
};

void blend(Rgb& pixel, Rgb colour, double share) {
  for (std::size_t i = 0; i < 3; ++i)
    pixel[i] = static_cast<std::uint8_t>(std::lround(pixel[i] + (colour[i] - pixel[i]) * share));
}

double coverage(double distance_px, double radius_px) { return std::clamp(radius_px + 0.5 - distance_px, 0.0, 1.0); }

bool drawable(const Path& path) {
  return !path.empty() &&
         std::all_of(path.begin(), path.end(), [](Point p) { return std::isfinite(p.x) && std::isfinite(p.y); });
}

}  // namespace

RgbImage to_rgb(ImageView picture) {
  RgbImage out(picture.width(), picture.height(), {0, 0, 0});
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) {
      const std::uint8_t v = picture.at(x, y);
      out.at(x, y) = {v, v, v};
    }
  return out;
}

void draw_paths(RgbImage& picture, std::span<const Path> paths, const Pen& pen) {
  std::vector<Path> fine;
  std::copy_if(paths.begin(), paths.end(), std::back_inserter(fine), drawable);
  const double radius = pen.width_px / 2, reach = radius + pen.halo_px + 1;
  const Box box = box_around(fine, reach, picture);
  if (fine.empty() || box.empty()) return;
  DistanceMap distances(box, reach);
  for (const Path& path : fine) {
    if (path.size() == 1) distances.add(path[0], path[0]);
    for (std::size_t i = 1; i < path.size(); ++i) distances.add(path[i - 1], path[i]);
  }
  for (int y = box.y0; y <= box.y1; ++y)
    for (int x = box.x0; x <= box.x1; ++x) {
      const double distance = distances.at(x, y);
      if (distance >= reach) continue;
      if (pen.halo_px > 0)
        blend(picture.at(x, y), pen.halo, 0.8 * pen.opacity * coverage(distance, radius + pen.halo_px));
      blend(picture.at(x, y), pen.colour, pen.opacity * coverage(distance, radius));
    }
}

void draw_path(RgbImage& picture, const Path& path, const Pen& pen) { draw_paths(picture, {&path, 1}, pen); }

Path closed(Path path) {
  if (!path.empty()) path.push_back(path.front());
  return path;
}

Path circle(Point centre, double radius_px) {
  const int corners = std::clamp(static_cast<int>(radius_px * 3), 12, 180);
  Path out;
  for (int i = 0; i <= corners; ++i) {
    const double a = 2 * std::numbers::pi * i / corners;
    out.push_back({centre.x + radius_px * std::cos(a), centre.y + radius_px * std::sin(a)});
  }
  return out;
}

void draw_text(RgbImage& picture, Point top_left, std::string_view text, double height_px, const Pen& pen) {
  const double unit = height_px / stroke_font::kCapitalHeight;
  std::vector<Path> strokes;
  for (const char c : text) {
    stroke_font::add_glyph(c, top_left, unit, strokes);
    top_left.x += unit * stroke_font::kAdvance;
  }
  draw_paths(picture, strokes, pen);
}

double text_width(std::string_view text, double height_px) {
  return height_px / stroke_font::kCapitalHeight * stroke_font::kAdvance * static_cast<double>(text.size());
}

}  // namespace pickcell::image
