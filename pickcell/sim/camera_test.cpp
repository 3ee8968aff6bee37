#include "pickcell/sim/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "pickcell/core/units.hpp"
#include "pickcell/sim/teach_picture.hpp"

namespace pickcell::sim {
namespace {

using core::duration_s;

/// The default camera with fewer pixels.
CameraSettings small_camera(const WorldSettings& world, double factor = 0.25) {
  CameraSettings camera = default_camera(world.T_base_plane, world.seed);
  Intrinsics& lens = camera.intrinsics;
  lens.width_px = static_cast<int>(lens.width_px * factor), lens.height_px = static_cast<int>(lens.height_px * factor);
  lens.fx_px *= factor, lens.fy_px *= factor;
  lens.cx_px = (lens.cx_px + 0.5) * factor - 0.5, lens.cy_px = (lens.cy_px + 0.5) * factor - 0.5;
  return camera;
}

TEST(CameraModel, ProjectsAsOpenCvDoes) {
  // cv::projectPoints of OpenCV 4.6 with the same numbers.
  const Intrinsics camera{.width_px = 1280,
                          .height_px = 1024,
                          .fx_px = 2561.3,
                          .fy_px = 2560.4,
                          .cx_px = 643.7,
                          .cy_px = 508.2,
                          .distortion = {-0.121, 0.083, 0.0006, -0.0004, 0.01}};
  const std::pair<Eigen::Vector3d, Eigen::Vector2d> known[] = {
      {{0, 0, 1}, {643.700000000, 508.200000000}},           {{0.25, 0.2, 1}, {1276.569239893, 1014.558933503}},
      {{-0.25, -0.2, 1}, {10.671959507, 2.196962097}},       {{0.3, -0.1, 1.2}, {1278.639693960, 296.710780502}},
      {{-0.02, 0.18, 0.8}, {579.979459885, 1081.089686090}}, {{0.11, -0.13, 0.7}, {1043.224595542, 36.219766443}},
      {{-0.21, 0.004, 0.83}, {0.258861507, 520.548844099}}};
  for (const auto& [p, pixel] : known) EXPECT_LT((project(camera, p) - pixel).norm(), 1e-6) << p.transpose();
}

TEST(CameraModel, RayUndoesProject) {
  const Intrinsics camera = default_camera({}, 1).intrinsics;
  for (int y = -20; y < camera.height_px + 20; y += 37)
    for (int x = -20; x < camera.width_px + 20; x += 41) {
      const Eigen::Vector2d pixel(x + 0.25, y - 0.5);
      EXPECT_LT((project(camera, 2.5 * ray(camera, pixel)) - pixel).norm(), 1e-9);
      const Eigen::Vector3d guess = ray(camera, pixel + Eigen::Vector2d(1, 0));
      EXPECT_LT((project(camera, ray(camera, pixel, &guess)) - pixel).norm(), 1e-9);
    }
}

TEST(CameraModel, DefaultSeesFourHundredMillimetres) {
  const WorldSettings world = default_world(1);
  const CameraSettings camera = default_camera(world.T_base_plane, 1);
  const auto T_plane_camera = world.T_base_plane.inverse() * camera.T_base_camera;
  const Eigen::Vector2d left = cast_mm(camera.intrinsics, T_plane_camera, {0, 511}, 0);
  const Eigen::Vector2d right = cast_mm(camera.intrinsics, T_plane_camera, {1279, 511}, 0);
  EXPECT_NEAR((right - left).norm(), 400, 15);
  // The whole area in which parts lie is in sight, whatever their height.
  for (const double z : {0.0, 15.0})
    for (const double x : {-180.0, 180.0})
      for (const double y : {-130.0, 130.0}) {
        const Eigen::Vector2d p =
            project(camera.intrinsics, T_plane_camera.inverse().iso() * (Eigen::Vector3d(x, y, z) * 1e-3));
        EXPECT_TRUE(p.x() > 5 && p.y() > 5 && p.x() < 1274 && p.y() < 1018) << p.transpose();
      }
}

/// The value of a picture between pixels.
double at(const image::Image& image, double x, double y) {
  const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
  const double u = x - ix, v = y - iy;
  return (1 - v) * ((1 - u) * image.at(ix, iy) + u * image.at(ix + 1, iy)) +
         v * ((1 - u) * image.at(ix, iy + 1) + u * image.at(ix + 1, iy + 1));
}

double correlation(const image::Image& scene, const TeachPicture& taught, double x, double y, double angle_deg,
                   double scale) {
  const double c = std::cos(core::rad_from_deg(angle_deg)), s = std::sin(core::rad_from_deg(angle_deg));
  double n = 0, st = 0, ss = 0, stt = 0, sss = 0, sts = 0;
  for (int ty = taught.roi_y; ty < taught.roi_y + taught.roi_h; ++ty)
    for (int tx = taught.roi_x; tx < taught.roi_x + taught.roi_w; ++tx) {
      if (taught.mask.at(tx, ty) == 0) continue;
      const double dx = scale * (tx - taught.ref_x_px), dy = scale * (ty - taught.ref_y_px);
      const double v = at(scene, x + c * dx + s * dy, y - s * dx + c * dy), t = taught.picture.at(tx, ty);
      n += 1, st += t, ss += v, stt += t * t, sss += v * v, sts += t * v;
    }
  return (n * sts - st * ss) / std::sqrt((n * stt - st * st) * (n * sss - ss * ss));
}

double top_of(double left, double middle, double right) { return 0.5 * (left - right) / (left - 2 * middle + right); }

TEST(SimulatedCamera, PartsAppearWhereTheTruthSays) {
  WorldSettings settings = default_world(11);
  settings.feed.kinds = {"label_box", "bracket_l", "gear_18"};
  World world(settings);
  core::SimulatedClock clock;
  const auto seat = clock.join("test");
  SimulatedCamera camera(small_camera(settings, 0.6), world, clock);
  const auto taught = take_teach_pictures(settings.feed.kinds, camera.settings(), settings.T_base_plane);
  const auto frame = camera.grab(*seat, duration_s(1));
  ASSERT_TRUE(frame);
  const auto truth = camera.truth(frame->sequence);
  ASSERT_GE(truth.size(), 5U);
  double sum_x = 0, sum_y = 0, sum_a = 0;
  for (const SeenPart& part : truth) {
    ASSERT_TRUE(part.complete);
    const auto of_kind =
        std::find_if(taught.begin(), taught.end(), [&](const auto& t) { return t.kind == part.truth.kind; });
    const auto ncc = [&](double dx, double dy, double da) {
      return correlation(*frame->picture, *of_kind, part.x_px + dx, part.y_px + dy, part.angle_deg + da, 1);
    };
    const double peak = ncc(0, 0, 0);
    const double off_x = top_of(ncc(-1, 0, 0), peak, ncc(1, 0, 0)), off_y = top_of(ncc(0, -1, 0), peak, ncc(0, 1, 0));
    EXPECT_GT(peak, 0.8) << part.truth.kind;
    EXPECT_LT(std::hypot(off_x, off_y), 0.45) << part.truth.kind << " " << off_x << " " << off_y;
    sum_x += off_x, sum_y += off_y, sum_a += top_of(ncc(0, 0, -1), peak, ncc(0, 0, 1));
  }
  const double n = static_cast<double>(truth.size());
  EXPECT_NEAR(sum_x / n, 0, 0.15);
  EXPECT_NEAR(sum_y / n, 0, 0.15);
  EXPECT_NEAR(sum_a / n, 0, 0.15);
}

TEST(SimulatedCamera, SpendsItsTimeOnTheClock) {
  const WorldSettings settings = default_world(1);
  World world(settings);
  core::SimulatedClock clock;
  const auto seat = clock.join("test");
  CameraSettings camera_settings = small_camera(settings);
  camera_settings.exposure_us = 5000, camera_settings.readout_us = 12000;
  SimulatedCamera camera(camera_settings, world, clock);
  seat->sleep_for(duration_s(2));
  const auto frame = camera.grab(*seat, duration_s(1));
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->sequence, 1U);
  EXPECT_TRUE(frame->simulated);
  EXPECT_EQ(frame->exposed, core::TimePoint(duration_s(2.0025)));
  EXPECT_EQ(seat->now(), core::TimePoint(duration_s(2.017)));
  EXPECT_EQ(clock.unix_us() - frame->exposed_unix_us, 14500);
  EXPECT_EQ(frame->encoder, 0);
  EXPECT_EQ(camera.info().width_px, 320);
  EXPECT_EQ(frame->picture->width(), 320);
  const auto late = camera.grab(*seat, duration_s(0.01));
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, core::ErrorCode::timeout);
  EXPECT_EQ(seat->now(), core::TimePoint(duration_s(2.027)));
}

