#include "pickcell/sim/perspective.hpp"

#include <algorithm>
#include <cmath>

#include "pickcell/core/units.hpp"

namespace pickcell::sim {

namespace {

constexpr int kSamples = 2;               ///< of a top face per pixel and axis
constexpr double kSurfaceMiddleMm = 230;  ///< the plane's origin on the surface: its mirrored edges are out of sight
constexpr int kWallSteps = 5;             ///< heights at which a ray is tested for a wall

}  // namespace

SurfaceTexture seen_surface(Surface surface, std::uint64_t seed) { return {surface, seed, 460, 460, 2}; }

/// One part as the camera sees it: from the ground point behind a pixel to the part's frame.
struct Perspective::Sight {
  const PartTexture& texture;
  Eigen::Vector2f eye, at;
  float eye_z, height, c, s;

  Sight(const LaidPart& part, const Eigen::Vector3f& eye_mm)
      : texture(*part.part),
        eye(eye_mm.head<2>()),
        at(part.at_mm.cast<float>()),
        eye_z(eye_mm.z()),
        height(static_cast<float>(part.part->kind().height_mm)),
        c(static_cast<float>(std::cos(core::rad_from_deg(part.angle_deg)))),
        s(static_cast<float>(std::sin(core::rad_from_deg(part.angle_deg)))) {}

  /// Where the ray to a ground point passes the height z, in the part's frame.
  [[nodiscard]] Eigen::Vector2f at_height(const Eigen::Vector2f& ground, float z) const {
    const Eigen::Vector2f d = ground + (eye - ground) * (z / eye_z) - at;
    return {c * d.x() + s * d.y(), c * d.y() - s * d.x()};
  }
  [[nodiscard]] float distance(const Eigen::Vector2f& p) const {
    return texture.distance(static_cast<double>(p.x()), static_cast<double>(p.y()));
  }
};

Perspective::Perspective(const Intrinsics& camera, const core::Transform<core::Plane, core::Camera>& T_plane_camera,
                         SurfaceTexture surface, Light light)
    : camera_(camera),
      T_plane_camera_(T_plane_camera),
      eye_mm_((T_plane_camera.translation_m() * 1e3).cast<float>()),
      surface_(std::move(surface)),
      light_(light),
      ground_x_(camera.width_px + 1, camera.height_px + 1),
      ground_y_(camera.width_px + 1, camera.height_px + 1) {
  const Eigen::Matrix3d R = T_plane_camera.rotation();
  const Eigen::Vector3d eye = T_plane_camera.translation_m() * 1e3;
  for (int y = 0; y <= camera.height_px; ++y) {
    Eigen::Vector3d along(0, 0, 1);
    for (int x = 0; x <= camera.width_px; ++x) {
      along = ray(camera, {x, y}, x == 0 ? nullptr : &along);
      const Eigen::Vector3d d = R * along, hit = eye - d * (eye.z() / d.z());
      ground_x_.at(x, y) = static_cast<float>(hit.x());
      ground_y_.at(x, y) = static_cast<float>(hit.y());
    }
  }
}

Eigen::Vector2d Perspective::pixel(const Eigen::Vector3d& plane_mm) const {
  return project(camera_, T_plane_camera_.inverse().iso() * (plane_mm * 1e-3));
}

void Perspective::lay_background(double shift_mm) {
  if (!background_.empty() && shift_mm == background_shift_mm_) return;
  background_.resize(camera_.width_px, camera_.height_px);
  background_shift_mm_ = shift_mm;
  for (int y = 0; y < camera_.height_px; ++y) {
    const float *gx = ground_x_.row(y), *gy = ground_y_.row(y);
    float* to = background_.row(y);
    for (int x = 0; x < camera_.width_px; ++x)
      to[x] = surface_.sample(static_cast<double>(gx[x]) + kSurfaceMiddleMm - shift_mm,
                              static_cast<double>(gy[x]) + kSurfaceMiddleMm);
  }
}

Perspective::Window Perspective::window(const LaidPart& part, double margin_mm) const {
  Box2 box = extent_mm(part);
  box.lo.array() -= margin_mm, box.hi.array() += margin_mm;
  Eigen::Vector2d lo(1e9, 1e9), hi(-1e9, -1e9);
  for (const double z : {0.0, part.part->kind().height_mm})
    for (int corner = 0; corner < 9; ++corner) {  // corners and middles of the sides: the lens bends them
      const Point2 p = box.lo + box.size().cwiseProduct(Point2(corner % 3, corner / 3) / 2);
      const Eigen::Vector2d q = pixel({p.x(), p.y(), z});
      lo = lo.cwiseMin(q), hi = hi.cwiseMax(q);
    }
  const auto clip = [](double v, int most) { return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(most))); };
  return {clip(lo.x() - 2, camera_.width_px), clip(lo.y() - 2, camera_.height_px), clip(hi.x() + 3, camera_.width_px),
          clip(hi.y() + 3, camera_.height_px)};
}

