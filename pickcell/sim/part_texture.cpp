#include "pickcell/sim/part_texture.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "pickcell/core/units.hpp"
#include "pickcell/sim/noise.hpp"

namespace pickcell::sim {

namespace {

constexpr double kFacePerMm = 6;      ///< raster of the top face, pixels per mm
constexpr double kDistancePerMm = 2;  ///< raster of the distance
constexpr double kSurroundMm = 15;
constexpr double kMaxTilt = 0.8;

Box2 wider(Box2 box, double margin) {
  box.lo.array() -= margin;
  box.hi.array() += margin;
  return box;
}

Point2 gradient(const Shape& shape, const Point2& p) {
  constexpr double kStep = 0.05;
  const Point2 g(shape.distance({p.x() + kStep, p.y()}) - shape.distance({p.x() - kStep, p.y()}),
                 shape.distance({p.x(), p.y() + kStep}) - shape.distance({p.x(), p.y() - kStep}));
  const double norm = g.norm();
  return norm > 1e-9 ? Point2(g / norm) : Point2::Zero();
}

double inside_of(const Shape& shape, const Point2& p) {
  return std::clamp(0.5 - shape.distance(p) * kFacePerMm, 0.0, 1.0);
}

bool near(const Box2& box, const Point2& p, double margin) {
  return ((p - box.lo).array() > -margin).all() && ((box.hi - p).array() > -margin).all();
}

double gloss(Finish finish) {
  switch (finish) {
    case Finish::brushed:
    case Finish::turned:
      return 1.0;
    case Finish::matt:
      return 0.7;
    case Finish::paper:
      return 0.3;
    case Finish::wood:
      return 0.5;
  }
  return 0;
}

}  // namespace

PartTexture::PartTexture(const PartKind& kind)
    : kind_(kind),
      face_(wider(kind.outline.bounds(), 1)),
      surround_(wider(kind.outline.bounds(), kSurroundMm)),
      brush_(std::cos(core::rad_from_deg(kind.brush_deg)), std::sin(core::rad_from_deg(kind.brush_deg))) {
  const Point2 around_px = surround_.size() * kDistancePerMm;
  distance_.resize(static_cast<int>(std::ceil(around_px.x())) + 1, static_cast<int>(std::ceil(around_px.y())) + 1);
  for (int y = 0; y < distance_.height(); ++y)
    for (int x = 0; x < distance_.width(); ++x)
      distance_.at(x, y) = static_cast<float>(kind_.outline.distance(surround_.lo + Point2(x, y) / kDistancePerMm));
  const Point2 face_px = face_.size() * kFacePerMm;
  const int w = static_cast<int>(std::ceil(face_px.x())) + 1, h = static_cast<int>(std::ceil(face_px.y())) + 1;
  surfels_.resize(4 * w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      Surfel s;
      paint(face_.lo + Point2(x, y) / kFacePerMm, s);
      float* out = surfels_.row(y) + 4 * x;
      out[0] = s.coverage, out[1] = s.albedo, out[2] = s.nx, out[3] = s.ny;
    }
  collect_points();
}

void PartTexture::collect_points() {
  const Box2& b = kind_.outline.bounds();
  for (double y = b.lo.y() - 0.25; y < b.hi.y() + 0.5; y += 1)
    for (double x = b.lo.x() - 0.25; x < b.hi.x() + 0.5; x += 1) {
      const Point2 p(x, y);
      const double d = kind_.outline.distance(p);
      if (d < 0) inside_.push_back(p);
      // The nearest point of the outline, one step along the gradient away.
      if (std::abs(d) < 0.6) rim_.emplace_back(p - d * gradient(kind_.outline, p));
    }
}

double PartTexture::material(const Point2& p) const {
  const double grain = 0.03 * fractal_noise(p.x() * 1.5, p.y() * 1.5, 2, kind_.seed) +
                       0.05 * fractal_noise(p.x() * 0.07, p.y() * 0.07, 2, kind_.seed + 100);
  const double a = core::rad_from_deg(kind_.brush_deg);
  switch (kind_.finish) {
    case Finish::brushed: {
      const double along = p.x() * std::cos(a) + p.y() * std::sin(a),
                   across = p.y() * std::cos(a) - p.x() * std::sin(a);
      return kind_.albedo * (1 + grain + 0.1 * fractal_noise(along * 0.08, across * 2.2, 3, kind_.seed + 200));
    }
    case Finish::turned:
      return kind_.albedo * (1 + grain + 0.12 * fractal_noise(p.norm() * 2.4, 0.3, 3, kind_.seed + 300));
    case Finish::matt:
      return kind_.albedo * (1 + 2.2 * grain);
    case Finish::paper:
      return kind_.albedo * (1 + 0.5 * grain);
    case Finish::wood: {
      const double along = p.x() * std::cos(a) + p.y() * std::sin(a),
                   across = p.y() * std::cos(a) - p.x() * std::sin(a);
      const double ring = across * 0.22 + 1.5 * fractal_noise(along * 0.02, across * 0.07, 2, kind_.seed + 400);
      const double late = 0.5 + 0.5 * std::sin(2 * core::kPi * ring);  // the dark, narrow part of a year
      return kind_.albedo * (1.08 + grain - 0.32 * late * late * late +
                             0.14 * fractal_noise(along * 0.12, across * 1.8, 3, kind_.seed + 500));
    }
  }
  return kind_.albedo;
}

void PartTexture::paint(const Point2& p, Surfel& out) const {
  double albedo = material(p);
  Point2 tilt = Point2::Zero();
  for (const Mark& mark : kind_.marks) {
    const double edge = std::abs(mark.step_mm);
    if (!near(mark.shape.bounds(), p, edge + 0.5)) continue;
    albedo = std::lerp(albedo, mark.albedo * (1 + (albedo / kind_.albedo - 1) * 0.5),
                       mark.opacity * inside_of(mark.shape, p));
    const double d = std::abs(mark.shape.distance(p));
    if (d < edge) tilt += gradient(mark.shape, p) * (mark.step_mm > 0 ? 1 : -1) * kMaxTilt * (1 - d / edge);
  }
  double d = static_cast<double>(distance(p.x(), p.y()));
  if (std::abs(d) < kind_.bevel_mm + 1) d = kind_.outline.distance(p);  // exact where it is seen
  if (d > -kind_.bevel_mm) {  // the broken edge: brighter under diffuse light, with a dark burr outside
    const double up = std::min(1 + d / kind_.bevel_mm, 1.0);
    if (d < 1) tilt += gradient(kind_.outline, p) * kMaxTilt * up;
    albedo *= d > -0.25 ? 0.8 : 1 + 0.22 * up;
  }
  out = {static_cast<float>(std::clamp(0.5 - d * kFacePerMm, 0.0, 1.0)),
         static_cast<float>(std::clamp(albedo, 0.02, 1.0)), static_cast<float>(tilt.x()), static_cast<float>(tilt.y())};
}

Surfel PartTexture::sample(double x_mm, double y_mm) const {
  const double u = (x_mm - face_.lo.x()) * kFacePerMm, v = (y_mm - face_.lo.y()) * kFacePerMm;
  const int w = surfels_.width() / 4;
  if (!(u >= 0 && v >= 0 && u < w - 1 && v < surfels_.height() - 1)) return {};
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const auto fu = static_cast<float>(u - x), fv = static_cast<float>(v - y);
  const float* a = surfels_.row(y) + 4 * x;
  const float* b = surfels_.row(y + 1) + 4 * x;
  const float waa = (1 - fu) * (1 - fv), wab = fu * (1 - fv), wba = (1 - fu) * fv, wbb = fu * fv;
  float out[4];
  for (int i = 0; i < 4; ++i) out[i] = waa * a[i] + wab * a[i + 4] + wba * b[i] + wbb * b[i + 4];
  return {out[0], out[1], out[2], out[3]};
}

float PartTexture::distance(double x_mm, double y_mm) const {
  const double u0 = (x_mm - surround_.lo.x()) * kDistancePerMm, v0 = (y_mm - surround_.lo.y()) * kDistancePerMm;
  const double u = std::clamp(u0, 0.0, distance_.width() - 1.001), v = std::clamp(v0, 0.0, distance_.height() - 1.001);
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const auto fu = static_cast<float>(u - x), fv = static_cast<float>(v - y);
  const float *a = distance_.row(y) + x, *b = distance_.row(y + 1) + x;
  const float d = (1 - fv) * ((1 - fu) * a[0] + fu * a[1]) + fv * ((1 - fu) * b[0] + fu * b[1]);
  if (u == u0 && v == v0) return d;
  // Outside the raster, which is convex and encloses the part: at least the way to it and on, at a right angle or more.
  const auto out = static_cast<float>(std::hypot(u0 - u, v0 - v) / kDistancePerMm);
  return std::sqrt(d * d + out * out);
}

Lighting::Lighting(double angle_deg, const Light& light)
    : c(std::cos(core::rad_from_deg(angle_deg))),
      s(std::sin(core::rad_from_deg(angle_deg))),
      lx(std::cos(core::rad_from_deg(light.from_deg))),
      ly(std::sin(core::rad_from_deg(light.from_deg))),
      strength(light.strength) {}

float PartTexture::shade(const Surfel& s, double x_mm, double y_mm, const Lighting& lit) const {
  const double towards = lit.lx * (lit.c * s.nx - lit.s * s.ny) + lit.ly * (lit.s * s.nx + lit.c * s.ny);
  double value = s.albedo * (1 + lit.strength * gloss(kind_.finish) * towards);
  if (kind_.finish == Finish::turned || kind_.finish == Finish::brushed) {
    // Grooves shine across their direction: the double wedge of turned faces, the change of brushed ones with their
    // angle.
    Point2 groove = brush_;
    if (kind_.finish == Finish::turned)
      groove = Point2(-y_mm, x_mm) / std::max(std::sqrt(x_mm * x_mm + y_mm * y_mm), 1e-6);
    const double gx = lit.c * groove.x() - lit.s * groove.y(), gy = lit.s * groove.x() + lit.c * groove.y();
    const double across = lit.lx * gy - lit.ly * gx;
    value *= 1 + 0.3 * lit.strength * (2 * across * across - 1);
  }
  return static_cast<float>(std::max(value, 0.01));
}

float PartTexture::shade_wall(double nx, double ny, const Lighting& lit) const {
  const double towards = lit.lx * (lit.c * nx - lit.s * ny) + lit.ly * (lit.s * nx + lit.c * ny);
  return static_cast<float>(std::max(0.45 * kind_.albedo * (1 + 0.8 * lit.strength * towards), 0.01));
}

float PartTexture::ground_light(double x_mm, double y_mm, const Lighting& lit) const {
  const double half = 0.5 * kind_.height_mm;
  const auto reach = static_cast<float>(half);
  const float d = distance(x_mm, y_mm);
  if (d > 1.5F * reach) return 1;
  const float close = std::clamp(1 - d / reach, 0.0F, 1.0F);
  const double towards_x = lit.c * lit.lx + lit.s * lit.ly, towards_y = lit.c * lit.ly - lit.s * lit.lx;
  const float under = distance(x_mm + half * towards_x, y_mm + half * towards_y);
  const float cast = std::clamp(0.5F - under / reach, 0.0F, 1.0F);
  return (1 - 0.3F * close * close) * (1 - static_cast<float>(0.7 * lit.strength) * cast);
}

const PartTexture& part_texture(std::string_view name) {
  static std::mutex mutex;
  static std::map<std::string, std::unique_ptr<PartTexture>, std::less<>> made;
  const std::lock_guard lock(mutex);
  auto found = made.find(name);
  if (found == made.end())
    found = made.emplace(std::string(name), std::make_unique<PartTexture>(part_kind(name))).first;
  return *found->second;
}

}  // namespace pickcell::sim
