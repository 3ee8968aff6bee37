#pragma once
/// What a host may order, whatever door it comes through, with the refusals of docs/yaskawa-protocols 2.7 in the order
/// of section 7, point 4 (remote, alarm, hold, mode, servo, moving, job).

#include <optional>
#include <string_view>

#include "pickcell/sim/controller_state.hpp"

namespace pickcell::sim {

/// Numbers as hosts see them: decimal digits over TCP, the same digits in hex over HSES.
enum class Refusal : int {
  none = 0,
  unknown_command = 1010,
  operand_count = 1011,
  operand_range = 1012,
  operand_length = 1013,
  moving = 2010,
  held_by_pendant = 2020,
  held_from_outside = 2040,
  held_by_command = 2050,
  alarm_or_error = 2060,
  wrong_mode = 2080,
  not_remote = 2100,
  not_loadable = 2120,
  servo_off = 3010,
  frame_not_taught = 3350,
  servo_cannot_go_on = 3450,
  no_such_job = 4040,
  no_job_set = 4060,
  position_missing = 4130,
};

/// Speed of a straight line: along the way, or of the turn.
struct LineSpeed {
  bool turning = false;
  double value = 0;  ///< mm/s or deg/s
};

[[nodiscard]] Refusal set_hold(ControllerState& state, bool on);
[[nodiscard]] Refusal reset_alarms(ControllerState& state);
[[nodiscard]] Refusal cancel_error(ControllerState& state);
[[nodiscard]] Refusal set_servo(ControllerState& state, bool on);
[[nodiscard]] Refusal set_mode(ControllerState& state, bool play);
[[nodiscard]] Refusal set_cycle(ControllerState& state, CycleMode mode);
[[nodiscard]] Refusal set_pendant_lock(ControllerState& state, bool on);
[[nodiscard]] Refusal show_message(ControllerState& state, std::string_view text);
/// With a name the job starts at its first line; without, the current job goes on.
[[nodiscard]] Refusal start(ControllerState& state, std::string_view job);
[[nodiscard]] Refusal select_job(ControllerState& state, std::string_view job, int line);
[[nodiscard]] Refusal set_master_job(ControllerState& state, std::string_view job);
/// A job name, or `*` for all.
[[nodiscard]] Refusal delete_job(ControllerState& state, std::string_view job);
/// fraction of the greatest speeds, (0, 1].
[[nodiscard]] Refusal move_joint(ControllerState& state, const Position& target, double fraction);
[[nodiscard]] Refusal move_line(ControllerState& state, const Position& target, LineSpeed speed);
/// Way and turn are given in the named frame's directions.
[[nodiscard]] Refusal move_by(ControllerState& state, int frame, const Cartesian& difference, int tool,
                              LineSpeed speed);
/// The same place in the base frame, when the position is in the frame of its tool as the arm stands now.
[[nodiscard]] std::optional<Position> from_tool_frame(const ControllerState& state, const Position& in_tool);
/// Writing variables and contacts needs remote as well: reading works without (section 1.0).
[[nodiscard]] Refusal may_write(const ControllerState& state);

}  // namespace pickcell::sim
