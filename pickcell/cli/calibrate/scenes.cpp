#include "pickcell/cli/calibrate/scenes.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "pickcell/core/units.hpp"
#include "pickcell/poses/board_detect.hpp"
#include "pickcell/sim/random.hpp"

namespace pickcell::cli {

namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using poses::ArmView;
using poses::HandeyeInput;

/// A camera at `at` that looks at `target`, turned about its axis.
core::Transform<core::Base, core::Camera> looking_at(const Vector3d& at, const Vector3d& target, double roll_rad) {
  Eigen::Matrix3d R;
  R.col(2) = (target - at).normalized();
  R.col(0) = Vector3d::UnitY().cross(R.col(2)).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return {R * core::rotation_z(roll_rad), at};
}

poses::ArmPose as_euler(const Isometry3d& T, std::string image) {
  poses::ArmPose out;
  out.image = std::move(image);
  out.euler = true;
  out.position_m = T.translation();
  const Eigen::Matrix3d R = T.linear();
  out.angles_deg = Vector3d(std::atan2(R(2, 1), R(2, 2)), std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2))),
                            std::atan2(R(1, 0), R(0, 0))) *
                   core::deg_from_rad(1);
  return out;
}

poses::BoardView projected(const HandeyeScene& scene, std::size_t i, double noise_px, sim::Random& random) {
  poses::BoardView view;
  view.width_px = scene.camera.width_px;
  view.height_px = scene.camera.height_px;
  const auto points = poses::board_points_m(scene.board);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vector3d p = (scene.T_camera_board(i) * core::Point<core::Board>{{points[k].x(), points[k].y(), 0}}).m;
    view.ids.push_back(static_cast<int>(k));
    view.pixels.push_back(sim::project(scene.camera, p) + noise_px * Eigen::Vector2d(random.normal(), random.normal()));
  }
  return view;
}

sim::BoardPattern pattern_of(const poses::Board& board) {
  using Kind = sim::BoardPattern::Kind;
  sim::BoardPattern out{.cols = board.point_cols(), .rows = board.point_rows(), .spacing_m = board.spacing_m};
  switch (board.kind) {
    case poses::BoardKind::chessboard:
      break;
    case poses::BoardKind::circles:
      out.kind = Kind::dots;
      break;
    case poses::BoardKind::asymmetric_circles:
      out.kind = Kind::staggered_dots;
      break;
    case poses::BoardKind::charuco:
      out.kind = Kind::charuco;
      out.marker_m = board.marker_m;
      out.markers = *poses::marker_bits(board);
      break;
  }
  out.dot_radius_m = 0.3 * board.spacing_m;
  return out;
}

HandeyeInput empty_input(const HandeyeScene& scene) {
  HandeyeInput out;
  out.lens = lens_of(scene.camera);
  out.board = scene.board;
  return out;
}

void turn_pose(poses::ArmPose& arm, double deg) {
  Isometry3d T = arm.pose();
  T.linear() = T.linear() * Eigen::AngleAxisd(core::rad_from_deg(deg), Vector3d(1, 2, 0.5).normalized());
  arm = as_euler(T, arm.image);
}

void one_axis_only(HandeyeInput& input) {
  // Every camera pose turned about the first one's vertical: the arm's wrist alone moves.
  const Isometry3d first = input.views[0].arm.pose();
  for (std::size_t i = 0; i < input.views.size(); ++i) {
    Isometry3d T = first;
    T.linear() = core::rotation_z(0.2 * static_cast<double>(i)) * first.linear();
    T.translation() += Vector3d(0.01 * static_cast<double>(i), 0, 0);
    input.views[i].arm = as_euler(T, input.views[i].arm.image);
  }
}

void mirror(HandeyeInput& input) {
  std::vector<int> reversed;
  for (int row = 0; row < 6; ++row)
    for (int col = 0; col < 9; ++col) reversed.push_back(row * 9 + 8 - col);
  for (ArmView& v : input.views) {
    for (auto& p : v.picture.view.pixels) p.x() = v.picture.view.width_px - 1 - p.x();
    v.picture.view = poses::renumbered(v.picture.view, reversed);
  }
}

