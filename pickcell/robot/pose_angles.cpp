#include "pickcell/robot/pose_angles.hpp"

#include <cmath>

#include "pickcell/core/units.hpp"

namespace pickcell::robot {

using core::deg_from_rad;
using core::rad_from_deg;
using core::wrap_deg;

ZyxAngles zyx_angles(const Eigen::Matrix3d& r) {
  constexpr double kDegenerate = 1e-9;  // cos(ry) below this: rx and rz turn about the same axis
  const double cos_ry = std::hypot(r(0, 0), r(1, 0));
  ZyxAngles out;
  out.ry_deg = deg_from_rad(std::atan2(-r(2, 0), cos_ry));
  if (cos_ry > kDegenerate) {
    // rx is what is left after rz, so that near +-90 the error of rz does not add up
    const double rz = std::atan2(r(1, 0), r(0, 0)), s = std::sin(rz), c = std::cos(rz);
    out.rz_deg = wrap_deg(deg_from_rad(rz));
    out.rx_deg = wrap_deg(deg_from_rad(std::atan2(s * r(0, 2) - c * r(1, 2), c * r(1, 1) - s * r(0, 1))));
  } else {
    out.rz_deg = wrap_deg(deg_from_rad(std::atan2(-r(0, 1), r(1, 1))));
  }
  return out;
}

Eigen::Matrix3d rotation(const ZyxAngles& a) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  return (AngleAxisd(rad_from_deg(a.rz_deg), Vector3d::UnitZ()) *
          AngleAxisd(rad_from_deg(a.ry_deg), Vector3d::UnitY()) * AngleAxisd(rad_from_deg(a.rx_deg), Vector3d::UnitX()))
      .toRotationMatrix();
}

CartesianPosition position_from(const core::Transform<core::Base, core::Tool>& T_base_tool) {
  const Eigen::Vector3d t_m = T_base_tool.translation_m();
  const ZyxAngles angles = zyx_angles(T_base_tool.rotation());
  CartesianPosition p;
  p.x_mm = core::mm_from_m(t_m.x()), p.y_mm = core::mm_from_m(t_m.y()), p.z_mm = core::mm_from_m(t_m.z());
  p.rx_deg = angles.rx_deg, p.ry_deg = angles.ry_deg, p.rz_deg = angles.rz_deg;
  return p;
}

core::Transform<core::Base, core::Tool> transform_from(const CartesianPosition& p) {
  return {rotation(ZyxAngles{p.rx_deg, p.ry_deg, p.rz_deg}),
          Eigen::Vector3d(core::m_from_mm(p.x_mm), core::m_from_mm(p.y_mm), core::m_from_mm(p.z_mm))};
}

}  // namespace pickcell::robot