bool same(const image::Image& a, const image::Image& b) {
  for (int y = 0; y < a.height(); ++y)
    if (std::memcmp(a.row(y), b.row(y), static_cast<std::size_t>(a.width())) != 0) return false;
  return true;
}

TEST(SimulatedCamera, SameSeedSamePictures) {
  const auto pictures = [](std::uint64_t seed) {
    const WorldSettings settings = default_world(seed);
    World world(settings);
    core::SimulatedClock clock;
    const auto seat = clock.join("test");
    SimulatedCamera camera(small_camera(settings), world, clock);
    std::vector<std::shared_ptr<const image::Image>> out;
    for (int i = 0; i < 3; ++i) {
      if (i == 1) world.contact_written(kFeedAdvanceContact, true, clock.now());
      out.push_back(camera.grab(*seat, duration_s(1))->picture);
    }
    return out;
  };
  const auto a = pictures(5), b = pictures(5), c = pictures(6);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(same(*a[i], *b[i])) << i;
  EXPECT_FALSE(same(*a[0], *c[0]));
  EXPECT_FALSE(same(*a[0], *a[1]));
}

TEST(SimulatedCamera, PickedPartVanishes) {
  const WorldSettings settings = default_world(12);
  World world(settings);
  core::SimulatedClock clock;
  const auto seat = clock.join("test");
  CameraSettings camera_settings = small_camera(settings);
  camera_settings.sensor.noise_grey = 0, camera_settings.sensor.shot_noise_grey = 0;
  SimulatedCamera camera(camera_settings, world, clock);
  const auto before = camera.grab(*seat, duration_s(1));
  const SeenPart part = camera.truth(1).front();
  world.output_changed(kGripperOutput, true, part.truth.T_base_part * grasp_pose(part_kind(part.truth.kind).grasps[0]),
                       clock.now());
  ASSERT_TRUE(world.held());
  const auto after = camera.grab(*seat, duration_s(1));
  EXPECT_EQ(camera.truth(2).size() + 1, camera.truth(1).size());
  double far_change = 0, near_change = 0;
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 320; ++x) {
      const double change = std::abs(before->picture->at(x, y) - after->picture->at(x, y));
      double& which = std::hypot(x - part.x_px, y - part.y_px) < 45 ? near_change : far_change;
      which = std::max(which, change);
    }
  EXPECT_GT(near_change, 40);
  EXPECT_EQ(far_change, 0);
}