void invert(HandeyeInput& input) {
  for (ArmView& v : input.views) v.arm = as_euler(v.arm.pose().inverse(Eigen::Isometry), v.arm.image);
}

/// One of the poses, by the seed.
poses::ArmPose& any(HandeyeInput& input, std::uint64_t seed) { return input.views[seed % input.views.size()].arm; }

/// The names of the pictures stay.
void swap_poses(poses::ArmPose& a, poses::ArmPose& b) {
  std::swap(a, b);
  std::swap(a.image, b.image);
}

void scale_angles(HandeyeInput& input, double factor) {
  for (ArmView& v : input.views) v.arm.angles_deg *= factor;
}

/// What a controller writes whose angles are those of R = Rx * Ry * Rz.
void as_fixed_xyz(HandeyeInput& input) {
  for (ArmView& v : input.views) {
    const Eigen::Matrix3d R = v.arm.pose().linear();
    v.arm.angles_deg = Vector3d(std::atan2(-R(1, 2), R(2, 2)), std::atan2(R(0, 2), std::hypot(R(1, 2), R(2, 2))),
                                std::atan2(-R(0, 1), R(0, 0))) *
                       core::deg_from_rad(1);
  }
}

/// w stands under the title qx, and so on.
void scalar_first(HandeyeInput& input) {
  for (ArmView& v : input.views) {
    const Eigen::Quaterniond q(v.arm.pose().linear());
    v.arm.euler = false;
    v.arm.quaternion = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y());  // the last one is taken for w
  }
}

}  // namespace

core::Transform<core::Camera, core::Board> HandeyeScene::T_camera_board(std::size_t i) const {
  return (T_base_flange[i] * T_flange_camera).inverse() * T_base_board;
}

poses::Lens lens_of(const sim::Intrinsics& camera) {
  poses::Lens out{camera.width_px, camera.height_px, camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px, {}};
  std::copy(camera.distortion.begin(), camera.distortion.end(), out.distortion.begin());
  return out;
}

HandeyeScene handeye_scene(std::uint64_t seed, int stations, const std::string& board) {
  HandeyeScene out;
  out.board = *poses::parse_board(board);
  out.pattern = pattern_of(out.board);
  out.camera = {.width_px = 800,
                .height_px = 600,
                .fx_px = 1012.4,
                .fy_px = 1010.9,
                .cx_px = 402.3,
                .cy_px = 296.8,
                .distortion = {-0.18, 0.09, 0.0007, -0.0005, 0.0}};
  sim::Random random(seed);
  out.T_flange_camera = {
      (Eigen::AngleAxisd(0.7, Vector3d::UnitZ()) * Eigen::AngleAxisd(0.05, Vector3d::UnitX())).toRotationMatrix(),
      {0.03, -0.06, 0.045}};
  const Eigen::Matrix3d face_up = Vector3d(1, -1, -1).asDiagonal();
  out.T_base_board = {core::rotation_z(0.3) * face_up, {0.55, 0.1, 0.02}};
  const Eigen::Vector2d half = 0.5 * poses::board_points_m(out.board).back();
  const Vector3d centre = (out.T_base_board * core::Point<core::Board>{{half.x(), half.y(), 0}}).m;
  for (int i = 0; i < stations; ++i) {
    const double around = 2 * core::kPi * (i + random.unit()) / stations, tilt = random.uniform(0.15, 0.6);
    const double far = random.uniform(0.46, 0.58);
    const Vector3d at =
        centre + far * Vector3d(std::sin(tilt) * std::cos(around), std::sin(tilt) * std::sin(around), std::cos(tilt));
    const Vector3d aim = centre + Vector3d(random.uniform(-0.02, 0.02), random.uniform(-0.015, 0.015), 0);
    const auto T_base_camera = looking_at(at, aim, random.uniform(-0.6, 0.6));
    out.T_base_flange.push_back(T_base_camera * out.T_flange_camera.inverse());
  }
  return out;
}