namespace {

struct Seen {
  float coverage = 0;
  float light = 0;  ///< times coverage
};

/// Top face over the pixel at p (part's frame, mm), whose sides span px and py.
Seen see_top(const PartTexture& texture, const Eigen::Vector2f& p, const Eigen::Vector2f& px, const Eigen::Vector2f& py,
             const Lighting& lit) {
  Seen sum;
  for (int j = 0; j < kSamples; ++j)
    for (int i = 0; i < kSamples; ++i) {
      const float u = (static_cast<float>(i) + 0.5F) / kSamples - 0.5F,
                  v = (static_cast<float>(j) + 0.5F) / kSamples - 0.5F;
      const Eigen::Vector2d q = (p + u * px + v * py).cast<double>();
      const Surfel surfel = texture.sample(q.x(), q.y());
      if (surfel.coverage <= 0) continue;
      sum.coverage += surfel.coverage;
      sum.light += surfel.coverage * texture.shade(surfel, q.x(), q.y(), lit);
    }
  return {sum.coverage / (kSamples * kSamples), sum.light / (kSamples * kSamples)};
}

/// Side wall seen at p: outward normal from the distance field.
float wall_light(const PartTexture& texture, const Eigen::Vector2f& p, const Lighting& lit) {
  const double x = static_cast<double>(p.x()), y = static_cast<double>(p.y());
  const double nx = static_cast<double>(texture.distance(x + 0.4, y) - texture.distance(x - 0.4, y));
  const double ny = static_cast<double>(texture.distance(x, y + 0.4) - texture.distance(x, y - 0.4));
  const double norm = std::max(std::hypot(nx, ny), 1e-6);
  return texture.shade_wall(nx / norm, ny / norm, lit);
}

}  // namespace

void Perspective::draw(LightPlane& scene, const LaidPart& part) const {
  const Sight sight(part, eye_mm_);
  const Lighting lit(part.angle_deg, light_);
  const Window w = window(part, 0.75 * part.part->kind().height_mm);
  for (int y = w.y0; y < w.y1; ++y)
    for (int x = w.x0; x < w.x1; ++x) draw_pixel(scene.at(x, y), x, y, sight, lit);
}

void Perspective::draw_pixel(float& out, int x, int y, const Sight& sight, const Lighting& lit) const {
  const PartTexture& texture = sight.texture;
  const Eigen::Vector2f here = ground(x, y), foot = sight.at_height(here, 0);
  const float ground_distance = sight.distance(foot);
  const Eigen::Vector2f top = sight.at_height(here, sight.height);
  if (ground_distance > 0.75F * sight.height + (top - foot).norm()) return;  // neither part nor shadow
  const Eigen::Vector2f px = sight.at_height(ground(x + 1, y), sight.height) - top;
  const Eigen::Vector2f py = sight.at_height(ground(x, y + 1), sight.height) - top;
  const float px_mm = px.norm();
  Seen face;
  if (sight.distance(top) < 2 * px_mm) face = see_top(texture, top, px, py, lit);
  if (face.coverage < 1) {
    out *= texture.ground_light(static_cast<double>(foot.x()), static_cast<double>(foot.y()), lit);
    for (int k = 0; k < kWallSteps; ++k) {  // from the ground up: the higher one lies in front
      const float z = sight.height * (static_cast<float>(k) + 0.5F) / kWallSteps;
      const Eigen::Vector2f p = sight.at_height(here, z);
      const float solid = std::clamp(0.5F - sight.distance(p) / px_mm, 0.0F, 1.0F);
      if (solid <= 0) continue;
      out = (1 - solid) * out + solid * wall_light(texture, p, lit) * (0.7F + 0.3F * z / sight.height);
    }
  }
  out = (1 - face.coverage) * out + face.light;
}

LightPlane Perspective::render(const std::vector<LaidPart>& parts, double shift_mm) {
  lay_background(shift_mm);
  LightPlane scene(background_);
  for (const LaidPart& part : parts) draw(scene, part);
  return scene;
}

image::Image Perspective::mask(const LaidPart& part) const {
  image::Image out(camera_.width_px, camera_.height_px);
  const Sight sight(part, eye_mm_);
  const Window w = window(part, 0);
  for (int y = w.y0; y < w.y1; ++y)
    for (int x = w.x0; x < w.x1; ++x) {
      const Eigen::Vector2f p = sight.at_height(ground(x, y), sight.height);
      const Surfel surfel = sight.texture.sample(static_cast<double>(p.x()), static_cast<double>(p.y()));
      out.at(x, y) = surfel.coverage >= 0.5F ? 255 : 0;
    }
  return out;
}

}  // namespace pickcell::sim
