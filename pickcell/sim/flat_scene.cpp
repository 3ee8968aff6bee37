#include "pickcell/sim/flat_scene.hpp"

#include <algorithm>
#include <cmath>

#include "pickcell/core/units.hpp"

namespace pickcell::sim {

namespace {

constexpr int kSamples = 3;  ///< per pixel and axis

/// Pixels x0..x1-1, y0..y1-1.
struct PixelBox {
  int x0, y0, x1, y1;
};

/// From picture to part and back.
struct View2 {
  const FlatPose& pose;
  double c, s;
  explicit View2(const FlatPose& p)
      : pose(p), c(std::cos(core::rad_from_deg(p.angle_deg))), s(std::sin(core::rad_from_deg(p.angle_deg))) {}

  [[nodiscard]] Point2 part_mm(double x_px, double y_px) const {
    const double dx = (x_px - pose.x_px) / pose.px_per_mm, dy = -(y_px - pose.y_px) / pose.px_per_mm;
    return pose.anchor_mm + Point2(c * dx + s * dy, c * dy - s * dx);
  }

  [[nodiscard]] PixelBox around(const Box2& mm, double margin_mm, const LightPlane& scene) const {
    const Point2 middle = mm.center() - pose.anchor_mm;
    const double x = pose.x_px + pose.px_per_mm * (c * middle.x() - s * middle.y());
    const double y = pose.y_px - pose.px_per_mm * (s * middle.x() + c * middle.y());
    const double r = pose.px_per_mm * (mm.size().norm() / 2 + margin_mm) + 2;
    const auto clip = [](double v, int hi) { return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(hi))); };
    return {clip(x - r, scene.width()), clip(y - r, scene.height()), clip(x + r, scene.width()),
            clip(y + r, scene.height())};
  }
};

struct Sampled {
  float coverage = 0;
  float light = 0;  ///< times coverage
};

Sampled sample_pixel(const PartTexture& part, const View2& view, int x, int y, const Lighting& lit) {
  Sampled sum;
  for (int j = 0; j < kSamples; ++j)
    for (int i = 0; i < kSamples; ++i) {
      const Point2 p = view.part_mm(x + (i + 0.5) / kSamples - 0.5, y + (j + 0.5) / kSamples - 0.5);
      const Surfel s = part.sample(p.x(), p.y());
      if (s.coverage <= 0) continue;
      sum.coverage += s.coverage;
      sum.light += s.coverage * part.shade(s, p.x(), p.y(), lit);
    }
  return {sum.coverage / (kSamples * kSamples), sum.light / (kSamples * kSamples)};
}

}  // namespace

void lay_surface(LightPlane& scene, const SurfaceTexture& surface, double px_per_mm, double x_mm, double y_mm,
                 double angle_deg) {
  const double c = std::cos(core::rad_from_deg(angle_deg)) / px_per_mm,
               s = std::sin(core::rad_from_deg(angle_deg)) / px_per_mm;
  for (int y = 0; y < scene.height(); ++y)
    for (int x = 0; x < scene.width(); ++x) scene.at(x, y) = surface.sample(x_mm + c * x + s * y, y_mm - s * x + c * y);
}

void lay_part(LightPlane& scene, const PartTexture& part, const FlatPose& pose, const Light& light) {
  const View2 view(pose);
  const PixelBox box = view.around(part.kind().outline.bounds(), part.kind().height_mm, scene);
  const Lighting lit(pose.angle_deg, light);
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x) {
      const Point2 p = view.part_mm(x, y);
      float& pixel = scene.at(x, y);
      const double d = part.distance(p.x(), p.y()) * pose.px_per_mm;
      const Sampled top = d < 2 ? sample_pixel(part, view, x, y, lit) : Sampled{};
      if (top.coverage < 1) pixel *= part.ground_light(p.x(), p.y(), lit);
      pixel = (1 - top.coverage) * pixel + top.light;
    }
}

LightPlane coverage(int width, int height, const PartTexture& part, const FlatPose& pose) {
  LightPlane out(width, height);
  const View2 view(pose);
  const PixelBox box = view.around(part.kind().outline.bounds(), 0, out);
  const Lighting lit(pose.angle_deg, {});
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x) out.at(x, y) = sample_pixel(part, view, x, y, lit).coverage;
  return out;
}

}  // namespace pickcell::sim