/// Root mean square difference of a picture (gain 1, no noise) and light.
double difference(const image::Image& picture, const LightPlane& light) {
  double sum = 0;
  for (int y = 0; y < light.height(); ++y)
    for (int x = 0; x < light.width(); ++x)
      sum += std::pow(picture.at(x, y) - 255 * std::min(1.0, static_cast<double>(light.at(x, y))), 2);
  return std::sqrt(sum / (light.width() * light.height()));
}

TEST(SimulatedCamera, MovingBeltSmearsByItsWayInTheExposure) {
  WorldSettings settings = default_world(13);
  settings.feed.speed_mm_s = 250;
  World world(settings);
  core::SimulatedClock clock;
  const auto seat = clock.join("test");
  CameraSettings camera_settings = small_camera(settings, 0.5);
  camera_settings.exposure_us = 30000;  // 7.5 mm of belt, 12 px
  camera_settings.psf_sigma_px = 0;
  camera_settings.sensor = {.noise_grey = 0};
  SimulatedCamera camera(camera_settings, world, clock);
  world.contact_written(kFeedAdvanceContact, true, clock.now());
  seat->sleep_for(duration_s(0.3));
  const auto frame = camera.grab(*seat, duration_s(1));
  ASSERT_TRUE(frame);
  EXPECT_EQ(*frame->encoder, std::llround(250 * 0.315 * 10));

  Perspective still(camera_settings.intrinsics, settings.T_base_plane.inverse() * camera_settings.T_base_camera,
                    seen_surface(camera_settings.surface, camera_settings.seed), camera_settings.light);
  const WorldView view = world.view(frame->exposed);
  std::vector<LaidPart> parts;
  for (const auto& [id, laid] : view.parts) parts.push_back(laid);
  const Eigen::Vector2d way = still.pixel({3.75, 0, 0}) - still.pixel({-3.75, 0, 0});
  const auto smeared_by = [&](double factor) {
    LightPlane light = still.render(parts, view.surface_shift_mm);
    motion_blur(light, factor * way.norm(), core::deg_from_rad(std::atan2(-way.y(), way.x())));
    return difference(*frame->picture, light);
  };
  EXPECT_NEAR(way.norm(), 12, 0.3);
  EXPECT_LT(smeared_by(1), 2);
  EXPECT_LT(smeared_by(1), 0.6 * smeared_by(0.7));
  EXPECT_LT(smeared_by(1), 0.6 * smeared_by(1.3));
}

