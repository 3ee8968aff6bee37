/// The taught job over the whole work area of the simulated cell: no line of a pick runs into a limit, at any turn of
/// tool and place.

#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "pickcell/sim/controller_commands.hpp"
#include "pickcell/sim/job_interpreter.hpp"
#include "pickcell/sim/shipped_jobs.hpp"

namespace pickcell::sim {
namespace {

/// Fast enough for a grid: longer ticks than the controller's, the same paths.
constexpr double kTick_s = 0.02;

Position down(int x_mm, int y_mm, int z_mm, int rz_deg) {
  return {false, 0, {x_mm * 1000, y_mm * 1000, z_mm * 1000, 1800000, 0, rz_deg * 10000}, 0, 1};
}

/// False when it does not come about within a minute, or an alarm comes first.
bool run_until(ControllerState& s, const std::function<bool()>& reached, double* sag_m = nullptr) {
  for (double t = 0; t < 60 && s.alarms.empty(); t += kTick_s) {
    if (reached()) return true;
    run_tick(s, kTick_s);
    s.inputs[1] = s.outputs[1];
    if (sag_m && s.P[20] && s.P[23] && s.move && s.task.at.job->lines[s.task.at.line].op == Op::move_joint &&
        s.outputs[1])
      *sag_m =
          std::max(*sag_m, std::min(s.P[20]->axis[2], s.P[23]->axis[2]) * 1e-6 - s.T_base_tool().translation_m().z());
  }
  return false;
}

TEST(PickReach, TheTaughtJobPicksAndPlacesEverywhere) {
  ControllerSettings settings;
  settings.jobs = shipped_jobs();
  ControllerState s(settings);
  ASSERT_EQ(set_servo(s, true), Refusal::none);
  ASSERT_EQ(start(s, "VISPICK"), Refusal::none);
  std::int32_t sequence = 0;
  double sag_m = 0;
  int failed = 0, total = 0;
  std::string first;
  std::mt19937 random(11);
  const auto any = [&](int low, int high) { return std::uniform_int_distribution(low, high)(random); };
  for (; total < 400; ++total) {
    const int pick_turn = any(-179, 180), place_turn = any(-179, 180);
    s.P[10] = down(any(350, 600), any(-250, 250), any(-250, 60), pick_turn);
    s.P[11] = down(any(350, 600), any(-250, 250), any(-250, 60), place_turn);
    s.D[10] = s.D[13] = ++sequence;
    EXPECT_TRUE(run_until(s, [&] { return s.B[12] == 1; }));
    s.B[10] = 1;
    (void)run_until(s, [&] { return s.B[10] >= 3; }, &sag_m);
    if (s.B[10] == 3) continue;
    ++failed;
    if (first.empty() && !s.alarms.empty())
      first = std::to_string(s.alarms[0].code) + " line " + std::to_string(s.alarms[0].data) + " rz " +
              std::to_string(pick_turn) + " -> " + std::to_string(place_turn) + " T " +
              std::to_string(s.q[5] * 57.29578);
    for (int t = 0; t < 10; ++t) run_tick(s, kTick_s);
    s.reset_at_pendant();
    s.outputs.reset();
    s.inputs.reset();
    s.D[11] = s.D[12];
    s.B[10] = 0;
    ASSERT_FALSE(s.running()) << "refused with " << int{s.B[11]};
    ASSERT_EQ(set_servo(s, true), Refusal::none);
    ASSERT_EQ(start(s, "VISPICK"), Refusal::none);
  }
  EXPECT_LT(sag_m, 0.010);
  EXPECT_EQ(failed, 0) << "of " << total << "; first: " << first;
}

}  // namespace
}  // namespace pickcell::sim
