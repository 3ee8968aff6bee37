#pragma once
/// The arm's state in words, and what in it keeps the cell from working. Pure functions.

#include <optional>
#include <string>
#include <vector>

#include "pickcell/cell/cell_port.hpp"
#include "pickcell/robot/robot.hpp"

namespace pickcell::cell {

/// Something that needs a person.
struct Hindrance {
  std::string code;    ///< of the alarm row: "ROBOT_HELD", ...
  std::string why;     ///< "the arm is held from the pendant"
  std::string remedy;  ///< what to do
};

/// Why picking cannot begin; the most basic reason first (mode before hold before alarm). Servo and a standing job are
/// no hindrance: starting switches them on.
[[nodiscard]] std::optional<Hindrance> hindrance_to_start(const robot::RobotState& state);

/// Why a running cell must stop: the above, or servo power gone, or the job standing still.
[[nodiscard]] std::optional<Hindrance> hindrance_to_run(const robot::RobotState& state);

/// "play, remote, servo on, running".
[[nodiscard]] std::string words(const robot::RobotState& state);

/// link: as the cell file names it.
[[nodiscard]] RobotView view_of(const robot::RobotState& state, const std::string& link);

/// "4107 (OUT OF RANGE), 1325" or "" when there is none.
[[nodiscard]] std::string words(const std::vector<robot::Alarm>& alarms);

}  // namespace pickcell::cell
