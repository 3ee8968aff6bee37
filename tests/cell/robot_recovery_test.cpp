// What becomes of a pick when the controller, the link or the PC fails.

#include <cmath>
#include <random>

#include "pickcell/sim/controller_commands.hpp"
#include "robot_controller.hpp"

namespace pickcell {
namespace {

using namespace robot_controller;

class RobotRecovers : public RobotAndController {};

TEST_P(RobotRecovers, APickNotTakenYetIsWithdrawnByConnectingAnew) {
  ASSERT_TRUE(ready());
  ASSERT_TRUE(robot_->submit(pick(0)));  // simulated time stands still: the job has not looked yet
  ASSERT_TRUE(robot_->connect(*seat_));
  auto settled = robot_->take_settled();
  ASSERT_EQ(settled.size(), 1u);
  EXPECT_EQ(settled[0].kind, OutcomeKind::not_started);
  EXPECT_TRUE(plant_.acts().empty());
  ASSERT_TRUE(robot_->submit(pick(0)));
  EXPECT_EQ(wait()->kind, OutcomeKind::done);
  ASSERT_TRUE(robot_->submit(pick(1)));
  until_acts(3);  // taken: then it runs to its end
  ASSERT_TRUE(robot_->connect(*seat_));
  settled = robot_->take_settled();
  ASSERT_EQ(settled.size(), 1u);
  EXPECT_EQ(settled[0].kind, OutcomeKind::done);
  EXPECT_EQ(plant_.acts().size(), 4u);
}

TEST_P(RobotRecovers, PowerLossInAPickIsUnknownUntilAPersonHasLooked) {
  ASSERT_TRUE(ready());
  const auto sequence = robot_->submit(pick(0));
  until_acts(1);
  controller_->kill();
  const auto lost = robot_->outcome();
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().code, core::ErrorCode::link);
  EXPECT_FALSE(robot_->connected());
  EXPECT_FALSE(robot_->connect(*seat_));
  ASSERT_TRUE(controller_->revive());

  ASSERT_TRUE(robot_->connect(*seat_));
  EXPECT_TRUE(robot_->take_settled().empty());
  const auto held = robot_->start(*seat_);
  ASSERT_FALSE(held);
  EXPECT_THAT(held.error().line(), HasSubstr("pick " + std::to_string(*sequence) + " was interrupted"));
  EXPECT_FALSE(robot_->submit(pick(1)));
  seat_->sleep_for(5s);
  const std::size_t acts_before = plant_.acts().size();

  ASSERT_TRUE(robot_->confirm(*seat_));
  const auto settled = robot_->take_settled();
  ASSERT_EQ(settled.size(), 1u);
  EXPECT_EQ(settled.front().kind, OutcomeKind::unknown);
  EXPECT_EQ(settled.front().sequence, *sequence);
  EXPECT_EQ(rows().front().state, CommandState::unknown);
  ASSERT_TRUE(robot_->submit(pick(1)));
  EXPECT_EQ(wait()->kind, OutcomeKind::done);
  EXPECT_GE(plant_.acts().size(), acts_before + 2);
}

TEST_P(RobotRecovers, APersonMayConfirmBeforeTheStart) {
  ASSERT_TRUE(ready());
  ASSERT_TRUE(robot_->submit(pick(0)));
  until_acts(1);
  controller_->kill();
  EXPECT_FALSE(robot_->outcome());
  ASSERT_TRUE(controller_->revive());
  ASSERT_TRUE(robot_->connect(*seat_));
  ASSERT_TRUE(robot_->confirm(*seat_));
  ASSERT_TRUE(robot_->start(*seat_));
  EXPECT_EQ(robot_->take_settled().at(0).kind, OutcomeKind::unknown);
}

TEST_P(RobotRecovers, AConnectingPcDoesNotReleaseAJobThatWaitsForAPerson) {
  ASSERT_TRUE(ready());
  ASSERT_TRUE(robot_->submit(pick(0)));
  until_acts(1);
  controller_->kill();
  ASSERT_TRUE(controller_->revive());
  EXPECT_FALSE(ready());
  boot();
  const auto connected = robot_->connect(*seat_);
  ASSERT_FALSE(connected);
  EXPECT_THAT(connected.error().line(), HasSubstr("interrupted"));
  const std::size_t acts = plant_.acts().size();
  seat_->sleep_for(10s);
  EXPECT_EQ(plant_.acts().size(), acts);
  EXPECT_FALSE(robot_->start(*seat_));
  ASSERT_TRUE(robot_->confirm(*seat_));
  EXPECT_TRUE(robot_->start(*seat_));
}

TEST_P(RobotRecovers, SomethingInTheGripperAtTheStartNeedsAPerson) {
  plant_.put_into_gripper(true);
  seat_->sleep_for(100ms);
  const auto started = ready();
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().line(), HasSubstr("something is in the gripper"));
  plant_.put_into_gripper(false);
  ASSERT_TRUE(robot_->confirm(*seat_));
  EXPECT_TRUE(robot_->start(*seat_));
}

