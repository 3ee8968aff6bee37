/// What the cell does when the arm, its link or a pick fails, at the scripted table.
#include "pickcell/cell/scripted_cell_test.hpp"

namespace pickcell::cell {
namespace {

using namespace scripted;

TEST_F(CellTest, AnArmThatDoesNotAnswerAtTheBeginningIsAFaultThatResetCures) {
  robot_.refuse_connect = true;
  open();
  const Snapshot fault = wait([](const Snapshot& s) { return s.mode == Mode::fault; });
  EXPECT_NE(fault.reason.find("connection refused"), std::string::npos);
  EXPECT_FALSE(fault.remedy.empty());
  EXPECT_FALSE(fault.robot.connected);
  ASSERT_FALSE(cell_->start());
  robot_.refuse_connect = false;
  press_reset();
  EXPECT_TRUE(wait_ready().robot.connected);
}

struct ArmFault {
  const char* code;
  std::function<void(RobotState&)> happens, person_repairs;
};

class CellArmFault : public CellTest, public ::testing::WithParamInterface<ArmFault> {};

TEST_P(CellArmFault, IsSeenWithin200MsNamedAndSurvived) {
  table_.parts = {{200, 150, .95, {}, .05}, {400, 150, .95, {}, .05}};
  robot_.script[1] = {1.0, GetParam().happens, {}, false, false, {}, true};
  open();
  const Snapshot fault = run();
  ASSERT_EQ(fault.mode, Mode::fault);
  EXPECT_LE(fault_at_ - *robot_.changed_at, std::chrono::milliseconds(200));
  ASSERT_FALSE(fault.alarms.empty());
  EXPECT_EQ(fault.alarms.front().code, GetParam().code);
  EXPECT_TRUE(fault.alarms.front().active);
  EXPECT_FALSE(fault.reason.empty());
  EXPECT_FALSE(fault.remedy.empty());
  EXPECT_EQ(robot_.submitted.size(), 1u) << "no new motion after a fault";
  EXPECT_FALSE(cell_->start());

  GetParam().person_repairs(robot_.arm());
  press_reset();
  const Snapshot ready = wait_ready();
  EXPECT_FALSE(ready.alarms.front().active);
  const Snapshot end = run();
  EXPECT_EQ(end.counters.placed, 2) << "the interrupted pick was finished by the job and is counted";
  EXPECT_EQ(robot_.submitted.size(), 2u) << "and not handed over again";
}

INSTANTIATE_TEST_SUITE_P(
    Faults, CellArmFault,
    ::testing::Values(
        ArmFault{"ROBOT_HELD",
                 [](RobotState& s) {
                   s.hold_pendant = true;
                   s.running = false;
                 },
                 [](RobotState& s) { s.hold_pendant = false; }},
        ArmFault{"ROBOT_HELD",
                 [](RobotState& s) {
                   s.hold_external = true;
                   s.running = false;
                 },
                 [](RobotState& s) { s.hold_external = false; }},
        ArmFault{"ROBOT_ALARM",
                 [](RobotState& s) {
                   s.alarm = true;
                   s.running = false;
                 },
                 [](RobotState&) {}},
        ArmFault{"ROBOT_SERVO_OFF", [](RobotState& s) { s.servo = s.running = false; }, [](RobotState&) {}},
        ArmFault{"ROBOT_TEACH",
                 [](RobotState& s) {
                   s.teach = true;
                   s.play = s.running = false;
                 },
                 [](RobotState& s) {
                   s.teach = false;
                   s.play = true;
                 }},
        ArmFault{"ROBOT_NOT_REMOTE", [](RobotState& s) { s.remote = false; }, [](RobotState& s) { s.remote = true; }},
        ArmFault{"ROBOT_STOPPED", [](RobotState& s) { s.running = false; }, [](RobotState&) {}}),
    [](const auto& fault) { return fault.param.code + std::to_string(fault.index); });

TEST_F(CellTest, AResetBeforeTheRepairStaysInFaultAndSaysWhy) {
  table_.parts = {{200, 150, .95, {}, .05}};
  robot_.script[1] = {1.0, [](RobotState& s) { s.hold_pendant = true; }, {}, false, false, {}, true};
  open();
  ASSERT_EQ(run().mode, Mode::fault);
  const int connects = robot_.connects;
  press_reset();
  wait([&](const Snapshot& s) { return robot_.connects > connects && s.step == "stopped by a fault"; });
  EXPECT_EQ(cell_->snapshot().mode, Mode::fault);
  EXPECT_NE(cell_->snapshot().reason.find("held from the pendant"), std::string::npos);
}

TEST_F(CellTest, ALinkLostMidPickIsSettledAndThePartIsNotPickedTwice) {
  table_.parts = {{200, 150, .95, {}, .05}, {400, 150, .95, {}, .05}};
  robot_.script[1].lose_link = robot_.script[1].carries_on_alone = true;
  open();
  const Snapshot fault = run();
  ASSERT_EQ(fault.mode, Mode::fault);
  EXPECT_EQ(fault.alarms.front().code, "LINK_LOST");
  EXPECT_FALSE(fault.robot.connected);
  press_reset();
  EXPECT_EQ(wait_ready().counters.placed, 1) << "Reset found out that the arm had finished it";
  const Snapshot end = run();
  EXPECT_EQ(end.counters.placed, 2);
  EXPECT_EQ(robot_.submitted.size(), 2u);
  EXPECT_NE(robot_.submitted[0].place_slot, robot_.submitted[1].place_slot);
}

TEST_F(CellTest, ARefusedHandOverIsAFaultThatKeepsPartAndPlace) {
  table_.parts = {{200, 150, .95, {}, .05}};
  robot_.script[1].refuse_submit =
      core::Error{core::ErrorCode::refused, "LOADV", "error or alarm present (2060)", "clear the alarm", {}};
  open();
  const Snapshot fault = run();
  ASSERT_EQ(fault.mode, Mode::fault);
  EXPECT_NE(fault.reason.find("2060"), std::string::npos);
  EXPECT_EQ(fault.counters.submitted, 0);
  press_reset();
  wait_ready();
  const Snapshot end = run();
  EXPECT_EQ(end.counters.placed, 1);
  EXPECT_EQ(robot_.submitted.at(0).place_slot, 0);
}

TEST_F(CellTest, AnUnknownOutcomeWaitsForAPersonAndItsPlaceIsNotUsedAgain) {
  table_.parts = {{200, 150, .95, {}, .05}, {400, 150, .95, {}, .05}};
  robot_.script[1].outcome = Outcome{OutcomeKind::unknown, 0, 7, "held while it carried a part"};
  open();
  const Snapshot fault = run();
  ASSERT_EQ(fault.mode, Mode::fault);
  EXPECT_EQ(fault.counters.unknown, 1);
  const picks::Pick first = robot_.submitted.at(0);
  table_.parts.erase(table_.parts.begin() +
                     table_.under(first.T_base_grasp.translation_m()));  // the person took it away
  EXPECT_EQ(robot_.confirms, 0);
  press_reset();
  wait_ready();
  EXPECT_EQ(robot_.confirms, 1);
  const Snapshot end = run();
  EXPECT_EQ(end.counters.placed, 1);
  EXPECT_NE(robot_.submitted.at(1).place_slot, first.place_slot);
}

TEST_F(CellTest, AMissedGripIsTriedAgainThenLeftAlone) {
  table_.parts = {{200, 150, .95, {}, .05}};
  for (int n : {1, 2}) robot_.script[n].outcome = Outcome{OutcomeKind::refused, 0, 2, "nothing gripped"};
  open();
  const Snapshot end = run();
  EXPECT_EQ(end.mode, Mode::idle);
  EXPECT_EQ(end.counters.missed, 2);
  EXPECT_EQ(end.counters.rejected.at("gave_up"), 1);
  EXPECT_EQ(robot_.submitted.size(), 2u);
  EXPECT_EQ(robot_.submitted[1].place_slot, 0) << "nothing was put there";
}

TEST_F(CellTest, ManyFailedPicksInARowStopTheCell) {
  settings_.stop_after_refused = 3;
  settings_.attempts_per_part = 1;
  for (int i = 0; i < 5; ++i) table_.parts.push_back({100.0 + 90 * i, 150, .95, {}, .05});
  for (int n = 1; n <= 5; ++n) robot_.script[n].outcome = Outcome{OutcomeKind::refused, 0, 2, "nothing gripped"};
  open();
  const Snapshot fault = run();
  ASSERT_EQ(fault.mode, Mode::fault);
  EXPECT_NE(fault.reason.find("3 picks in a row"), std::string::npos);
  EXPECT_EQ(robot_.submitted.size(), 3u);
}

TEST_F(CellTest, APickThatNeverEndsHoldsTheArm) {
  table_.parts = {{200, 150, .95, {}, .05}};
  robot_.script[1].never_ends = true;
  open();
  const Snapshot fault = run();
  ASSERT_EQ(fault.mode, Mode::fault);
  EXPECT_EQ(fault.alarms.front().code, "PICK_TIMEOUT");
  EXPECT_EQ(robot_.holds, 1);
  press_reset();
  EXPECT_FALSE(wait_ready().robot.held) << "Reset takes back the cell's own hold";
}

}  // namespace
}  // namespace pickcell::cell
