#pragma once
/// Position data as a Yaskawa controller stores it, and its meaning as a pose: R = Rz * Ry * Rx (docs/yaskawa-protocols
/// 5).

#include <Eigen/Geometry>
#include <array>
#include <cstdint>

namespace pickcell::sim {

/// A P variable or taught position.
struct Position {
  bool pulse = false;
  int frame = 0;                       ///< cartesian: 0 base, 1 robot, 2.. user 1..
  std::array<std::int32_t, 6> axis{};  ///< pulses S L U R B T, or X Y Z in 0.001 mm and Rx Ry Rz in 0.0001 deg
  int form = 0;                        ///< bits in the order of TCP port 80
  int tool = 0;
  bool operator==(const Position&) const = default;
};

using Cartesian = std::array<std::int32_t, 6>;

/// The pose that a cartesian position means in its own frame, metres.
[[nodiscard]] Eigen::Isometry3d pose_from_cartesian(const Cartesian& axis);
/// Rounded to the controller's units. At Ry = +-90, where Rx and Rz turn about one axis, Rz is 0.
[[nodiscard]] Cartesian cartesian_from_pose(const Eigen::Isometry3d& pose);

}  // namespace pickcell::sim