TEST_P(RobotRecovers, APcThatDiesInAPickLearnsItsOutcome) {
  ASSERT_TRUE(ready());
  const auto sequence = robot_->submit(pick(0));
  until_acts(1);
  boot();
  ASSERT_TRUE(robot_->connect(*seat_));
  const auto settled = robot_->take_settled();
  ASSERT_EQ(settled.size(), 1u);
  EXPECT_EQ(settled.front().kind, OutcomeKind::done);
  EXPECT_EQ(settled.front().sequence, *sequence);
  ASSERT_TRUE(robot_->start(*seat_));
  EXPECT_EQ(plant_.acts().size(), 2u);
}

TEST_P(RobotRecovers, AMissingJournalNeedsAPerson) {
  ASSERT_TRUE(ready());
  ASSERT_TRUE(robot_->submit(pick(0)));
  ASSERT_TRUE(wait());
  journal_.reset();
  robot_.reset();
  std::filesystem::remove_all(folder_);
  for (int restart = 0; restart < 2; ++restart) {
    boot();
    const auto connected = robot_->connect(*seat_);
    ASSERT_FALSE(connected);
    EXPECT_THAT(connected.error().line(), HasSubstr("which this journal does not know"));
    EXPECT_FALSE(robot_->start(*seat_));
    EXPECT_FALSE(robot_->submit(pick(1)));
  }
  ASSERT_TRUE(robot_->confirm(*seat_));
  ASSERT_TRUE(robot_->submit(pick(1)));
  EXPECT_EQ(wait()->kind, OutcomeKind::done);
  boot();
  EXPECT_TRUE(robot_->connect(*seat_)) << "confirmed once, known for good";
}

TEST_P(RobotRecovers, HeldInAPickAndStartedAgain) {
  ASSERT_TRUE(ready());
  ASSERT_TRUE(robot_->submit(pick(0)));
  until_acts(1);
  controller_->with_state([](sim::ControllerState& s) { s.hold_pendant = true; });
  seat_->sleep_for(1s);
  EXPECT_TRUE(robot_->state()->held());
  EXPECT_FALSE(robot_->outcome()->has_value());
  controller_->with_state([](sim::ControllerState& s) { s.hold_pendant = false; });
  ASSERT_TRUE(robot_->connect(*seat_));
  const auto started = robot_->start(*seat_);
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().line(), HasSubstr("interrupted"));
  ASSERT_TRUE(robot_->confirm(*seat_));
  EXPECT_EQ(robot_->take_settled().at(0).kind, OutcomeKind::unknown);
}

/// A person has taken the part out of the gripper, and then somebody starts the job at the pendant where it stood.
TEST_P(RobotRecovers, AJobTakenUpAgainWithoutItsPartIsNeverDone) {
  ASSERT_TRUE(ready());
  ASSERT_TRUE(robot_->submit(pick(0)));
  until_acts(1);
  const auto tool_mm = [this] { return Eigen::Vector3d(controller_->T_base_tool().translation_m() * 1e3); };
  for (int i = 0; i < 3000 && !(tool_mm().y() > 140 && tool_mm().z() < 0); ++i) seat_->sleep_for(10ms);
  ASSERT_LT(tool_mm().z(), 0) << "on the way down to its place, the last way there is";
  controller_->with_state([](sim::ControllerState& s) { s.hold_pendant = true; });
  seat_->sleep_for(500ms);
  ASSERT_EQ(plant_.acts().size(), 1u);
  ASSERT_TRUE(robot_->connect(*seat_));
  plant_.put_into_gripper(false);
  ASSERT_TRUE(robot_->confirm(*seat_));
  const auto settled = robot_->take_settled();
  ASSERT_EQ(settled.size(), 1u);
  EXPECT_EQ(settled[0].kind, OutcomeKind::unknown);

  controller_->with_state([](sim::ControllerState& s) { s.hold_pendant = false; });
  controller_->with_state([](sim::ControllerState& s) { EXPECT_EQ(sim::start(s, ""), sim::Refusal::none); });
  ASSERT_TRUE(robot_->start(*seat_));
  EXPECT_TRUE(robot_->take_settled().empty()) << "answered once, answered for good";
  EXPECT_EQ(rows().front().state, CommandState::unknown);
  EXPECT_EQ(controller_->copy_of_state().B[13], 9) << "the job itself saw that nothing was left";
}

