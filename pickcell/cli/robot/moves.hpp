#pragma once
/// Direct moves of `pickcell robot`, for commissioning: checked before anything is sent, slow, watched to their end.

#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/controller_link.hpp"

namespace pickcell::cli {

struct MoveLimits {
  bool allow_motion = false;
  double speed_pct = 2, most_pct = 5;      ///< joint moves
  double speed_mm_s = 20, most_mm_s = 50;  ///< straight lines
  double most_way_mm = 500;                ///< of one move
  double most_turn_deg = 90;
  std::optional<std::array<double, 6>> box_mm;  ///< x y z lowest, x y z highest, base frame
};

/// What nobody may go beyond, whatever the options say: the speed of teaching.
constexpr double kTopSpeed_mm_s = 250, kTopSpeed_pct = 25;

/// Limits that make no sense, or beyond the top speeds: usage.
[[nodiscard]] core::Status check_limits(const MoveLimits& limits);

/// safety: motion not allowed; refused: not remote, alarm, held, running, in words. Looks only.
[[nodiscard]] core::Status may_move(robot::ControllerLink& link, const MoveLimits& limits);

/// safety: `to` further from where the arm is than allowed, outside the box, or no number.
[[nodiscard]] core::Status check_target(const robot::CartesianPosition& from, const robot::CartesianPosition& to,
                                        const MoveLimits& limits);

/// A line whose turn would be quicker than kTurnSpeed_deg_s at the speed of the way is given the turn's speed instead.
constexpr double kTurnSpeed_deg_s = 5;
void set_line_speed(robot::DirectMove& move, double way_mm, double turn_deg, const MoveLimits& limits);

struct Moved {
  robot::CartesianPosition at;  ///< base frame
  double took_s = 0;
};

/// Switches the servo on, orders the move once, watches it. After a lost answer, an alarm, a hold, Ctrl-C or too long a
/// time the arm is held and the state read; nothing is ever ordered again.
[[nodiscard]] core::Result<Moved> move_and_watch(robot::ControllerLink& link, const robot::DirectMove& move,
                                                 double way_mm, double turn_deg);

/// mm between two places; degrees of the turn between them.
[[nodiscard]] double way_mm(const robot::CartesianPosition& a, const robot::CartesianPosition& b);
[[nodiscard]] double turn_deg(const robot::CartesianPosition& a, const robot::CartesianPosition& b);

}  // namespace pickcell::cli
