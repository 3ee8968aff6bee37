#pragma once
/// Position data as a Yaskawa controller stores it, and its meaning as a pose: R = Rz * Ry * Rx (docs/yaskawa-protocols
/// 5).

#include <Eigen/Geometry>
#include <array>
#include <cstdint>

namespace pickcell::sim {

/// Frame number of positions in the frame of the tool: beyond every user frame. Only HSES can write them.
constexpr int kToolFrame = 1000;

/// A P variable or taught position.
struct Position {
  bool pulse = false;
  int frame = 0;                       ///< cartesian: 0 base, 1 robot, 2.. user 1.., kToolFrame
  std::array<std::int32_t, 6> axis{};  ///< pulses S L U R B T, or X Y Z in 0.001 mm and Rx Ry Rz in 0.0001 deg
  int form = 0;                        ///< bits in the order of TCP port 80
  int tool = 0;
  std::uint32_t extended_form = 0;          ///< as written over HSES; means nothing to a six-axis arm
  std::array<std::int32_t, 2> more_axes{};  ///< seventh and eighth axis, the same
  bool operator==(const Position&) const = default;
};

using Cartesian = std::array<std::int32_t, 6>;

/// The pose that a cartesian position means in its own frame, metres.
[[nodiscard]] Eigen::Isometry3d pose_from_cartesian(const Cartesian& axis);
/// Rounded to the controller's units. At Ry = +-90, where Rx and Rz turn about one axis, Rz is 0.
[[nodiscard]] Cartesian cartesian_from_pose(const Eigen::Isometry3d& pose);

}  // namespace pickcell::sim