TEST(TeachPicture, MaskHasThePartsAreaAndGraspsTheirPlace) {
  const WorldSettings settings = default_world(1);
  const CameraSettings camera = small_camera(settings, 0.5);
  std::vector<std::string> kinds;
  for (const PartKind& kind : part_catalogue())
    if (kinds.size() < 6) kinds.push_back(kind.name);
  const auto all = take_teach_pictures(kinds, camera, settings.T_base_plane);
  ASSERT_EQ(all.size(), kinds.size());
  for (const TeachPicture& taught : all) {
    const PartKind& kind = part_kind(taught.kind);
    double pixels = 0;
    for (int y = 0; y < taught.mask.height(); ++y)
      for (int x = 0; x < taught.mask.width(); ++x) pixels += taught.mask.at(x, y) != 0 ? 1 : 0;
    const double px_per_mm = camera.intrinsics.fx_px / (800 - kind.height_mm);
    const double area = area_mm2(kind.outline, 0.25);
    EXPECT_NEAR(pixels / (px_per_mm * px_per_mm), area, 0.03 * area) << kind.name;
    EXPECT_NEAR(taught.ref_x_px, 319.5, 1e-6);
    EXPECT_NEAR(taught.ref_y_px, 255.5, 1e-6);
    EXPECT_TRUE(taught.roi_w >= 50 && taught.roi_w <= 150 && taught.roi_h >= 40 && taught.roi_h <= 150) << kind.name;
    const TaughtGrasp& g = kind.grasps[0];
    EXPECT_NEAR(taught.grasps[0].x_px, 319.5 + px_per_mm * g.x_mm, 0.3) << kind.name;
    EXPECT_NEAR(taught.grasps[0].y_px, 255.5 - px_per_mm * g.y_mm, 0.3) << kind.name;
    EXPECT_NEAR(core::wrap_deg(taught.grasps[0].angle_deg - g.angle_deg), 0, 0.15) << kind.name;
    EXPECT_EQ(taught.height_mm, kind.height_mm);
  }
}

}  // namespace
}  // namespace pickcell::sim