HandeyeInput with_noisy_corners(const HandeyeScene& scene, double noise_px, std::uint64_t seed) {
  HandeyeInput out = empty_input(scene);
  sim::Random random(seed);
  for (std::size_t i = 0; i < scene.T_base_flange.size(); ++i) {
    const std::string image = std::to_string(i) + ".png";
    out.views.push_back(
        {{image, projected(scene, i, noise_px, random)}, as_euler(scene.T_base_flange[i].iso(), image)});
  }
  return out;
}

HandeyeInput with_pictures(const HandeyeScene& scene, std::uint64_t seed) {
  HandeyeInput out = empty_input(scene);
  for (std::size_t i = 0; i < scene.T_base_flange.size(); ++i) {
    const std::string image = std::to_string(i) + ".png";
    const image::Image picture =
        sim::board_picture(scene.camera, scene.pattern, scene.T_camera_board(i), {.seed = seed + i});
    if (auto view = poses::detect_board(picture.view(), out.board, image))
      out.views.push_back({{image, *view}, as_euler(scene.T_base_flange[i].iso(), image)});
  }
  return out;
}

TransformError error_of(const Isometry3d& found, const Isometry3d& truth) {
  const Eigen::AngleAxisd turn(truth.linear().transpose() * found.linear());
  return {core::mm_from_m((found.translation() - truth.translation()).norm()),
          core::deg_from_rad(std::abs(core::wrap_rad(turn.angle())))};
}

void scatter(HandeyeInput& input, double mm, double deg, std::uint64_t seed) {
  sim::Random random(seed + 77);
  for (ArmView& v : input.views) {
    v.arm.position_m += 1e-3 * mm * Vector3d(random.normal(), random.normal(), random.normal());
    if (deg > 0) turn_pose(v.arm, deg * random.normal());
  }
}

std::vector<PoseFault> pose_faults() {
  using In = HandeyeInput;
  using Seed = std::uint64_t;
  return {
      {"every pose off by 2 mm", {"pose error"}, [](In& in, Seed seed) { scatter(in, 2, 0, seed); }},
      {"every pose off by 1 deg", {"pose error"}, [](In& in, Seed seed) { scatter(in, 0, 1, seed); }},
      {"one pose off by 5 mm", {"mm and"}, [](In& in, Seed seed) { any(in, seed).position_m.x() += 0.005; }},
      {"one pose off by 1 deg", {"deg off"}, [](In& in, Seed seed) { turn_pose(any(in, seed), 1); }},
      {"two rows swapped",
       {"swapped"},
       [](In& in, Seed seed) { swap_poses(any(in, seed), any(in, seed + in.views.size() / 2)); }},
      {"rows shifted by one",
       {"shifted by one"},
       [](In& in, Seed) {
         for (std::size_t i = 1; i < in.views.size(); ++i) swap_poses(in.views[i - 1].arm, in.views[i].arm);
       }},
      {"degrees read as radians", {"read as radians"}, [](In& in, Seed) { scale_angles(in, core::deg_from_rad(1)); }},
      {"radians where degrees belong", {"in radians"}, [](In& in, Seed) { scale_angles(in, core::rad_from_deg(1)); }},
      {"mm given as m",
       {"millimetres were given as metres"},
       [](In& in, Seed) {
         for (ArmView& v : in.views) v.arm.position_m *= 1e3;
       }},
      {"rotations about one axis only", {"one axis only"}, [](In& in, Seed) { one_axis_only(in); }},
      {"angles meant as Rx*Ry*Rz", {"order of the rotations"}, [](In& in, Seed) { as_fixed_xyz(in); }},
      {"quaternions with w first", {"w, x, y, z"}, [](In& in, Seed) { scalar_first(in); }},
      {"pictures mirrored", {"mirrored"}, [](In& in, Seed) { mirror(in); }},
      {"poses inverted", {"inverted"}, [](In& in, Seed) { invert(in); }},
      {"squares of 26 mm called 25 mm",
       {"squares are", "stand apart"},
       [](In& in, Seed) { in.board.spacing_m *= 25.0 / 26.0; }},
  };
}

