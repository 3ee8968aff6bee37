/// What a hand-eye result makes of the pictures on the board's plane: the errors a pick would have.

#include <cmath>

#include "pickcell/core/units.hpp"
#include "pickcell/poses/handeye_problem.hpp"

namespace pickcell::poses::detail {

namespace {

/// Seen points cast onto the board's plane, and where they belong.
struct Cast {
  std::vector<Eigen::Vector2d> hit_m, nominal_m;
};

Cast cast(const Lens& lens, const std::vector<Eigen::Vector2d>& board_m, const Station& station,
          const HandEye& result) {
  const Eigen::Isometry3d T_board_camera = ((station.move * result.X).inverse() * result.Y).inverse();
  const Eigen::Vector3d from = T_board_camera.translation();
  Cast out;
  for (std::size_t i = 0; i < station.view.ids.size(); ++i) {
    const auto ray = undistort(lens, station.view.pixels[i]);
    if (!ray) continue;
    const Eigen::Vector3d along = T_board_camera.linear() * Eigen::Vector3d(ray->x(), ray->y(), 1);
    out.hit_m.push_back((from - along * (from.z() / along.z())).head<2>());
    out.nominal_m.push_back(board_m[static_cast<std::size_t>(station.view.ids[i])]);
  }
  return out;
}

/// Mean distance of the points, and the rigid motion that they share.
OnPlane compare(const Cast& points) {
  OnPlane out;
  out.points = points.hit_m.size();
  if (points.hit_m.empty()) return out;
  const double n = static_cast<double>(points.hit_m.size());
  Eigen::Vector2d mean_hit = Eigen::Vector2d::Zero(), mean_nominal = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < points.hit_m.size(); ++i) {
    out.mean_mm += core::mm_from_m((points.hit_m[i] - points.nominal_m[i]).norm()) / n;
    mean_hit += points.hit_m[i] / n;
    mean_nominal += points.nominal_m[i] / n;
  }
  double dot = 0, cross = 0;
  for (std::size_t i = 0; i < points.hit_m.size(); ++i) {
    const Eigen::Vector2d a = points.nominal_m[i] - mean_nominal, b = points.hit_m[i] - mean_hit;
    dot += a.dot(b);
    cross += a.x() * b.y() - a.y() * b.x();
  }
  out.shift_mm = core::mm_from_m((mean_hit - mean_nominal).norm());
  out.turn_deg = core::deg_from_rad(std::atan2(cross, dot));
  return out;
}

}  // namespace

std::vector<OnPlane> on_plane(const Lens& lens, const std::vector<Eigen::Vector2d>& board_m, const Stations& stations,
                              const HandEye& result) {
  std::vector<OnPlane> out;
  for (const Station& s : stations) out.push_back(compare(cast(lens, board_m, s, result)));
  return out;
}

double mean_mm(const std::vector<OnPlane>& pictures) {
  double sum = 0, points = 0;
  for (const OnPlane& p : pictures) {
    sum += p.mean_mm * static_cast<double>(p.points);
    points += static_cast<double>(p.points);
  }
  return sum / std::max(1.0, points);
}

PickSigma pick_sigma(const std::vector<OnPlane>& pictures) {
  // X and Y have 12 parameters, of 6 that each picture gives.
  const double free = std::max(1.0, static_cast<double>(pictures.size()) - 2);
  double shift2 = 0, turn2 = 0;
  for (const OnPlane& p : pictures) {
    shift2 += p.shift_mm * p.shift_mm;
    turn2 += p.turn_deg * p.turn_deg;
  }
  return {std::sqrt(shift2 / (2 * free)), std::sqrt(turn2 / free)};
}

}  // namespace pickcell::poses::detail
