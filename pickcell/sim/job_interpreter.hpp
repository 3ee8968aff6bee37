#pragma once
/// Runs the master task of a controller state through simulated time: job instructions, moves, hold and resume.

#include "pickcell/sim/controller_state.hpp"

namespace pickcell::sim {

/// One interpolation tick: carries the move on by dt_s and, when it is done, goes on in the job. A job stops on the
/// path when motion is blocked (hold, alarm, servo off, teach) and is then no longer running; START carries it on.
/// Instructions without motion cost no time, but at most 50 of them are done in one tick, and an output ends it, so
/// that the plant sees outputs before the job looks at inputs again. Faults of the job raise an alarm.
void run_tick(ControllerState& state, double dt_s);

}  // namespace pickcell::sim