PlaneError plane_error(double noise_px, std::uint64_t seed) {
  sim::Random random(seed);
  const HandeyeScene scene = handeye_scene(seed, 1);
  const auto points = poses::board_points_m(scene.board);
  const auto in_base = [&](std::size_t i) {
    return scene.T_base_board * core::Point<core::Board>{{points[i].x(), points[i].y(), 0}};
  };
  std::vector<poses::TouchedCorner> touched;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int cols = scene.board.point_cols(), id = static_cast<int>(i);
    touched.push_back({id % cols, id / cols, in_base(i).m});
  }
  const poses::Lens lens = lens_of(scene.camera);
  const poses::BoardView noisy = projected(scene, 0, noise_px, random), exact = projected(scene, 0, 0, random);
  const auto fit = poses::plane_from_touched_board(lens, scene.board, noisy, touched, 0);
  if (!fit) return {1e9, 1e9};
  const auto& T = fit->calibration;
  PlaneError out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto ray = poses::undistort(lens, exact.pixels[i]);
    if (!ray) return {1e9, 1e9};
    const Vector3d n = T.T_base_plane.rotation().col(2), at = T.T_base_plane.translation_m();
    const Vector3d from = T.T_base_camera.translation_m();
    const Vector3d along = T.T_base_camera.rotation() * Vector3d(ray->x(), ray->y(), 1);
    const Vector3d hit = from + along * (n.dot(at - from) / n.dot(along));
    const double mm = core::mm_from_m((hit - in_base(i).m).norm());
    out.mean_mm += mm / static_cast<double>(points.size());
    out.worst_mm = std::max(out.worst_mm, mm);
  }
  return out;
}

TransformError expected_error(const HandeyeScene& scene, double noise_px) {
  const auto points = poses::board_points_m(scene.board);
  const auto pixels = [&](const Isometry3d& X, const Isometry3d& Y) {
    Eigen::VectorXd out(static_cast<Eigen::Index>(2 * points.size() * scene.T_base_flange.size()));
    Eigen::Index at = 0;
    for (const auto& T_base_flange : scene.T_base_flange) {
      const Isometry3d T = (T_base_flange.iso() * X).inverse(Eigen::Isometry) * Y;
      for (const auto& b : points) {
        out.segment<2>(at) = sim::project(scene.camera, T * Vector3d(b.x(), b.y(), 0));
        at += 2;
      }
    }
    return out;
  };
  const auto moved = [](Isometry3d T, int k, double step) {
    Vector3d d = Vector3d::Zero();
    d[k % 3] = step;
    if (k < 3)
      T.translation() += d;
    else
      T.linear() = T.linear() * Eigen::AngleAxisd(step, Vector3d::Unit(k % 3)).toRotationMatrix();
    return T;
  };
  const Isometry3d X = scene.T_flange_camera.iso(), Y = scene.T_base_board.iso();
  constexpr double kStep = 1e-6;
  Eigen::MatrixXd J(pixels(X, Y).size(), 12);
  for (int k = 0; k < 6; ++k) {
    J.col(k) = (pixels(moved(X, k, kStep), Y) - pixels(moved(X, k, -kStep), Y)) / (2 * kStep);
    J.col(6 + k) = (pixels(X, moved(Y, k, kStep)) - pixels(X, moved(Y, k, -kStep))) / (2 * kStep);
  }
  const Eigen::MatrixXd covariance = noise_px * noise_px * (J.transpose() * J).inverse();
  return {core::mm_from_m(std::sqrt(covariance.diagonal().head<3>().sum())),
          core::deg_from_rad(std::sqrt(covariance.diagonal().segment<3>(3).sum()))};
}

}  // namespace pickcell::cli
