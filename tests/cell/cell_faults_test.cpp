/// Faults between cell and controller: the cell stops in a known state, says why, goes on after the operator resets; no
/// part is picked twice or lost from the record.

#include <atomic>
#include <set>

#include "demo_cell.hpp"
#include "pickcell/sim/controller_state.hpp"

namespace pickcell {
namespace {

using cell::Mode;
using cell::Snapshot;

class CellFaults : public DemoCell {
 protected:
  /// Does it once, in the cell's thread, while the n-th pick is under way and the gripper holds a part (or not).
  void during_pick(int n, bool holding, std::function<void(sim::Controller&)> fault) {
    each_change = [this, n, holding, fault = std::move(fault), done = false](const Snapshot& s) mutable {
      if (done || s.mode != Mode::running || s.counters.submitted != n || !s.step.starts_with("picking")) return;
      const sim::ControllerState state = setup_.plant->controller->copy_of_state();
      const bool taken = state.D[12] == state.D[10] && state.D[11] != state.D[10];  // accepted and not ended
      if (!taken || setup_.plant->world.held().has_value() != holding) return;
      done = true;
      fault(*setup_.plant->controller);
    };
  }

  /// Journal and world agree.
  void expect_nothing_lost_or_doubled() {
    setup_.cell->close();
    const auto rows = setup_.journal->newest_rows(10'000);
    ASSERT_TRUE(rows);
    int done = 0, unknown = 0;
    std::set<std::int32_t> sequences;
    for (const robot::JournalRow& row : *rows) {
      EXPECT_TRUE(sequences.insert(row.sequence).second);
      EXPECT_NE(row.state, robot::CommandState::intent) << "pick " << row.sequence << " was left open";
      EXPECT_NE(row.state, robot::CommandState::sent) << "pick " << row.sequence << " was left open";
      done += row.state == robot::CommandState::done;
      unknown += row.state == robot::CommandState::unknown;
    }
    const sim::WorldCounts counts = setup_.plant->world.counts(setup_.clock->now());
    std::set<std::uint64_t> placed;
    for (const sim::PlacedPart& part : setup_.plant->world.placed())
      EXPECT_TRUE(placed.insert(part.id).second) << "part " << part.id << " was placed twice";
    EXPECT_EQ(done, setup_.cell->snapshot().counters.placed);
    EXPECT_GE(counts.placed, done);
    EXPECT_LE(counts.placed, done + unknown) << "a part was moved that the journal does not know of";
    EXPECT_EQ(counts.taken, counts.placed + counts.dropped + counts.returned)
        << "every part that was gripped is somewhere";
    EXPECT_LE(counts.dropped + counts.returned, unknown);
    EXPECT_EQ(counts.empty, 0) << "the arm gripped where no part was any more";
  }

  /// Resets (twice where a person is asked to look first), starts, and lets the cell finish.
  void reset_start_finish(std::int64_t picks) {
    for (int tries = 0; tries < 3; ++tries) {
      each_change = nullptr;
      const auto before = setup_.cell->snapshot();
      ASSERT_TRUE(setup_.cell->reset());
      const Snapshot after = wait([&](const Snapshot& s) {
        return (s.mode == Mode::idle && s.step == "ready") ||
               (s.mode == Mode::fault && s.revision > before.revision + 1 && s.step == "stopped by a fault");
      });
      if (after.mode == Mode::fault) continue;
      auto started = setup_.cell->start();
      ASSERT_TRUE(started) << started.error().line();
      const Snapshot end = wait([&](const Snapshot& s) {
        return s.mode == Mode::fault || (s.mode == Mode::idle && s.reason.starts_with("all "));
      });
      if (end.mode == Mode::fault) continue;
      EXPECT_GE(end.counters.placed + end.counters.unknown, picks);
      return;
    }
    FAIL() << "the cell did not come out of its fault: " << setup_.cell->snapshot().reason;
  }
};

TEST_F(CellFaults, ControllerKilledBeforeTheGrip) {
  set_up(3);
  during_pick(2, false, [](sim::Controller& controller) { controller.kill(); });
  setup_.cell->open();
  const Snapshot fault = wait_fault();
  EXPECT_FALSE(fault.robot.connected);
  EXPECT_FALSE(fault.reason.empty());
  EXPECT_FALSE(fault.remedy.empty());
  ASSERT_FALSE(fault.alarms.empty());
  EXPECT_EQ(fault.alarms.front().code, "LINK_LOST");
  EXPECT_FALSE(setup_.cell->start()) << "not before a person has reset";
  ASSERT_TRUE(setup_.plant->controller->revive());
  reset_start_finish(3);
  expect_nothing_lost_or_doubled();
}

TEST_F(CellFaults, ControllerKilledWithAPartInTheGripper) {
  set_up(3);
  during_pick(2, true, [](sim::Controller& controller) { controller.kill(); });
  setup_.cell->open();
  const Snapshot fault = wait_fault();
  ASSERT_FALSE(fault.alarms.empty());
  EXPECT_EQ(fault.alarms.front().code, "LINK_LOST");
  ASSERT_TRUE(setup_.plant->controller->revive());
  reset_start_finish(3);
  EXPECT_EQ(setup_.cell->snapshot().counters.unknown, 1);
  expect_nothing_lost_or_doubled();
}

TEST_F(CellFaults, HalfALine) {
  set_up(3);
  during_pick(2, false, [](sim::Controller& controller) {
    sim::FaultEvent event;
    event.fault = sim::Fault::half_line;
    event.after_commands = 1;
    controller.inject(event);
  });
  setup_.cell->open();
  wait([](const Snapshot& s) { return s.mode == Mode::fault || s.counters.placed == 3; });
  if (setup_.cell->snapshot().mode == Mode::fault) {
    EXPECT_FALSE(setup_.cell->snapshot().reason.empty());
    reset_start_finish(3);
  }
  expect_nothing_lost_or_doubled();
}

TEST_F(CellFaults, NoAnswerMidPickHoldsTheArm) {
  set_up(3);
  during_pick(2, false, [](sim::Controller& controller) {
    sim::FaultEvent event;
    event.fault = sim::Fault::half_line;
    event.after_commands = 1;
    event.count = 3;  // also to what is asked again
    controller.inject(event);
  });
  setup_.cell->open();
  const Snapshot fault = wait_fault();
  EXPECT_FALSE(fault.reason.empty());
  EXPECT_FALSE(fault.remedy.empty());
  EXPECT_TRUE(setup_.plant->controller->copy_of_state().hold_command) << "an arm that nobody watches stands";
  reset_start_finish(3);
  expect_nothing_lost_or_doubled();
}

/// Whatever stopped the cell while the belt moved: the next picture is of a belt that stands.
TEST_F(CellFaults, AStartWhileTheBeltStillMovesWaitsForItToStand) {
  set_up(12);
  each_change = [this, done = false](const Snapshot& s) mutable {
    if (done || s.step != "moving the belt" || s.counters.submitted == 0) return;
    if (!setup_.plant->world.input(sim::kFeedMovingInput, setup_.clock->now())) return;
    done = true;
    setup_.plant->controller->kill();
    EXPECT_TRUE(setup_.plant->controller->revive());
  };
  setup_.cell->open();
  (void)wait_fault();
  reset_start_finish(12);
  expect_nothing_lost_or_doubled();  // no grip beside the parts
}

TEST_F(CellFaults, RefusalWith2060) {
  set_up(3);
  // An alarm raised between two picks: the next write is refused with 2060 (error or alarm present), or the cell sees
  // the alarm first. Either way it stands and says so.
  each_change = [this, done = false](const Snapshot& s) mutable {
    if (done || s.mode != Mode::running || s.counters.placed != 1 || !s.step.starts_with("picking")) return;
    done = true;
    setup_.plant->controller->with_state(
        [](sim::ControllerState& state) { state.raise_alarm({4107, 0, "OUT OF RANGE"}); });
  };
  setup_.cell->open();
  const Snapshot fault = wait_fault();
  EXPECT_TRUE(fault.reason.find("2060") != std::string::npos || fault.reason.find("alarm") != std::string::npos)
      << fault.reason;
  EXPECT_FALSE(fault.remedy.empty());
  reset_start_finish(3);
  expect_nothing_lost_or_doubled();
}

TEST_F(CellFaults, HeldFromThePendantMidPick) {
  set_up(3);
  core::TimePoint held_at{}, seen_at{};
  during_pick(2, true, [&](sim::Controller& controller) {
    held_at = setup_.clock->now();
    controller.with_state([](sim::ControllerState& state) { state.hold_pendant = true; });
  });
  setup_.cell->open();
  const Snapshot fault = wait_fault();
  ASSERT_FALSE(fault.alarms.empty());
  EXPECT_EQ(fault.alarms.front().code, "ROBOT_HELD");
  EXPECT_NE(fault.reason.find("held from the pendant"), std::string::npos);
  EXPECT_TRUE(fault.robot.held);
  setup_.plant->controller->with_state([](sim::ControllerState& state) { state.hold_pendant = false; });
  reset_start_finish(3);
  expect_nothing_lost_or_doubled();
}

TEST_F(CellFaults, EmergencyStopMidPick) {
  set_up(2);
  during_pick(1, false, [](sim::Controller& controller) {
    controller.with_state([](sim::ControllerState& state) { state.press_emergency_stop(); });
  });
  setup_.cell->open();
  const Snapshot fault = wait_fault();
  EXPECT_FALSE(fault.robot.servo);
  setup_.plant->controller->with_state([](sim::ControllerState& state) {
    state.release_emergency_stop();
    state.reset_at_pendant();
  });
  reset_start_finish(2);
  expect_nothing_lost_or_doubled();
}

/// What a person or a machine does to the controller in the middle of a pick, and how it is put right again.
struct Stop {
  std::string what, code, remedy;  ///< the alarm's code; what its remedy must name
  std::function<void(sim::Controller&)> done, undone;
};

std::vector<Stop> stops() {
  using State = sim::ControllerState;
  const auto on = [](void (*change)(State&)) { return [change](sim::Controller& c) { c.with_state(change); }; };
  const auto nothing = [](sim::Controller&) {};
  return {
      {"HOLD on the pendant", "ROBOT_HELD", "release HOLD", on([](State& s) { s.hold_pendant = true; }),
       on([](State& s) { s.hold_pendant = false; })},
      {"external hold", "ROBOT_HELD", "light curtain", on([](State& s) { s.hold_external = true; }),
       on([](State& s) { s.hold_external = false; })},
      {"hold by command", "ROBOT_HELD", "Reset", on([](State& s) { s.hold_command = true; }), nothing},
      {"key turned to teach", "ROBOT_TEACH", "key", on([](State& s) { s.turn_key_to_teach(); }),
       on([](State& s) { s.turn_key_to_remote(); })},
      {"command remote gone", "ROBOT_NOT_REMOTE", "REMOTE", on([](State& s) { s.remote = false; }),
       on([](State& s) { s.remote = true; })},
      {"emergency stop", "", "", on([](State& s) { s.press_emergency_stop(); }), on([](State& s) {
         s.release_emergency_stop();
         s.reset_at_pendant();
       })},
      {"alarm", "ROBOT_ALARM", "remove the cause", on([](State& s) { s.raise_alarm({4107, 0, "OUT OF RANGE"}); }),
       nothing},
      {"servo off", "ROBOT_SERVO_OFF", "emergency stop", on([](State& s) { s.servo = false; }), nothing},
      {"link lost", "LINK_LOST", "", [](sim::Controller& c) { c.kill(); },
       [](sim::Controller& c) { EXPECT_TRUE(c.revive()); }},
  };
}

class StopsAreSeen : public CellFaults, public ::testing::WithParamInterface<cli::RobotProtocol> {
 protected:
  /// Reset, twice where a person must have looked first.
  void reset() {
    for (int tries = 0; tries < 3; ++tries) {
      const auto before = setup_.cell->snapshot();
      ASSERT_TRUE(setup_.cell->reset());
      const Snapshot after = wait([&](const Snapshot& s) {
        return (s.mode == Mode::idle && s.step == "ready") ||
               (s.mode == Mode::fault && s.revision > before.revision + 1 && s.step == "stopped by a fault");
      });
      if (after.mode == Mode::idle) return;
    }
    FAIL() << setup_.cell->snapshot().reason;
  }
};

TEST_P(StopsAreSeen, Within200MsWithTheRemedyAndTheCellGoesOn) {
  const std::vector<Stop> all = stops();
  std::atomic<std::size_t> next = 0;
  std::atomic<bool> done = false;
  core::TimePoint done_at{};
  set_up(1000, 1, GetParam());
  core::TimePoint seen_at{};
  each_change = [&](const Snapshot& s) {
    if (done && s.mode == Mode::fault && seen_at < done_at) seen_at = setup_.clock->now();
    if (done || next >= all.size() || s.mode != Mode::running || !s.step.starts_with("picking")) return;
    const sim::ControllerState state = setup_.plant->controller->copy_of_state();
    if (state.D[12] != state.D[10] || state.D[11] == state.D[10]) return;  // not accepted yet, or ended
    done_at = setup_.clock->now();
    all[next].done(*setup_.plant->controller);
    done = true;
  };
  setup_.cell->open();
  for (const Stop& stop : all) {
    SCOPED_TRACE(stop.what);
    const Snapshot fault = wait_fault();
    const double ms = core::seconds(seen_at - done_at) * 1e3;
    RecordProperty("ms_" + std::to_string(next), std::to_string(ms));
    EXPECT_GE(ms, 0);
    EXPECT_LE(ms, 200);
    ASSERT_FALSE(fault.alarms.empty());
    if (!stop.code.empty()) {
      EXPECT_EQ(fault.alarms.front().code, stop.code) << fault.reason;
    }
    EXPECT_NE(fault.remedy.find(stop.remedy), std::string::npos) << fault.remedy;
    EXPECT_FALSE(fault.reason.empty() || fault.remedy.empty());
    stop.undone(*setup_.plant->controller);
    reset();
    ++next;
    done = false;
    auto started = setup_.cell->start();
    ASSERT_TRUE(started) << started.error().line();
  }
  const std::int64_t placed = setup_.cell->snapshot().counters.placed;
  wait([&](const Snapshot& s) { return s.counters.placed > placed || s.mode == Mode::fault; });
  EXPECT_EQ(setup_.cell->snapshot().mode, Mode::running) << setup_.cell->snapshot().reason;
  EXPECT_TRUE(setup_.cell->stop_cycle());
  wait([](const Snapshot& s) { return s.mode == Mode::idle || s.mode == Mode::fault; });
  expect_nothing_lost_or_doubled();
}

INSTANTIATE_TEST_SUITE_P(Over, StopsAreSeen, ::testing::Values(cli::RobotProtocol::tcp80, cli::RobotProtocol::hses),
                         [](const auto& over) {
                           return std::string(over.param == cli::RobotProtocol::hses ? "Hses" : "Tcp80");
                         });

}  // namespace
}  // namespace pickcell
