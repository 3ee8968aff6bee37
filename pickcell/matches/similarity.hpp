#pragma once
/// Inside the engine: the similarity that carries template points, taken about the model's anchor, into the scene.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pickcell/matches/match.hpp"

namespace pickcell::matches {

/// scene = (x, y) + scale * R(angle) * q with q = template point - anchor, R(a) = [[cos a, sin a], [-sin a, cos a]]:
/// the convention of Pose2d, in radians and about the anchor. Pixels of level 0.
struct Similarity {
  double x_px = 0;
  double y_px = 0;
  double angle_rad = 0;
  double scale = 1;
};

/// The same at one pyramid level: x' = x + a qx + b qy, y' = y - b qx + a qy with q in pixels of that level.
struct LevelMap {
  float x, y, a, b;
};

/// Pixels, inclusive; may lie outside the picture.
struct PixelBox {
  int x0, y0, x1, y1;
};

/// The pixels around a box of template points (relative to the anchor) at its place in the picture.
[[nodiscard]] inline PixelBox box_under(float x_lo, float x_hi, float y_lo, float y_hi, const LevelMap& m) {
  float x0 = m.x, x1 = m.x, y0 = m.y, y1 = m.y;
  for (const float qx : {x_lo, x_hi})
    for (const float qy : {y_lo, y_hi}) {
      const float x = m.x + m.a * qx + m.b * qy, y = m.y - m.b * qx + m.a * qy;
      x0 = std::min(x0, x), x1 = std::max(x1, x);
      y0 = std::min(y0, y), y1 = std::max(y1, y);
    }
  const auto whole = [](float v) { return static_cast<int>(std::clamp(v, -1e6f, 1e6f)); };
  return {whole(x0) - 2, whole(y0) - 2, whole(x1) + 3, whole(y1) + 3};
}

/// Pixel centres of level l: x_l = (x_0 + 0.5) / 2^l - 0.5.
[[nodiscard]] inline LevelMap at_level(const Similarity& s, int level) {
  const double k = std::ldexp(1.0, -level);
  return {static_cast<float>((s.x_px + 0.5) * k - 0.5), static_cast<float>((s.y_px + 0.5) * k - 0.5),
          static_cast<float>(s.scale * std::cos(s.angle_rad)), static_cast<float>(s.scale * std::sin(s.angle_rad))};
}

[[nodiscard]] inline double wrap_rad(double a) {
  return std::abs(a) < std::numbers::pi ? a : std::remainder(a, 2 * std::numbers::pi);
}

/// Whether two places are less than a distance apart: asked for many pairs, so without a root.
[[nodiscard]] inline bool nearer_than(const Similarity& a, const Similarity& b, double distance_px) {
  const double dx = a.x_px - b.x_px, dy = a.y_px - b.y_px;
  return dx * dx + dy * dy < distance_px * distance_px;
}

/// (-180, 180].
[[nodiscard]] inline double wrap_deg(double a) {
  const double r = std::remainder(a, 360.0);
  return r <= -180.0 ? r + 360.0 : r;
}

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

/// A small similarity of the template about the anchor: q -> (1 + growth) R(turn) q + (dx, dy).
struct Increment {
  double dx = 0;
  double dy = 0;
  double turn_rad = 0;
  double growth = 0;
};

/// s after the inverse of the increment (the update of inverse-compositional Gauss-Newton); dx, dy in pixels of level
/// 0.
[[nodiscard]] inline Similarity compose_inverse(const Similarity& s, const Increment& d) {
  Similarity r = s;
  r.angle_rad = wrap_rad(s.angle_rad - d.turn_rad);
  r.scale = s.scale / (1 + d.growth);
  const double a = r.scale * std::cos(r.angle_rad);
  const double b = r.scale * std::sin(r.angle_rad);
  r.x_px -= a * d.dx + b * d.dy;
  r.y_px -= -b * d.dx + a * d.dy;
  return r;
}

/// Where a template point lies in the scene; tx, ty relative to the anchor.
[[nodiscard]] inline Pose2d pose_of(const Similarity& s, double tx, double ty) {
  const double a = s.scale * std::cos(s.angle_rad);
  const double b = s.scale * std::sin(s.angle_rad);
  return {s.x_px + a * tx + b * ty, s.y_px - b * tx + a * ty, wrap_deg(s.angle_rad * kDegPerRad), s.scale};
}

/// The inverse of pose_of.
[[nodiscard]] inline Similarity similarity_of(const Pose2d& p, double tx, double ty) {
  Similarity s{p.x_px, p.y_px, p.angle_deg / kDegPerRad, p.scale};
  const double a = s.scale * std::cos(s.angle_rad);
  const double b = s.scale * std::sin(s.angle_rad);
  s.x_px -= a * tx + b * ty;
  s.y_px -= -b * tx + a * ty;
  return s;
}

/// (dx, dy, turn, growth) of the template about the anchor move the scene the other way.
[[nodiscard]] inline Eigen::Matrix4d scene_from_template(const Similarity& s) {
  const double a = s.scale * std::cos(s.angle_rad), b = s.scale * std::sin(s.angle_rad);
  Eigen::Matrix4d K;
  K << -a, -b, 0, 0,  //
      b, -a, 0, 0,    //
      0, 0, -1, 0,    //
      0, 0, 0, -1;
  return K;
}

}  // namespace pickcell::matches
