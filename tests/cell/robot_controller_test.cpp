// Picks through the driver, and what it refuses.

#include "robot_controller.hpp"

namespace pickcell {
namespace {

using namespace robot_controller;

class RobotPicks : public RobotAndController {};

TEST_P(RobotPicks, PicksAndPlacesWhereItIsTold) {
  ASSERT_TRUE(ready());
  for (int n = 0; n < 3; ++n) {
    const auto sequence = robot_->submit(pick(n));
    ASSERT_TRUE(sequence) << sequence.error().line();
    const auto outcome = wait();
    ASSERT_TRUE(outcome) << outcome.error().line();
    EXPECT_EQ(outcome->kind, OutcomeKind::done) << outcome->text;
    EXPECT_EQ(outcome->sequence, *sequence);
  }
  const auto acts = plant_.acts();
  ASSERT_EQ(acts.size(), 6u);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_TRUE(acts[2 * n].closed);
    EXPECT_LT((acts[2 * n].at_mm - Eigen::Vector3d(400.0 + static_cast<double>(n), -100, -50)).norm(), 0.01);
    EXPECT_FALSE(acts[2 * n + 1].closed);
    EXPECT_LT((acts[2 * n + 1].at_mm - Eigen::Vector3d(450, 150.0 + static_cast<double>(n), -60)).norm(), 0.01);
  }
  for (const auto& row : rows()) EXPECT_EQ(row.state, CommandState::done);
}

TEST_P(RobotPicks, StateAndPoseAgreeWithTheController) {
  ASSERT_TRUE(ready());
  const auto state = robot_->state();
  ASSERT_TRUE(state);
  EXPECT_TRUE(state->play && state->remote && state->servo && state->running && state->clear_of_camera);
  const auto pose = robot_->pose();
  ASSERT_TRUE(pose);
  EXPECT_LT((pose->translation_m() - controller_->T_base_tool().translation_m()).norm(), 1e-6);
  EXPECT_TRUE(pose->rotation().isApprox(controller_->T_base_tool().rotation(), 1e-5));
  ASSERT_TRUE(robot_->write_contact(sim::kFeedAdvanceContact, true));
  EXPECT_TRUE(plant_.contact(sim::kFeedAdvanceContact));
  EXPECT_TRUE(robot_->read_contact(sim::kFeedAdvanceContact).value());
  plant_.put_into_gripper(true);
  seat_->sleep_for(50ms);
  EXPECT_TRUE(robot_->read_contact(10).value());
}

TEST_P(RobotPicks, AnEmptyGripIsRefusedWithItsReason) {
  plant_.take_parts_away();
  ASSERT_TRUE(ready());
  ASSERT_TRUE(robot_->submit(pick(0)));
  const auto outcome = wait();
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_EQ(outcome->kind, OutcomeKind::refused);
  EXPECT_EQ(outcome->reason, robot::kNothingGripped);
  ASSERT_TRUE(robot_->submit(pick(1)));  // and the next one goes
}

TEST_P(RobotPicks, NothingOutsideTheBoxEverLeavesThePc) {
  ASSERT_TRUE(ready());
  auto outside = pick(0);
  outside.T_base_place = above(450, 510, -60, 0);
  const auto refused = robot_->submit(outside);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, core::ErrorCode::safety);
  EXPECT_THAT(refused.error().line(), HasSubstr("place pose: y = 510.0 mm is outside -500.0 .. 500.0 mm"));
  auto high = pick(0);
  high.T_base_grasp = above(400, 0, 330, 0);
  EXPECT_THAT(robot_->submit(high).error().line(), HasSubstr("with the approach up to 410.0"));
  auto broken = pick(0);
  broken.T_base_grasp = above(std::nan(""), 0, 0, 0);
  EXPECT_EQ(robot_->submit(broken).error().code, core::ErrorCode::safety);
  auto tilted = pick(0);
  tilted.T_base_grasp =
      core::Transform<core::Base, core::Tool>(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.4, 0, 0));
  EXPECT_THAT(robot_->submit(tilted).error().line(), HasSubstr("tilted by 180.0"));
  EXPECT_TRUE(rows().empty());
  EXPECT_EQ(controller_->copy_of_state().D[10], 0);
}

TEST_P(RobotPicks, TheJobRefusesWhatIsOutsideItsOwnWindow) {
  ASSERT_TRUE(ready());
  auto far = pick(0);
  far.T_base_place = above(450, 150, -60, 0);
  far.T_base_grasp = above(160, -100, -310, 0);  // inside the PC's limits of another cell, outside the job's
  robot::JobRobotSettings wide;
  wide.limits.box_min_mm = {-1000, -1000, -1000};
  wide.limits.box_max_mm = {1000, 1000, 1000};
  far.T_base_grasp = above(90, -100, -50, 0);
  robot_ = std::make_unique<robot::JobRobot>(wide, link(), *journal_, clock_);
  ASSERT_TRUE(ready());
  ASSERT_TRUE(robot_->submit(far));
  const auto outcome = wait();
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_EQ(outcome->reason, robot::kOutsideWindow);
  EXPECT_TRUE(plant_.acts().empty());
}

TEST_P(RobotPicks, EveryHindranceIsNamedBeforeAnythingMoves) {
  ASSERT_TRUE(robot_->connect(*seat_));
  const auto start_says = [this] { return robot_->start(*seat_).error().line(); };
  controller_->with_state([](sim::ControllerState& s) { s.turn_key_to_teach(); });
  EXPECT_THAT(start_says(), HasSubstr("key switch stands on TEACH"));
  controller_->with_state([](sim::ControllerState& s) { s.turn_key_to_remote(), s.remote = false; });
  EXPECT_THAT(start_says(), HasSubstr("command remote is not on"));
  controller_->with_state([](sim::ControllerState& s) { s.remote = true, s.hold_pendant = true; });
  EXPECT_THAT(start_says(), HasSubstr("held from the pendant"));
  controller_->with_state(
      [](sim::ControllerState& s) { s.hold_pendant = false, s.raise_alarm({4107, 3, "out of range"}); });
  EXPECT_THAT(start_says(), HasSubstr("in alarm: alarm 4107 [3]"));
  ASSERT_TRUE(robot_->reset());
  controller_->with_state([](sim::ControllerState& s) { s.jobs.erase("VISPICK"); });
  EXPECT_THAT(start_says(), HasSubstr("4040: no such job; load VISPICK.JBI"));
}

PICKCELL_OVER_BOTH_PROTOCOLS(RobotPicks);

}  // namespace
}  // namespace pickcell
