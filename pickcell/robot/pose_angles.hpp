#pragma once
/// Between the cell's transforms (metres, rotation matrices) and the controller's X Y Z (mm) Rx Ry Rz (degrees,
/// R = Rz(rz) * Ry(ry) * Rx(rx)). Source: docs/yaskawa-protocols.md section 5.

#include "pickcell/core/transform.hpp"
#include "pickcell/robot/position.hpp"

namespace pickcell::robot {

/// Angles about x, y, z in degrees, R = Rz*Ry*Rx; rx and rz in (-180, 180], ry in [-90, 90].
struct ZyxAngles {
  double rx_deg = 0, ry_deg = 0, rz_deg = 0;
};

/// Near ry = +-90 only rz - rx (or rz + rx) is defined: rx is then 0. A tool straight down gives rx = 180, ry = 0.
[[nodiscard]] ZyxAngles zyx_angles(const Eigen::Matrix3d& rotation);
[[nodiscard]] Eigen::Matrix3d rotation(const ZyxAngles& angles);

/// Pose of the tool centre point; frame, form and tool are left at their defaults.
[[nodiscard]] CartesianPosition position_from(const core::Transform<core::Base, core::Tool>& T_base_tool);
[[nodiscard]] core::Transform<core::Base, core::Tool> transform_from(const CartesianPosition& position);

}  // namespace pickcell::robot
