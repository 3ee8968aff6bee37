#include "pickcell/sim/teach_picture.hpp"

#include <algorithm>
#include <cmath>

#include "pickcell/core/units.hpp"

namespace pickcell::sim {

namespace {

constexpr int kMarginPx = 8;

/// The part with its origin behind the picture's middle and its x axis along the picture's.
LaidPart in_the_middle(const PartTexture& texture, const Intrinsics& camera,
                       const core::Transform<core::Plane, core::Camera>& T_plane_camera) {
  const Eigen::Vector2d middle(0.5 * (camera.width_px - 1), 0.5 * (camera.height_px - 1));
  const Eigen::Vector2d half(0.5, 0);
  const double h = texture.kind().height_mm;
  const Eigen::Vector2d along =
      cast_mm(camera, T_plane_camera, middle + half, h) - cast_mm(camera, T_plane_camera, middle - half, h);
  return {&texture, cast_mm(camera, T_plane_camera, middle, h), core::deg_from_rad(std::atan2(along.y(), along.x())),
          1};
}

void set_roi(TeachPicture& taught) {
  int x0 = taught.mask.width(), y0 = taught.mask.height(), x1 = -1, y1 = -1;
  for (int y = 0; y < taught.mask.height(); ++y)
    for (int x = 0; x < taught.mask.width(); ++x)
      if (taught.mask.at(x, y) != 0)
        x0 = std::min(x0, x), x1 = std::max(x1, x), y0 = std::min(y0, y), y1 = std::max(y1, y);
  taught.roi_x = std::max(0, x0 - kMarginPx);
  taught.roi_y = std::max(0, y0 - kMarginPx);
  taught.roi_w = std::min(taught.mask.width(), x1 + 1 + kMarginPx) - taught.roi_x;
  taught.roi_h = std::min(taught.mask.height(), y1 + 1 + kMarginPx) - taught.roi_y;
}

TeachPicture take(const PartTexture& texture, const CameraSettings& camera,
                  const core::Transform<core::Plane, core::Camera>& T_plane_camera, Perspective& perspective) {
  const PartKind& kind = texture.kind();
  const LaidPart laid = in_the_middle(texture, camera.intrinsics, T_plane_camera);
  const auto pixel_of = [&](const Point2& part_mm) {
    const Point2 p = laid.to_plane(part_mm);
    return perspective.pixel({p.x(), p.y(), kind.height_mm});
  };
  LightPlane light = perspective.render({laid}, 0);
  blur(light, camera.psf_sigma_px);
  TeachPicture taught;
  taught.kind = kind.name;
  taught.picture = expose(light, camera.sensor, mix(camera.seed) ^ mix(kind.seed));
  taught.mask = perspective.mask(laid);
  taught.height_mm = kind.height_mm;
  set_roi(taught);
  const Eigen::Vector2d ref = pixel_of({0, 0});
  taught.ref_x_px = ref.x(), taught.ref_y_px = ref.y();
  for (const TaughtGrasp& g : kind.grasps) {
    const double a = core::rad_from_deg(g.angle_deg);
    const Point2 at(g.x_mm, g.y_mm), along = 0.5 * Point2(std::cos(a), std::sin(a));
    const Eigen::Vector2d p = pixel_of(at), d = pixel_of(at + along) - pixel_of(at - along);
    taught.grasps.push_back({p.x(), p.y(), core::deg_from_rad(std::atan2(-d.y(), d.x())), g.sym180});
  }
  return taught;
}

}  // namespace

std::vector<TeachPicture> take_teach_pictures(const std::vector<std::string>& kinds, const CameraSettings& camera,
                                              const core::Transform<core::Base, core::Plane>& T_base_plane,
                                              Surface surface) {
  const core::Transform<core::Plane, core::Camera> T_plane_camera = T_base_plane.inverse() * camera.T_base_camera;
  Perspective perspective(camera.intrinsics, T_plane_camera, seen_surface(surface, camera.seed + 1), camera.light);
  std::vector<TeachPicture> all;
  for (const std::string& kind : kinds) all.push_back(take(part_texture(kind), camera, T_plane_camera, perspective));
  return all;
}

}  // namespace pickcell::sim
