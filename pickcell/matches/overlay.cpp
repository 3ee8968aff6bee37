#include "pickcell/matches/overlay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "pickcell/image/draw.hpp"

namespace pickcell::matches {

namespace {

using image::Path;
using image::Pen;
using image::Point;
using image::Rgb;

constexpr std::array<Rgb, 6> kModelColours{
    {{60, 230, 90}, {255, 170, 30}, {70, 190, 255}, {255, 110, 220}, {250, 240, 70}, {150, 130, 255}}};
constexpr Rgb kRejectedColour{255, 90, 80};
constexpr std::size_t kMostRejected = 8;

/// Pens and sizes that suit a picture of this size when it is looked at as a whole.
struct Style {
  double unit;
  Rgb colour;
  double opacity = 1;
  [[nodiscard]] Pen pen(double width, double strength = 1) const {
    Pen out;
    out.colour = colour;
    out.width_px = width * unit;
    out.halo_px = 1.5 * unit;
    out.opacity = opacity * strength;
    return out;
  }
};

Point scene_point(const Model& model, const Pose2d& pose, double x, double y) {
  const ScenePoint p = to_scene(model, pose, x, y);
  return {p.x_px, p.y_px};
}

Path rectangle(const Model& model, const Pose2d& pose) {
  const double right = model.picture.width() - 0.5, bottom = model.picture.height() - 0.5;
  Path out;
  for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {right, -0.5}, {right, bottom}, {-0.5, bottom}})
    out.push_back(scene_point(model, pose, x, y));
  return image::closed(std::move(out));
}

/// The border of the mask as short segments (marching squares between pixel centres).
std::vector<Path> contour(const Model& model, const Pose2d& pose) {
  const image::Image& mask = model.mask;
  const auto in = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < mask.width() && y < mask.height() && mask.at(x, y) >= 128;
  };
  std::vector<Path> out;
  for (int y = -1; y < mask.height(); ++y)
    for (int x = -1; x < mask.width(); ++x) {
      const std::array<bool, 4> corner{in(x, y), in(x + 1, y), in(x + 1, y + 1), in(x, y + 1)};
      const std::array<Point, 4> middle{
          {{x + 0.5, y + 0.0}, {x + 1.0, y + 0.5}, {x + 0.5, y + 1.0}, {x + 0.0, y + 0.5}}};
      Path segment;
      for (std::size_t side = 0; side < 4; ++side)
        if (corner[side] != corner[(side + 1) % 4])
          segment.push_back(scene_point(model, pose, middle[side].x, middle[side].y));
      if (segment.size() == 4) {  // two corners touch: two separate segments
        out.push_back({segment[2], segment[3]});
        segment.resize(2);
      }
      if (!segment.empty()) out.push_back(std::move(segment));
    }
  return out;
}

/// An arrow from the reference point along the template's x axis.
std::vector<Path> axis(const Model& model, const Pose2d& pose, double unit) {
  const double length = std::max(12 * unit, 0.4 * std::min(model.picture.width(), model.picture.height()) * pose.scale);
  const double a = pose.angle_deg * std::numbers::pi / 180;
  const Point from{pose.x_px, pose.y_px};
  const auto ahead = [&](double along, double across) {
    return Point{from.x + along * std::cos(a) + across * std::sin(a),
                 from.y - along * std::sin(a) + across * std::cos(a)};
  };
  const double head = 6 * unit;
  return {{from, ahead(length, 0)},
          {ahead(length - head, -0.6 * head), ahead(length, 0), ahead(length - head, 0.6 * head)}};
}

std::vector<Path> cross(const Pose2d& pose, double unit) {
  const double r = 6 * unit;
  return {{{pose.x_px - r, pose.y_px}, {pose.x_px + r, pose.y_px}},
          {{pose.x_px, pose.y_px - r}, {pose.x_px, pose.y_px + r}}};
}

/// Words below the reference point, moved into the picture.
void draw_words(image::RgbImage& out, const Pose2d& pose, const std::string& words, const Style& style) {
  const double height = 10 * style.unit, margin = 4 * style.unit;
  const double width = image::text_width(words, height);
  Point at{pose.x_px + 9 * style.unit, pose.y_px + 9 * style.unit};
  at.x = std::max(margin, std::min(at.x, out.width - margin - width));
  at.y = std::max(margin, std::min(at.y, out.height - 2 * margin - height));
  Pen plate;
  plate.colour = {0, 0, 0};
  plate.width_px = 1.8 * height;
  plate.halo_px = 0;
  plate.opacity = 0.55;
  const double middle = at.y + 0.5 * height;
  image::draw_path(out, {{at.x + 0.4 * height, middle}, {at.x + width - 0.6 * height, middle}}, plate);
  image::draw_text(out, at, words, height, style.pen(1.3));
}

void draw_outline(image::RgbImage& out, const Match& match, const Model& model, const Style& style) {
  const bool masked = !model.mask.empty();
  image::draw_path(out, rectangle(model, match.pose), masked ? style.pen(1, 0.4) : style.pen(1.8));
  if (masked) image::draw_paths(out, contour(model, match.pose), style.pen(1.6));
}

std::string score_words(const Match& match, const std::string& more) {
  char number[32];
  std::snprintf(number, sizeof(number), " %.2f", match.score);
  return match.model + number + (more.empty() ? "" : " " + more);
}

void draw_match(image::RgbImage& out, const Match& match, const Model& model, const Style& style) {
  draw_outline(out, match, model, style);
  image::draw_paths(out, axis(model, match.pose, style.unit), style.pen(1.6));
  image::draw_paths(out, cross(match.pose, style.unit), style.pen(1.2));
  draw_words(out, match.pose, score_words(match, match.ambiguous_deg.empty() ? "" : "angle?"), style);
}

}  // namespace

ScenePoint to_scene(const Model& model, const Pose2d& pose, double template_x_px, double template_y_px) {
  const double a = pose.angle_deg * std::numbers::pi / 180;
  const double c = pose.scale * std::cos(a), s = pose.scale * std::sin(a);
  const double u = template_x_px - model.ref_x_px, v = template_y_px - model.ref_y_px;
  return {pose.x_px + c * u + s * v, pose.y_px - s * u + c * v};
}

image::RgbImage draw_overlay(image::ImageView scene, const FindResult& found, std::span<const Model* const> models) {
  image::RgbImage out = image::to_rgb(scene);
  const double unit = std::max(0.8, std::min(scene.width(), scene.height()) / 600.0);
  const auto model_of = [&](const Match& m) -> const Model& {
    return *models[static_cast<std::size_t>(m.model_index)];
  };
  for (std::size_t i = std::min(kMostRejected, found.rejected.size()); i-- > 0;) {
    const Rejected& r = found.rejected[i];
    const Style dim{unit, kRejectedColour, 0.55};
    draw_outline(out, r.match, model_of(r.match), dim);
    draw_words(out, r.match.pose, score_words(r.match, name(r.reason)), dim);
  }
  for (std::size_t i = found.matches.size(); i-- > 0;) {  // the best on top
    const Match& m = found.matches[i];
    draw_match(out, m, model_of(m),
               {unit, kModelColours[static_cast<std::size_t>(m.model_index) % kModelColours.size()]});
  }
  return out;
}

}  // namespace pickcell::matches
