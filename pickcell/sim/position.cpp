#include "pickcell/sim/position.hpp"

#include <cmath>

#include "pickcell/core/units.hpp"

namespace pickcell::sim {

namespace {

constexpr double kPerMetre = 1e6;   // 0.001 mm
constexpr double kPerDegree = 1e4;  // 0.0001 deg

std::int32_t angle_units(double rad) {
  return static_cast<std::int32_t>(std::lround(core::wrap_deg(core::deg_from_rad(rad)) * kPerDegree));
}

}  // namespace

Eigen::Isometry3d pose_from_cartesian(const Cartesian& axis) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  const auto angle = [&](std::size_t i) { return core::rad_from_deg(axis[i] / kPerDegree); };
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = (AngleAxisd(angle(5), Vector3d::UnitZ()) * AngleAxisd(angle(4), Vector3d::UnitY()) *
                   AngleAxisd(angle(3), Vector3d::UnitX()))
                      .toRotationMatrix();
  pose.translation() = Vector3d(axis[0], axis[1], axis[2]) / kPerMetre;
  return pose;
}

Cartesian cartesian_from_pose(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d r = pose.linear();
  const double cos_ry = std::hypot(r(0, 0), r(1, 0));
  const double ry = std::atan2(-r(2, 0), cos_ry);
  const bool degenerate = cos_ry < 1e-9;
  const double rx = degenerate ? std::atan2(-r(1, 2), r(1, 1)) : std::atan2(r(2, 1), r(2, 2));
  const double rz = degenerate ? 0 : std::atan2(r(1, 0), r(0, 0));
  Cartesian axis{};
  for (int i = 0; i < 3; ++i)
    axis[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(std::lround(pose.translation()[i] * kPerMetre));
  axis[3] = angle_units(rx);
  axis[4] = angle_units(ry);
  axis[5] = angle_units(rz);
  return axis;
}

}  // namespace pickcell::sim
