#pragma once
/// Positions as Yaskawa controllers name them: millimetres, degrees (R = Rz*Ry*Rx), a form and a tool, or pulses.
/// Protocol-neutral; each codec puts them on the wire. Source: docs/yaskawa-protocols.md 1.3, 1.6, 2.5, 5.

#include <array>
#include <cstdint>
#include <optional>
#include <variant>

namespace pickcell::robot {

/// Which of the arm's solutions for a pose is meant. The protocols order these bits differently.
struct Form {
  bool no_flip = false, elbow_below = false, back = false;
  bool r_over_180 = false, t_over_180 = false, s_over_180 = false;
  bool operator==(const Form&) const = default;
};

/// Coordinate frame numbers inside RPOSC and P data: 0 base, 1 robot, 2.. user frame 1.. .
constexpr int kBaseFrame = 0;
constexpr int kRobotFrame = 1;
constexpr int kMaxFrame = 65;  ///< user 64
constexpr int kMaxTool = 63;

/// Tool centre point in a frame of the controller.
struct CartesianPosition {
  int frame = kBaseFrame;
  double x_mm = 0, y_mm = 0, z_mm = 0;
  double rx_deg = 0, ry_deg = 0, rz_deg = 0;  ///< R = Rz*Ry*Rx
  std::optional<double> re_deg;               ///< arms with seven axes only
  Form form;
  int tool = 0;
  bool operator==(const CartesianPosition&) const = default;
};

/// Axes S L U R B T.
struct PulsePosition {
  std::array<std::int32_t, 6> pulses{};
  int tool = 0;
  bool operator==(const PulsePosition&) const = default;
};

using VariablePosition = std::variant<CartesianPosition, PulsePosition>;

}  // namespace pickcell::robot
