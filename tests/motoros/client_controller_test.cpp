// The MotoROS client against the simulated controller over sockets, with TCP 80 looking at the same controller.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <utility>

#include "pickcell/robot/motoros_client.hpp"
#include "pickcell/robot/motoros_fault.hpp"
#include "pickcell/robot/motoros_link.hpp"
#include "pickcell/robot/motoros_move.hpp"
#include "pickcell/robot/tcp80_client.hpp"
#include "pickcell/sim/controller.hpp"
#include "pickcell/sim/shipped_jobs.hpp"

namespace pickcell {
namespace {

namespace moto = robot::moto;
using robot::ArmJoints;
using ::testing::HasSubstr;

class ClientAndController : public ::testing::TestWithParam<robot::ByteOrder> {
 protected:
  void SetUp() override {
    sim::ControllerSettings settings;
    settings.jobs = sim::shipped_jobs();
    settings.motoros_port = 0;
    settings.motoros_order = GetParam();
    auto on = sim::Controller::switch_on(settings, clock_, nullptr);
    ASSERT_TRUE(on) << on.error().line();
    controller_ = std::move(*on);
    robot::MotoRosClientSettings link;
    link.host = "127.0.0.1";
    link.port = controller_->motoros_port();
    link.reply_timeout = answer_timeout_;
    client_ = std::make_unique<robot::MotoRosClient>(link);
    limits_.arm = robot::arm_geometry("gp7");
    limits_.T_flange_tool = {Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 0, 0.150)};
    limits_.box_min_mm = {150, -500, -300};
    limits_.box_max_mm = {700, 500, 600};
    limits_.speed_fraction = 0.3;
    limits_.line_speed_mm_s = 600;
  }
  ArmJoints joints() { return robot::arm_joints(client_->read_state()->feedback.position); }
  std::vector<robot::MotoTrajectoryPoint> turn_s(double deg) {
    const ArmJoints from = joints();
    ArmJoints to = from;
    to[0] += deg * M_PI / 180;
    return robot::plan_joint_move(*limits_.arm, from, to, 0.1);
  }
  void spoil(sim::Fault fault, const std::string& command, double delay_s = 0.01) {
    sim::FaultEvent event;
    event.fault = fault;
    event.after_command = command;
    event.delay_s = delay_s;
    controller_->follow({event});
  }

