// The arm's driver against the simulated controller, over real sockets, with the real job and a real journal: picks,
// and what becomes of them when the controller, the link or the PC fails.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>

#include "pickcell/cell/journal.hpp"
#include "pickcell/robot/hses_client.hpp"
#include "pickcell/robot/job_robot.hpp"
#include "pickcell/robot/tcp80_client.hpp"
#include "pickcell/sim/controller.hpp"
#include "pickcell/sim/shipped_jobs.hpp"

namespace pickcell {
namespace {

using namespace std::chrono_literals;
using robot::CommandState;
using robot::Outcome;
using robot::OutcomeKind;
using ::testing::HasSubstr;

/// A gripper that always grips, unless told otherwise; counts what it did and where.
class GripperPlant final : public sim::Plant {
 public:
  struct Act {
    bool closed;
    Eigen::Vector3d at_mm;
  };
  void output_changed(int n, bool on, const core::Transform<core::Base, core::Tool>& T_base_tool,
                      core::TimePoint) override {
    if (n != sim::kGripperOutput) return;
    const std::lock_guard lock(mutex_);
    if (on || holds_) acts_.push_back({on, T_base_tool.translation_m() * 1e3});
    holds_ = on && !empty_;
  }
  bool input(int n, core::TimePoint) override {
    const std::lock_guard lock(mutex_);
    return n == sim::kGripSensorInput && holds_;
  }
  void contact_written(int contact, bool on, core::TimePoint) override {
    const std::lock_guard lock(mutex_);
    contacts_[contact] = on;
  }
  std::vector<Act> acts() {
    const std::lock_guard lock(mutex_);
    return acts_;
  }
  bool contact(int number) {
    const std::lock_guard lock(mutex_);
    return contacts_[number];
  }
  void put_into_gripper(bool part) {
    const std::lock_guard lock(mutex_);
    holds_ = part;
  }
  /// From now on there is nothing to grip.
  void take_parts_away() {
    const std::lock_guard lock(mutex_);
    empty_ = true;
  }

 private:
  std::mutex mutex_;
  std::vector<Act> acts_;
  std::map<int, bool> contacts_;
  bool holds_ = false, empty_ = false;
};

enum class Protocol { tcp80, hses };

/// Every test over both protocols: what a robot does must not depend on the wire.
class RobotAndController : public ::testing::TestWithParam<Protocol> {
 protected:
  void SetUp() override {
    std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    std::replace(name.begin(), name.end(), '/', '_');
    folder_ = std::filesystem::path(::testing::TempDir()) / ("pickcell_robot_" + name);
    std::filesystem::remove_all(folder_);
    sim::ControllerSettings settings;
    settings.jobs = sim::shipped_jobs();
    auto on = sim::Controller::switch_on(settings, clock_, &plant_);
    ASSERT_TRUE(on) << on.error().line();
    controller_ = std::move(*on);
    boot();
  }
  void TearDown() override {
    controller_.reset();
    std::filesystem::remove_all(folder_);
  }

  /// A new PC process: nothing survives but the journal's file.
  void boot() {
    robot_.reset();
    journal_.reset();
    auto journal = cell::SqliteJournal::open(folder_ / "journal.db");
    ASSERT_TRUE(journal) << journal.error().line();
    journal_ = std::move(*journal);
    robot::JobRobotSettings settings;
    settings.limits.box_min_mm = {150, -500, -300};
    settings.limits.box_max_mm = {700, 500, 400};
    robot_ = std::make_unique<robot::JobRobot>(settings, link(), *journal_, clock_);
  }
  std::unique_ptr<robot::ControllerLink> link() {
    if (GetParam() == Protocol::hses) {
      robot::HsesSettings settings;
      settings.host = "127.0.0.1";
      settings.port = controller_->hses_port();
      settings.timeout = answer_timeout_ / settings.tries;
      return std::make_unique<robot::HsesClient>(settings);
    }
    robot::Tcp80Settings settings;
    settings.host = "127.0.0.1";
    settings.port = controller_->tcp80_port();
    settings.line_timeout = settings.result_timeout = answer_timeout_;
    return std::make_unique<robot::Tcp80Client>(settings);
  }

