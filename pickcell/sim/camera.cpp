#include "pickcell/sim/camera.hpp"

#include <algorithm>
#include <cmath>

#include "pickcell/core/units.hpp"

namespace pickcell::sim {

namespace {

constexpr std::size_t kRemembered = 1000;

core::Duration microseconds(double us) { return core::Duration(std::llround(us * 1e3)); }

SeenPart seen(const PartTruth& truth, const LaidPart& laid, const Perspective& perspective, const Intrinsics& camera) {
  const double h = laid.part->kind().height_mm;
  const auto pixel_of = [&](const Point2& part_mm) {
    const Point2 p = laid.to_plane(part_mm);
    return perspective.pixel({p.x(), p.y(), h});
  };
  const Eigen::Vector2d origin = pixel_of({0, 0}), along = pixel_of({0.5, 0}) - pixel_of({-0.5, 0});
  const auto inside = [&](const Point2& part_mm) {
    const Eigen::Vector2d q = pixel_of(part_mm);
    return q.x() >= 0 && q.y() >= 0 && q.x() <= camera.width_px - 1 && q.y() <= camera.height_px - 1;
  };
  const auto& rim = laid.part->rim();
  return {truth, origin.x(), origin.y(), core::deg_from_rad(std::atan2(-along.y(), along.x())),
          std::all_of(rim.begin(), rim.end(), inside)};
}

}  // namespace

CameraSettings default_camera(const core::Transform<core::Base, core::Plane>& T_base_plane, std::uint64_t seed) {
  CameraSettings settings;
  settings.seed = seed;
  settings.intrinsics = {.width_px = 1280,
                         .height_px = 1024,
                         .fx_px = 2561.3,
                         .fy_px = 2560.4,
                         .cx_px = 643.7,
                         .cy_px = 508.2,
                         .distortion = {-0.121, 0.083, 0.0006, -0.0004, 0.01}};
  Eigen::Matrix3d down;
  down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  const auto turn = [](double deg, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(core::rad_from_deg(deg), axis).toRotationMatrix();
  };
  const Eigen::Matrix3d R = down * turn(1.2, Eigen::Vector3d::UnitX()) * turn(-0.8, Eigen::Vector3d::UnitY()) *
                            turn(2.0, Eigen::Vector3d::UnitZ());
  const core::Transform<core::Plane, core::Camera> T_plane_camera(R, -0.8 * R.col(2));
  settings.T_base_camera = T_base_plane * T_plane_camera;
  settings.sensor = {.gain = 1.05,
                     .offset_grey = 3,
                     .gradient = 0.08,
                     .gradient_deg = 30,
                     .vignette = 0.12,
                     .noise_grey = 1.0,
                     .shot_noise_grey = 2.0};
  return settings;
}

CameraSettings resized(CameraSettings camera, int width_px, int height_px) {
  Intrinsics& in = camera.intrinsics;
  if (in.width_px == width_px && in.height_px == height_px) return camera;
  const double k = static_cast<double>(width_px) / in.width_px;
  in.fx_px *= k;
  in.fy_px *= k;
  in.cx_px = (in.cx_px + 0.5) * k - 0.5;
  in.cy_px = (in.cy_px + 0.5 - 0.5 * in.height_px) * k + 0.5 * height_px - 0.5;
  in.width_px = width_px;
  in.height_px = height_px;
  return camera;
}

SimulatedCamera::SimulatedCamera(CameraSettings settings, World& world, const core::Clock& clock)
    : settings_(std::move(settings)),
      world_(world),
      clock_(clock),
      perspective_(settings_.intrinsics, world.settings().T_base_plane.inverse() * settings_.T_base_camera,
                   seen_surface(settings_.surface, settings_.seed), settings_.light) {}

frames::SourceInfo SimulatedCamera::info() const {
  return {settings_.camera_id, settings_.intrinsics.width_px, settings_.intrinsics.height_px, true};
}

core::Result<frames::Frame> SimulatedCamera::grab(core::Seat& seat, core::Duration timeout) {
  const core::TimePoint begin = seat.now();
  const core::TimePoint middle = begin + microseconds(settings_.exposure_us / 2);
  const core::TimePoint done = begin + microseconds(settings_.exposure_us + settings_.readout_us);
  if (done - begin > timeout) {
    seat.sleep_until(begin + timeout);
    return core::failure(core::ErrorCode::timeout, settings_.camera_id, "no picture within the time given",
                         "allow at least exposure and readout time");
  }
  seat.sleep_until(middle);
  frames::Frame frame = expose_at(begin);
  seat.sleep_until(done);
  return frame;
}

frames::Frame SimulatedCamera::expose_at(core::TimePoint begin, std::optional<double> exposure_us, double gain_db) {
  const double lasts_us = exposure_us.value_or(settings_.exposure_us);
  const core::TimePoint middle = begin + microseconds(lasts_us / 2), end = begin + microseconds(lasts_us);
  frames::Frame frame;
  frame.sequence = ++sequence_;
  frame.exposed = middle;
  frame.exposed_unix_us =
      clock_.unix_us() + std::chrono::duration_cast<std::chrono::microseconds>(middle - clock_.now()).count();
  frame.encoder = std::llround(world_.belt_mm(middle) * settings_.counts_per_mm);
  frame.camera_id = settings_.camera_id;
  frame.simulated = true;
  remember(frame.sequence, middle);
  LightPlane light = smear(begin, end);
  blur(light, settings_.psf_sigma_px);
  SensorSettings sensor = settings_.sensor;
  sensor.gain *= lasts_us / settings_.exposure_us * std::pow(10.0, gain_db / 20);
  frame.picture =
      std::make_shared<const image::Image>(expose(light, sensor, mix(settings_.seed) ^ mix(frame.sequence)));
  return frame;
}

LightPlane SimulatedCamera::render(core::TimePoint t) {
  const WorldView view = world_.view(t);
  std::vector<LaidPart> parts;
  for (const auto& [id, laid] : view.parts) parts.push_back(laid);
  return perspective_.render(parts, view.surface_shift_mm);
}

LightPlane SimulatedCamera::smear(core::TimePoint begin, core::TimePoint end) {
  const double way_mm = world_.belt_mm(end) - world_.belt_mm(begin);
  const double px_per_mm = settings_.intrinsics.fx_px * 1e-3 /
                           (world_.settings().T_base_plane.inverse() * settings_.T_base_camera).translation_m().z();
  const int steps = std::clamp(static_cast<int>(std::ceil(1.5 * way_mm * px_per_mm)), 1, 24);
  if (steps == 1) return render(begin + (end - begin) / 2);
  LightPlane sum(settings_.intrinsics.width_px, settings_.intrinsics.height_px);
  for (int i = 0; i < steps; ++i) {
    const LightPlane part = render(begin + (end - begin) * (2 * i + 1) / (2 * steps));
    for (int y = 0; y < sum.height(); ++y)
      for (int x = 0; x < sum.width(); ++x) sum.at(x, y) += part.at(x, y) / static_cast<float>(steps);
  }
  return sum;
}

void SimulatedCamera::remember(std::uint64_t sequence, core::TimePoint t) {
  std::vector<SeenPart> all;
  for (const auto& [id, laid] : world_.view(t).parts)
    all.push_back(seen({id, laid.part->kind().name, world_.pose(laid)}, laid, perspective_, settings_.intrinsics));
  const std::lock_guard lock(mutex_);
  seen_.emplace_back(sequence, std::move(all));
  if (seen_.size() > kRemembered) seen_.pop_front();
}

std::vector<SeenPart> SimulatedCamera::truth(std::uint64_t sequence) const {
  const std::lock_guard lock(mutex_);
  for (const auto& [number, parts] : seen_)
    if (number == sequence) return parts;
  return {};
}

}  // namespace pickcell::sim
