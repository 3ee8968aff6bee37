#pragma once
/// Where the flange is for given joints, on the PC's side: MotoROS speaks of joints only, and what is sent must be
/// known to stay in the workspace. Source: docs/yaskawa-protocols.md section 5 (the vendor's URDF models).

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>

#include "pickcell/core/transform.hpp"

namespace pickcell::robot {

/// S, L, U, R, B, T in radians, positive as the controller's pulses.
using ArmJoints = Eigen::Matrix<double, 6, 1>;

/// One arm with a spherical wrist; its base frame is the controller's. Lengths in metres.
struct ArmGeometry {
  std::string_view model;  ///< as in CELL.toml: gp7, gp8, motomini
  double s_to_l_m, l_to_u_m, u_to_b_x_m, u_to_b_z_m, b_to_flange_m;
  double b_zero_rad;  ///< B when forearm and flange are in line
  ArmJoints lower_rad, upper_rad, max_speed_rad_s;
};

/// Empty for a model that is not known.
[[nodiscard]] const ArmGeometry* arm_geometry(std::string_view model);

using FlangeInBase = core::Transform<core::Base, core::Flange>;

[[nodiscard]] FlangeInBase flange_in_base(const ArmGeometry& arm, const ArmJoints& q);

/// Joints for a pose, on the way from `near` without a jump: the solution that small steps lead to (damped least
/// squares). Empty when it is out of reach, beyond a limit, or only another form of the arm has it.
[[nodiscard]] std::optional<ArmJoints> joints_near(const ArmGeometry& arm, const FlangeInBase& T_base_flange,
                                                   const ArmJoints& near);

}  // namespace pickcell::robot