  static core::Transform<core::Base, core::Tool> above(double x_mm, double y_mm, double z_mm, double angle_rad) {
    Eigen::Matrix3d down;
    down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
    return {core::rotation_z(angle_rad) * down, Eigen::Vector3d(x_mm, y_mm, z_mm) * 1e-3};
  }
  picks::Pick pick(int n) {
    picks::Pick p;
    p.detection_id = static_cast<std::uint64_t>(n) + 1000;
    p.place_slot = n;
    p.model = "bracket";
    p.T_base_grasp = above(400 + n, -100, -50, 0.3);  // which grip was which is seen from where it was
    p.T_base_place = above(450, 150 + n % 10, -60, -0.2);
    return p;
  }
  core::Status ready() {
    if (auto connected = robot_->connect(*seat_); !connected) return connected;
    return robot_->start(*seat_);
  }
  /// Waits, in simulated time, for the outcome of the submitted pick.
  core::Result<Outcome> wait() {
    for (int i = 0; i < 1200; ++i) {
      auto outcome = robot_->outcome();
      if (!outcome) return core::forward(outcome);
      if (*outcome) return **outcome;
      seat_->sleep_for(50ms);
    }
    return core::failure(core::ErrorCode::timeout, "test", "no outcome in a minute");
  }
  /// Sleeps until the gripper has acted n times.
  void until_acts(std::size_t n) {
    for (int i = 0; i < 3000 && plant_.acts().size() < n; ++i) seat_->sleep_for(10ms);
    ASSERT_EQ(plant_.acts().size(), n);
  }
  std::vector<robot::JournalRow> rows() { return journal_->newest_rows(10000).value(); }

  std::filesystem::path folder_;
  std::chrono::milliseconds answer_timeout_{10000};  // wall time, for a busy machine
  core::SimulatedClock clock_;
  std::unique_ptr<core::Seat> seat_ = clock_.join("pc");
  GripperPlant plant_;
  std::unique_ptr<sim::Controller> controller_;
  std::unique_ptr<cell::SqliteJournal> journal_;
  std::unique_ptr<robot::JobRobot> robot_;
};

TEST_P(RobotAndController, PicksAndPlacesWhereItIsTold) {
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

TEST_P(RobotAndController, StateAndPoseAgreeWithTheController) {
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

TEST_P(RobotAndController, AnEmptyGripIsRefusedWithItsReason) {
  plant_.take_parts_away();
  ASSERT_TRUE(ready());
  ASSERT_TRUE(robot_->submit(pick(0)));
  const auto outcome = wait();
  ASSERT_TRUE(outcome) << outcome.error().line();
  EXPECT_EQ(outcome->kind, OutcomeKind::refused);
  EXPECT_EQ(outcome->reason, robot::kNothingGripped);
  ASSERT_TRUE(robot_->submit(pick(1)));  // and the next one goes
}

TEST_P(RobotAndController, NothingOutsideTheBoxEverLeavesThePc) {
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

TEST_P(RobotAndController, TheJobRefusesWhatIsOutsideItsOwnWindow) {
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

TEST_P(RobotAndController, APickNotTakenYetIsWithdrawnByConnectingAnew) {
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

TEST_P(RobotAndController, PowerLossInAPickIsUnknownUntilAPersonHasLooked) {
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

TEST_P(RobotAndController, APersonMayConfirmBeforeTheStart) {
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

TEST_P(RobotAndController, AConnectingPcDoesNotReleaseAJobThatWaitsForAPerson) {
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

TEST_P(RobotAndController, SomethingInTheGripperAtTheStartNeedsAPerson) {
  plant_.put_into_gripper(true);
  seat_->sleep_for(100ms);
  const auto started = ready();
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().line(), HasSubstr("something is in the gripper"));
  plant_.put_into_gripper(false);
  ASSERT_TRUE(robot_->confirm(*seat_));
  EXPECT_TRUE(robot_->start(*seat_));
}

TEST_P(RobotAndController, APcThatDiesInAPickLearnsItsOutcome) {
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

TEST_P(RobotAndController, AMissingJournalNeedsAPerson) {
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

TEST_P(RobotAndController, EveryHindranceIsNamedBeforeAnythingMoves) {
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

TEST_P(RobotAndController, HeldInAPickAndStartedAgain) {
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

/// Faults at random, for every stage of a pick: what is gripped is gripped once per number, and the record knows it.
TEST_P(RobotAndController, NoPickIsExecutedTwiceOrLostFromTheRecord) {
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

INSTANTIATE_TEST_SUITE_P(Over, RobotAndController, ::testing::Values(Protocol::tcp80, Protocol::hses),
                         [](const auto& tested) { return tested.param == Protocol::hses ? "hses" : "tcp80"; });

}  // namespace
}  // namespace pickcell