/// Faults at random, for every stage of a pick: what is gripped is gripped once per number, and the record knows it.
TEST_P(RobotRecovers, NoPickIsExecutedTwiceOrLostFromTheRecord) {
  answer_timeout_ = std::chrono::milliseconds(300);  // answers that do not come are waited for
  boot();
  std::mt19937 random(20261122);
  std::map<std::uint64_t, std::vector<OutcomeKind>> told;
  int stops = 0;
  const auto note = [&](const std::vector<Outcome>& outcomes, int n) {
    for (const Outcome& o : outcomes) told[static_cast<std::uint64_t>(n)].push_back(o.kind);
  };
  const auto recover = [&](int n) {
    ++stops;
    controller_->follow({});
    if (random() % 2) boot();
    (void)controller_->revive();
    controller_->with_state([](sim::ControllerState& s) {
      s.hold_pendant = false;
      s.release_emergency_stop();
      s.reset_at_pendant();
      s.turn_key_to_remote();
    });
    for (int tries = 0; tries < 6; ++tries) {
      if (!robot_->connected()) (void)robot_->connect(*seat_);
      if (robot_->connected()) (void)robot_->confirm(*seat_);
      const auto started = robot_->connected() ? robot_->start(*seat_) : core::Status{};
      if (started && robot_->connected()) break;
      ASSERT_LT(tries, 5) << "does not recover: " << (started ? "not connected" : started.error().line());
    }
    note(robot_->take_settled(), n);
  };
  ASSERT_TRUE(ready());
  for (int n = 0; n < 50; ++n) {
    const auto kind = random() % 9;
    const sim::Fault faults[] = {sim::Fault::drop,           sim::Fault::half_line, sim::Fault::truncate,
                                 sim::Fault::reset_after_ok, sim::Fault::alarm,     sim::Fault::hold,
                                 sim::Fault::teach};
    sim::FaultEvent event;
    if (kind < 7) {
      event.fault = faults[kind];
      event.after_commands = 1 + static_cast<int>(random() % 40);
      controller_->follow({event});
    }
    const auto submitted = robot_->submit(pick(n));
    if (kind == 7) {
      seat_->sleep_for(core::duration_s(static_cast<double>(random() % 6000) * 1e-3));
      controller_->kill();
    }
    if (kind == 8) {
      seat_->sleep_for(core::duration_s(static_cast<double>(random() % 6000) * 1e-3));
      boot();
    }
    if (!submitted || kind >= 7) {
      recover(n);
      continue;
    }
    bool stopped = false;
    for (int i = 0; i < 600 && !stopped; ++i) {
      auto outcome = robot_->outcome();
      auto state = outcome ? robot_->state() : core::Result<robot::RobotState>(core::forward(outcome));
      if (outcome && *outcome) {
        note({**outcome}, n);
        break;
      }
      stopped = !outcome || !state || !state->running;
      if (!stopped) seat_->sleep_for(50ms);
    }
    controller_->follow({});
    if (stopped) recover(n);
  }
  EXPECT_GT(stops, 20);

  std::map<long, int> grips;  // by pick
  for (const auto& act : plant_.acts()) grips[std::lround(act.at_mm.x() - 400)] += act.closed;
  std::map<CommandState, int> count;
  for (const auto& row : rows()) {
    ++count[row.state];
    const int gripped = grips[row.place_slot];
    EXPECT_LE(gripped, 1) << "pick " << row.sequence << " was executed twice";
    if (row.state == CommandState::done) {
      EXPECT_EQ(gripped, 1) << row.sequence;
    }
    if (row.state == CommandState::void_) {
      EXPECT_EQ(gripped, 0) << row.sequence;
    }
    EXPECT_TRUE(row.state != CommandState::intent && row.state != CommandState::sent) << row.sequence;
  }
  EXPECT_GE(count[CommandState::done], 10);
  EXPECT_GE(count[CommandState::void_], 1);
  EXPECT_GE(count[CommandState::unknown], 1);
  for (const auto& [n, kinds] : told) EXPECT_LE(kinds.size(), 1u) << "pick " << n << " was reported more than once";
}

PICKCELL_OVER_BOTH_PROTOCOLS(RobotRecovers);

}  // namespace
}  // namespace pickcell