  std::chrono::milliseconds answer_timeout_{2000};
  core::RealClock clock_;
  std::unique_ptr<core::Seat> seat_ = clock_.join("pc");
  std::unique_ptr<sim::Controller> controller_;
  std::unique_ptr<robot::MotoRosClient> client_;
  robot::MotoRosLimits limits_;
};

TEST_P(ClientAndController, TheByteOrderIsSeenAndTheStateAgreesWithTcp80) {
  ASSERT_TRUE(client_->connect());
  EXPECT_EQ(client_->order(), GetParam());
  robot::Tcp80Settings link;
  link.host = "127.0.0.1";
  link.port = controller_->tcp80_port();
  robot::Tcp80Client tcp80(link);
  ASSERT_TRUE(tcp80.connect());
  std::mt19937 random(5);
  const sim::Arm& arm = sim::arm(sim::ArmModel::gp7);
  for (int round = 0; round < 12; ++round) {
    controller_->with_state([&](sim::ControllerState& s) {
      s.reset_at_pendant();
      s.turn_key_to_remote();
      s.hold_pendant = random() % 3 == 0;
      if (random() % 3 == 0) s.raise_alarm({4107, 0, "x"});
      s.servo = random() % 2 && s.alarms.empty();
      if (random() % 4 == 0) s.turn_key_to_teach();
      for (int i = 0; i < 6; ++i) s.q[i] = static_cast<double>(random() % 1000) * 1e-3 - 0.5;
      s.network_inputs[2701] = static_cast<std::uint8_t>(random());
    });
    const auto here = client_->read_state();
    const auto there = tcp80.read_status();
    ASSERT_TRUE(here && there);
    EXPECT_EQ(here->status.drives_powered == 1, there->servo);
    EXPECT_EQ(here->status.in_error == 1, there->alarm || there->error);
    EXPECT_EQ(here->status.mode == 2, there->play);
    const auto alarms = tcp80.read_alarms();
    EXPECT_EQ(here->status.error_code, alarms->empty() ? 0 : alarms->front().code);
    const auto pulses = tcp80.read_pulses();
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(static_cast<double>(here->feedback.position[i]) * arm.pulses_per_rad[static_cast<Eigen::Index>(i)],
                  (*pulses)[i], 0.05);
    // the pose that the PC computes is the one the controller tells
    const auto pose = tcp80.read_position(0);
    const auto own = robot::flange_in_base(*limits_.arm, joints()) * limits_.T_flange_tool;
    EXPECT_LT((own.translation_m() * 1e3 - Eigen::Vector3d(pose->x_mm, pose->y_mm, pose->z_mm)).norm(), 0.05);
    EXPECT_EQ(client_->read_group(2701).value(), tcp80.read_contacts(27010, 1)->front());
  }
}

TEST_P(ClientAndController, MovesAndComesToRestWhereItWasTold) {
  ASSERT_TRUE(client_->connect());
  const auto points = turn_s(6);
  const auto moved = robot::run_trajectory(*client_, points, limits_, *seat_);
  ASSERT_TRUE(moved) << moved.error().line();
  EXPECT_NEAR(controller_->copy_of_state().q[0] * 180 / M_PI, 6, 1e-3);
  for (int i = 0; i < 500 && controller_->copy_of_state().running(); ++i)
    seat_->sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(controller_->copy_of_state().running()) << "INIT_ROS has ended";
}

TEST_P(ClientAndController, NothingUnsafeIsEverSent) {
  ASSERT_TRUE(client_->connect());
  const auto refused = [&](const std::vector<robot::MotoTrajectoryPoint>& points, const char* words) {
    const auto r = robot::run_trajectory(*client_, points, limits_, *seat_);
    ASSERT_FALSE(r) << words;
    EXPECT_EQ(r.error().code, core::ErrorCode::safety) << r.error().line();
    EXPECT_THAT(r.error().line(), HasSubstr(words));
    EXPECT_FALSE(controller_->copy_of_state().servo) << "the trajectory mode was not even started";
  };
  auto good = turn_s(6);
  limits_.line_speed_mm_s = 5000;
  ArmJoints near = joints();
  near[0] += 0.9;
  refused(robot::plan_joint_move(*limits_.arm, joints(), near, 0.9), "deg/s");
  ArmJoints beyond = joints();
  beyond[5] = 6.4;
  refused(robot::plan_joint_move(*limits_.arm, joints(), beyond, 0.2), "axis T");
  ArmJoints low = joints();
  low[1] += 1.2;
  refused(robot::plan_joint_move(*limits_.arm, joints(), low, 0.05), "is outside");
  auto elsewhere = good;
  for (auto& p : elsewhere) p.position[5] += 0.1f;
  refused(elsewhere, "does not stand at the start");
  auto unfinished = good;
  unfinished.pop_back();
  refused(unfinished, "not at rest");
  auto backwards = good;
  backwards[2].time_s = 0.05f;
  refused(backwards, "must increase");
  auto broken = good;
  broken[1].position[2] = std::nanf("");
  refused(broken, "not finite");
  // Fine at both points, but between them the cubic swings out of the box.
  auto swinging = std::vector{good.front(), good.front(), good.front()};
  for (std::size_t i = 0; i < 3; ++i) swinging[i].sequence = static_cast<int>(i), swinging[i].time_s = 8.0f * i;
  swinging[1].velocity[0] = 0.3f;
  swinging[2].position[0] += 0.01f;
  const double wide_mm = std::exchange(limits_.box_max_mm[1], 100.0);
  refused(swinging, "before point 2: y =");
  limits_.box_max_mm[1] = wide_mm;
  good.front().sequence = 1;
  refused(good, "numbered");
}

TEST_P(ClientAndController, EveryHindranceIsNamed) {
  ASSERT_TRUE(client_->connect());
  const auto points = turn_s(3);
  const auto says = [&] { return robot::run_trajectory(*client_, points, limits_, *seat_).error().line(); };
  controller_->with_state([](sim::ControllerState& s) { s.turn_key_to_teach(); });
  EXPECT_THAT(says(), HasSubstr("TEACH"));
  controller_->with_state([](sim::ControllerState& s) { s.turn_key_to_remote(), s.press_emergency_stop(); });
  EXPECT_THAT(says(), HasSubstr("emergency stop"));
  controller_->with_state([](sim::ControllerState& s) { s.release_emergency_stop(), s.raise_alarm({4107, 0, ""}); });
  EXPECT_THAT(says(), HasSubstr("4107"));
  controller_->with_state([](sim::ControllerState& s) { s.reset_at_pendant(), s.remote = false; });
  EXPECT_THAT(says(), HasSubstr("5005"));
  controller_->with_state([](sim::ControllerState& s) { s.remote = true, s.hold_pendant = true, s.servo = true; });
  EXPECT_THAT(says(), HasSubstr("5007): held"));
}

/// Nobody knows whether the point was taken: it is not sent again, the arm is stopped.
TEST_P(ClientAndController, ALostAnswerStopsTheArmAndIsNeverRepeated) {
  answer_timeout_ = std::chrono::milliseconds(400);
  SetUp();
  for (const sim::Fault fault :
       {sim::Fault::drop, sim::Fault::half_line, sim::Fault::truncate, sim::Fault::reset_after_ok, sim::Fault::late}) {
    ASSERT_TRUE(client_->connect());
    const auto points = turn_s(fault == sim::Fault::half_line ? -30 : 30);
    sim::FaultEvent event;
    event.fault = fault;
    event.after_commands = 6;  // among the points
    event.delay_s = 1.0;
    controller_->follow({event});
    const auto moved = robot::run_trajectory(*client_, points, limits_, *seat_);
    ASSERT_FALSE(moved);
    EXPECT_THAT(moved.error().line(), HasSubstr("the arm was stopped")) << moved.error().line();
    EXPECT_FALSE(moved.error().trail.empty());
    const sim::Joints stopped = controller_->copy_of_state().q;
    seat_->sleep_for(std::chrono::milliseconds(100));
    EXPECT_EQ(controller_->copy_of_state().q, stopped);
  }
}

TEST_P(ClientAndController, AStopDuringAMoveIsSeenAndNothingGoesOn) {
  ASSERT_TRUE(client_->connect());
  sim::FaultEvent event;
  event.fault = sim::Fault::hold;
  event.at_s = 0.5;
  const auto points = turn_s(15);
  controller_->follow({event});
  const auto moved = robot::run_trajectory(*client_, points, limits_, *seat_);
  ASSERT_FALSE(moved);
  EXPECT_FALSE(moved.error().remedy.empty());
  const sim::Joints stopped = controller_->copy_of_state().q;
  EXPECT_LT(stopped[0] * 180 / M_PI, 14);
  controller_->with_state([](sim::ControllerState& s) { s.hold_pendant = false; });
  seat_->sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(controller_->copy_of_state().q, stopped);
  const auto again = robot::run_trajectory(*client_, turn_s(1), limits_, *seat_);
  EXPECT_TRUE(again) << again.error().line();
}

TEST_P(ClientAndController, PowerLossIsALostLinkAndTheNextConnectWorks) {
  ASSERT_TRUE(client_->connect());
  controller_->kill();
  EXPECT_EQ(client_->ready().error().code, core::ErrorCode::link);
  EXPECT_FALSE(client_->connected());
  EXPECT_EQ(client_->read_state().error().code, core::ErrorCode::link);
  EXPECT_FALSE(client_->connect());
  ASSERT_TRUE(controller_->revive());
  ASSERT_TRUE(client_->connect());
  EXPECT_FALSE(client_->ready().value());
}

TEST_P(ClientAndController, InputsOutputsAndRegisters) {
  ASSERT_TRUE(client_->connect());
  ASSERT_TRUE(client_->write_bit(27012, true));
  EXPECT_TRUE(client_->read_bit(27012).value());
  ASSERT_TRUE(client_->write_group(2701, 0x81));
  EXPECT_EQ(client_->read_group(2701).value(), 0x81);
  ASSERT_TRUE(client_->write_register(7, 4711));
  EXPECT_EQ(client_->read_register(7).value(), 4711);
  EXPECT_THAT(client_->write_bit(10, true).error().line(), HasSubstr("1002"));
  EXPECT_THAT(client_->read_register(1000).error().line(), HasSubstr("1001"));
  EXPECT_EQ(client_->read_register(1000).error().code, core::ErrorCode::refused);
}

/// Answers of the I/O port carry no number: one that comes twice must not be taken for that of the next question.
TEST_P(ClientAndController, ADoubledAnswerIsNotTakenForTheNext) {
  ASSERT_TRUE(client_->connect());
  ASSERT_TRUE(client_->write_group(2701, 0x81));
  ASSERT_TRUE(client_->write_group(2702, 0x42));
  for (int n = 1; n <= 3; ++n) {
    sim::FaultEvent event;
    event.fault = sim::Fault::twice;
    event.after_commands = n;
    controller_->follow({event});
    EXPECT_EQ(client_->read_group(2701).value(), 0x81);
    EXPECT_EQ(client_->read_group(2702).value(), 0x42);
    EXPECT_EQ(client_->read_group(2701).value(), 0x81);
    EXPECT_EQ(client_->read_group(2702).value(), 0x42);
  }
}

/// Hold, key, emergency stop, alarm and servo power show in the very next pair, 25 ms away, and are named.
TEST_P(ClientAndController, AStopShowsInTheNextState) {
  ASSERT_TRUE(client_->connect());
  using State = sim::ControllerState;
  const struct {
    const char* words;
    void (*done)(State&);
  } stops[] = {{"hold", [](State& s) { s.hold_pendant = true; }},
               {"play", [](State& s) { s.turn_key_to_teach(); }},
               {"REMOTE", [](State& s) { s.remote = false; }},
               {"mergency stop", [](State& s) { s.press_emergency_stop(); }},
               {"alarm", [](State& s) { s.raise_alarm({4107, 0, ""}); }},
               {"servo", [](State& s) { s.servo = false; }}};
  for (const auto& stop : stops) {
    controller_->with_state([](State& s) {
      s.reset_at_pendant(), s.release_emergency_stop();
      if (!s.play) s.turn_key_to_remote();
      s.remote = true, s.hold_pendant = false;
    });
    ASSERT_TRUE(client_->start_trajectory_mode()) << stop.words;
    ASSERT_EQ(client_->read_state()->status.motion_possible, 1) << stop.words;
    controller_->with_state(stop.done);
    EXPECT_EQ(client_->read_state()->status.motion_possible, 0) << stop.words;
    EXPECT_FALSE(client_->ready().value());
    const robot::MotoReply why = client_->last_reply();
    const robot::MotoFault fault = robot::moto_fault(why.result, why.subcode);
    EXPECT_THAT(fault.meaning + "; " + fault.remedy, HasSubstr(stop.words));
  }
}

TEST_P(ClientAndController, ALineKeepsTheToolOnItsWay) {
  ASSERT_TRUE(client_->connect());
  const ArmJoints from = joints();
  const auto start = robot::flange_in_base(*limits_.arm, from);
  const robot::FlangeInBase target(start.rotation(), start.translation_m() + Eigen::Vector3d(0.02, 0.03, -0.02));
  const auto points = robot::plan_line(limits_, from, target, 200);
  ASSERT_TRUE(points) << points.error().line();
  const auto moved = robot::run_trajectory(*client_, *points, limits_, *seat_);
  ASSERT_TRUE(moved) << moved.error().line();
  EXPECT_LT((controller_->T_base_flange().translation_m() - target.translation_m()).norm() * 1e3, 0.02);
}

/// `pickcell robot motoros://...` looks and moves through this.
TEST_P(ClientAndController, TheLinkAgreesWithTheOneOfTcp80) {
  robot::MotoRosLinkSettings settings;
  settings.client.host = "127.0.0.1";
  settings.client.port = controller_->motoros_port();
  settings.model = "gp7";
  robot::MotoRosLink link(settings);
  ASSERT_TRUE(link.connect());
  robot::Tcp80Settings other;
  other.host = "127.0.0.1";
  other.port = controller_->tcp80_port();
  robot::Tcp80Client tcp80(other);
  ASSERT_TRUE(tcp80.connect());
  const std::vector<std::function<void(sim::ControllerState&)>> situations = {
      [](sim::ControllerState&) {},
      [](sim::ControllerState& s) { s.servo = true; },
      [](sim::ControllerState& s) { s.hold_external = true; },
      [](sim::ControllerState& s) { s.raise_alarm({4107, 0, ""}), s.error = true; },
      [](sim::ControllerState& s) { s.turn_key_to_teach(); },
  };
  for (const auto& situation : situations) {
    controller_->with_state([&](sim::ControllerState& s) {
      s.reset_at_pendant(), s.turn_key_to_remote(), s.hold_external = false;
      situation(s);
    });
    const auto here = link.read_status(), there = tcp80.read_status();
    ASSERT_TRUE(here && there);
    const auto seen = [](const robot::RobotState& s) {
      return std::vector{s.running, s.teach, s.play, s.remote, s.hold_external, s.alarm, s.error, s.servo};
    };
    EXPECT_EQ(seen(*here), seen(*there));
    EXPECT_EQ(link.read_alarms()->size(), controller_->copy_of_state().alarms.size());
  }
  controller_->with_state([](sim::ControllerState& s) { s.turn_key_to_remote(); });
  EXPECT_EQ(link.read_contacts(27010, 2).value(), (std::vector<std::uint8_t>{0, 0}));
  EXPECT_EQ(link.read_job().error().code, core::ErrorCode::usage);

  robot::DirectMove down;
  down.kind = robot::DirectMove::Kind::line_by;
  down.speed = 100;
  down.target.z_mm = -15;
  const double z_m = controller_->T_base_flange().translation_m().z();
  const auto ended = [&] {
    for (;;) {
      const auto state = link.read_status();
      if (!state || !state->running) return state;
    }
  };
  ASSERT_TRUE(link.move(down));
  EXPECT_EQ(link.move(down).error().code, core::ErrorCode::refused) << "one at a time";
  const auto rest = ended();
  ASSERT_TRUE(rest) << rest.error().line();
  EXPECT_NEAR(controller_->T_base_flange().translation_m().z(), z_m - 0.015, 2e-5);
  const auto pose = link.read_position(0);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->z_mm, (z_m - 0.015) * 1e3, 0.05);
  EXPECT_NEAR(std::abs(pose->rx_deg), 180, 0.01);
  down.speed = 10;
  down.target.z_mm = -60;
  ASSERT_TRUE(link.move(down));
  while (!link.read_status()->running || client_->read_state()->status.in_motion != 1) {
  }
  const auto held = link.hold(true);
  ASSERT_TRUE(held) << held.error().line();
  const sim::Joints stopped = controller_->copy_of_state().q;
  seat_->sleep_for(std::chrono::milliseconds(60));
  EXPECT_EQ(controller_->copy_of_state().q, stopped);
  down.speed = 300;
  EXPECT_EQ(link.move(down).error().code, core::ErrorCode::safety);
  robot::DirectMove far;
  far.speed = 10;
  far.target = *pose;
  far.target.x_mm = 1500;
  EXPECT_EQ(link.move(far).error().code, core::ErrorCode::safety);
}

INSTANTIATE_TEST_SUITE_P(BothOrders, ClientAndController,
                         ::testing::Values(robot::ByteOrder::little, robot::ByteOrder::big),
                         [](const auto& test) { return test.param == robot::ByteOrder::big ? "big" : "little"; });

}  // namespace
}  // namespace pickcell
