#include "pickcell/poses/locate.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "pickcell/core/units.hpp"

namespace pickcell::poses {

namespace {

using core::Base;
using core::ErrorCode;
using core::failure;
using core::Part;
using core::Plane;
using core::Tool;

/// x, y in the plane frame (m), rotation about the plane's normal (rad), log of metre per template pixel.
using State = Eigen::Vector4d;
/// Picture place of the reference point (px), angle (rad, counter-clockwise on the screen), log scale.
using Similarity = Eigen::Vector4d;

constexpr int kSamplesPerSide = 13;  ///< cell centres: their moments are those of the whole area to 0.6 %

/// Picture place of a point given in the plane frame.
Eigen::Vector2d picture_of(const View& view, const core::Transform<core::Camera, Plane>& T_camera_plane,
                           const Eigen::Vector3d& p_plane) {
  const Eigen::Vector3d p = (T_camera_plane * core::Point<Plane>{p_plane}).m;
  return project(view.lens, {p.x() / p.z(), p.y() / p.z()});
}

/// Template pixel offset (y down) to plane coordinates of a part at the state.
Eigen::Vector2d on_plane(const State& state, const Eigen::Vector2d& offset_px) {
  const double c = std::cos(state[2]), s = std::sin(state[2]), m_per_px = std::exp(state[3]);
  const double x = m_per_px * offset_px.x(), y = -m_per_px * offset_px.y();
  return {state[0] + c * x - s * y, state[1] + s * x + c * y};
}

/// Least-squares similarity from template offsets to their predicted pictures: what a matcher would report.
Similarity predicted_match(const View& view, const State& state, const std::vector<Eigen::Vector2d>& samples_px,
                           double height_m) {
  const auto T_camera_plane = view.T_base_camera.inverse() * view.T_base_plane;
  Eigen::Vector2d mean_t = Eigen::Vector2d::Zero(), mean_p = Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector2d> pictures;
  pictures.reserve(samples_px.size());
  for (const Eigen::Vector2d& t : samples_px) {
    const Eigen::Vector2d p = on_plane(state, t);
    pictures.push_back(picture_of(view, T_camera_plane, {p.x(), p.y(), height_m}));
    mean_t += t;
    mean_p += pictures.back();
  }
  mean_t /= static_cast<double>(samples_px.size());
  mean_p /= static_cast<double>(samples_px.size());
  double dot = 0, cross = 0, norm = 0;  // p = s R(a) t with R(a) = [[cos, sin], [-sin, cos]]
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Eigen::Vector2d t = samples_px[i] - mean_t, p = pictures[i] - mean_p;
    dot += t.dot(p);
    cross += t.y() * p.x() - t.x() * p.y();
    norm += t.squaredNorm();
  }
  const double a = std::atan2(cross, dot), s = std::hypot(cross, dot) / norm;
  Eigen::Matrix2d R;
  R << std::cos(a), std::sin(a), -std::sin(a), std::cos(a);
  const Eigen::Vector2d c = mean_p - s * R * mean_t;
  return {c.x(), c.y(), a, std::log(s)};
}

Eigen::Matrix4d jacobian(const View& view, const State& state, const std::vector<Eigen::Vector2d>& samples_px,
                         double height_m) {
  Eigen::Matrix4d J;
  const State step(1e-6, 1e-6, 1e-6, 1e-6);
  for (int i = 0; i < 4; ++i) {
    State up = state, down = state;
    up[i] += step[i];
    down[i] -= step[i];
    Similarity d = predicted_match(view, up, samples_px, height_m) - predicted_match(view, down, samples_px, height_m);
    d[2] = core::wrap_rad(d[2]);
    J.col(i) = d / (2 * step[i]);
  }
  return J;
}

}  // namespace

std::optional<Eigen::Vector2d> plane_point(const View& view, const Eigen::Vector2d& pixel, double height_m) {
  const auto direction = undistort(view.lens, pixel);
  if (!direction) return std::nullopt;
  const auto T_plane_camera = view.T_base_plane.inverse() * view.T_base_camera;
  const Eigen::Vector3d from = T_plane_camera.translation_m();
  const Eigen::Vector3d ray = T_plane_camera.rotation() * Eigen::Vector3d(direction->x(), direction->y(), 1);
  const double along = (height_m - from.z()) / ray.z();
  if (!(along > 0) || !std::isfinite(along)) return std::nullopt;
  return (from + along * ray).head<2>();
}

