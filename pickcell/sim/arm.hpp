#pragma once
/// Dimensions, limits and speeds of the simulated arms (docs/yaskawa-protocols section 5, from the vendor's URDF
/// models).

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace pickcell::sim {

/// Joint angles S, L, U, R, B, T in radians; positive as positive pulses of the controller.
using Joints = Eigen::Matrix<double, 6, 1>;
/// The same in encoder pulses.
using Pulses = std::array<std::int32_t, 6>;

enum class ArmModel { gp7, gp8, motomini };
[[nodiscard]] std::string_view name(ArmModel model);
[[nodiscard]] std::optional<ArmModel> arm_model(std::string_view name);

/// One arm. The base frame is the controller's: at the height of the L axis, on the S axis.
struct Arm {
  ArmModel model;
  double floor_m;     ///< height of the base frame above the floor plate
  double s_to_l_m;    ///< along x
  double l_to_u_m;    ///< along z
  double u_to_b_x_m;  ///< elbow to wrist centre
  double u_to_b_z_m;
  double b_to_flange_m;
  double b_zero_rad;    ///< added to B to reach the common wrist geometry (forearm and flange in line at 0)
  Joints lower, upper;  ///< rad
  Joints max_speed;     ///< rad/s
  Joints pulses_per_rad;
};

[[nodiscard]] const Arm& arm(ArmModel model);

[[nodiscard]] Pulses pulses_from_joints(const Arm& arm, const Joints& q);
[[nodiscard]] Joints joints_from_pulses(const Arm& arm, const Pulses& pulses);
/// Inside the limits of every axis, with a tolerance of half a pulse.
[[nodiscard]] bool inside_limits(const Arm& arm, const Joints& q);

}  // namespace pickcell::sim
