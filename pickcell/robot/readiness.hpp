#pragma once
/// What keeps a controller from starting a job or a move, in words for a person.

#include <string>
#include <vector>

#include "pickcell/robot/robot.hpp"

namespace pickcell::robot {

struct Hindrance {
  std::string what;
  std::string remedy;
};

/// In the order in which a person should remove them; none when a job may be started. Servo power is not one: it is
/// switched on by command.
[[nodiscard]] std::vector<Hindrance> hindrances(const RobotState& state);

}  // namespace pickcell::robot