Locator::Locator(const matches::Model& model) : grasps_(model.grasps), height_m_(model.height_m) {
  const int w = model.picture.width(), h = model.picture.height();
  const Eigen::Vector2d ref(model.ref_x_px, model.ref_y_px);
  for (matches::Grasp& g : grasps_) {
    g.x_px -= ref.x();
    g.y_px -= ref.y();
  }
  corners_px_ = {Eigen::Vector2d(-0.5, -0.5) - ref, Eigen::Vector2d(w - 0.5, -0.5) - ref,
                 Eigen::Vector2d(w - 0.5, h - 0.5) - ref, Eigen::Vector2d(-0.5, h - 0.5) - ref};
  std::vector<Eigen::Vector2d> everywhere;
  for (int j = 0; j < kSamplesPerSide; ++j)
    for (int i = 0; i < kSamplesPerSide; ++i) {
      const double x = (i + 0.5) * w / kSamplesPerSide - 0.5, y = (j + 0.5) * h / kSamplesPerSide - 0.5;
      everywhere.emplace_back(Eigen::Vector2d(x, y) - ref);
      if (model.mask.empty() ||
          model.mask.at(static_cast<int>(std::max(0.0, x)), static_cast<int>(std::max(0.0, y))) >= 128)
        samples_px_.push_back(everywhere.back());
    }
  constexpr std::size_t kEnough = 12;  // a thin mask may slip between the grid points
  if (samples_px_.size() < kEnough) samples_px_ = everywhere;
}

core::Result<PartPose> Locator::locate(const matches::Match& match, const View& view) const {
  const auto outside = [&] {
    return failure(ErrorCode::negative, match.model, "the match does not lie on the calibrated plane",
                   "check the camera and plane calibration");
  };
  const double a = core::rad_from_deg(match.pose.angle_deg);
  const Eigen::Vector2d c(match.pose.x_px, match.pose.y_px);
  const auto at = plane_point(view, c, height_m_);
  const Eigen::Vector2d x_step(std::cos(a), -std::sin(a));  // one pixel along the part's x axis in the picture
  const auto beside = plane_point(view, c + x_step, height_m_);
  if (!at || !beside) return outside();
  const Eigen::Vector2d x_axis = *beside - *at;
  State state(at->x(), at->y(), std::atan2(x_axis.y(), x_axis.x()), std::log(x_axis.norm() * match.pose.scale));

  const Similarity wanted(c.x(), c.y(), a, std::log(match.pose.scale));
  constexpr double kLost_px = 1e-6;  // near the horizon the steps need not meet
  Eigen::Matrix4d J;
  double left_px = 0;
  for (int step = 0; step < 5; ++step) {  // quadratic convergence: two steps reach 1e-9 px
    Similarity error = wanted - predicted_match(view, state, samples_px_, height_m_);
    error[2] = core::wrap_rad(error[2]);
    J = jacobian(view, state, samples_px_, height_m_);
    state += J.fullPivLu().solve(error);
    left_px = error.norm();
    if (!state.allFinite()) return outside();
    if (left_px < 1e-9) break;
  }
  if (!(left_px < kLost_px) || !J.fullPivLu().isInvertible()) return outside();

  PartPose out;
  out.model = match.model;
  out.model_index = match.model_index;
  out.score = match.score;
  out.ambiguous_deg = match.ambiguous_deg;
  const core::Transform<Plane, Part> T_plane_part(core::rotation_z(state[2]), {state[0], state[1], height_m_});
  out.T_base_part = view.T_base_plane * T_plane_part;

  for (const matches::Grasp& g : grasps_) {
    const Eigen::Vector2d p = on_plane(state, {g.x_px, g.y_px});
    const Eigen::Vector3d p_base = (view.T_base_plane * core::Point<Plane>{{p.x(), p.y(), height_m_}}).m;
    const double along = state[2] + core::rad_from_deg(g.angle_deg);
    const Eigen::Vector3d x_base = view.T_base_plane.rotation() * Eigen::Vector3d(std::cos(along), std::sin(along), 0);
    const Eigen::Matrix3d down = Eigen::AngleAxisd(core::kPi, Eigen::Vector3d::UnitX()).toRotationMatrix();
    GraspPose grasp;
    grasp.T_base_tool =
        core::Transform<Base, Tool>(core::rotation_z(std::atan2(x_base.y(), x_base.x())) * down, p_base);
    grasp.T_part_tool = out.T_base_part.inverse() * grasp.T_base_tool;
    grasp.sym180 = g.sym180;
    out.grasps.push_back(grasp);
  }
  for (const Eigen::Vector2d& corner : corners_px_) {
    const Eigen::Vector2d p = on_plane(state, corner);
    out.outline_m.push_back((view.T_base_plane * core::Point<Plane>{{p.x(), p.y(), height_m_}}).m.head<2>());
  }

  // (x_px, y_px, angle_deg, scale) -> (x_px, y_px, rad, log scale) -> (x_m, y_m, rad)
  const Eigen::Vector4d to_similarity(1, 1, core::rad_from_deg(1), 1 / match.pose.scale);
  const Eigen::Matrix4d A = J.inverse() * to_similarity.asDiagonal();
  out.covariance = (A * match.covariance * A.transpose()).topLeftCorner<3, 3>();
  out.covariance(0, 0) += view.sigma_position_m * view.sigma_position_m;
  out.covariance(1, 1) += view.sigma_position_m * view.sigma_position_m;
  const Eigen::Vector2d arm = state.head<2>() - view.turns_about_m;
  const Eigen::Vector3d by_turn = view.sigma_turn_rad * Eigen::Vector3d(-arm.y(), arm.x(), 1);
  out.covariance += by_turn * by_turn.transpose();
  return out;
}

}  // namespace pickcell::poses
