#include "pickcell/sim/motoros_motion.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <functional>
#include <vector>

#include "pickcell/sim/job_interpreter.hpp"
#include "pickcell/sim/motoros_io.hpp"
#include "pickcell/sim/shipped_jobs.hpp"

namespace pickcell::sim {
namespace {

namespace moto = robot::moto;
using robot::MotoCommand;
using robot::MotoFrame;
using robot::MotoReply;
using robot::MotoTrajectoryPoint;

class MotoRos : public ::testing::Test {
 protected:
  void run(double time_s) {
    for (double t = 0; t < time_s - 1e-9; t += kTick_s) {
      run_tick(state_, kTick_s);
      motion_.tick(state_, kTick_s);
    }
  }
  MotoReply ask(const MotoFrame& message) {
    const MotoRosAnswer answer = motion_.handle(state_, message);
    EXPECT_TRUE(answer.frame) << "no answer yet";
    return answer.frame ? robot::parse_moto_reply(*answer.frame).value() : MotoReply{};
  }
  MotoReply command(std::int32_t command) {
    MotoCommand c;
    c.command = command;
    return ask(moto_frame(c));
  }
  /// START_TRAJ_MODE, waited for.
  MotoReply start() {
    MotoCommand c;
    c.command = moto::kStartTrajectoryMode;
    MotoRosAnswer answer = motion_.handle(state_, moto_frame(c));
    for (int i = 0; i < 1000 && !answer.frame; ++i) {
      run(kTick_s);
      answer.frame = motion_.waited(state_);
    }
    return robot::parse_moto_reply(answer.frame.value()).value();
  }
  MotoTrajectoryPoint point(int sequence, double time_s, const Joints& q, const Joints& v = Joints::Zero()) {
    MotoTrajectoryPoint p;
    p.sequence = sequence;
    p.valid = 7;
    p.time_s = static_cast<float>(time_s);
    for (int i = 0; i < 6; ++i) {
      p.position[static_cast<std::size_t>(i)] = static_cast<float>(q[i]);
      p.velocity[static_cast<std::size_t>(i)] = static_cast<float>(v[i]);
    }
    return p;
  }
  static void expect(const MotoReply& r, std::int32_t result, std::int32_t subcode = 0) {
    EXPECT_EQ(r.result, result) << "subcode " << r.subcode;
    EXPECT_EQ(r.subcode, subcode);
  }
  Joints home() const { return state_.q; }

  static constexpr double kTick_s = 0.010;
  static ControllerSettings settings() {
    ControllerSettings s;
    s.jobs = shipped_jobs();
    return s;
  }
  ControllerState state_{settings()};
  MotoRosMotion motion_;
};

TEST_F(MotoRos, StartsTheJobAndIsReadyWhenOutput889Is) {
  expect(command(moto::kCheckReady), moto::no, moto::because_servo_off);
  expect(start(), moto::ok);
  EXPECT_TRUE(state_.outputs[889]);
  EXPECT_TRUE(state_.servo);
  EXPECT_EQ(state_.task.at.job->name, "INIT_ROS");
  EXPECT_FALSE(state_.jobs.contains("INIT_ROS")) << "not among the jobs that a host lists";
  expect(command(moto::kCheckReady), moto::ok);
  EXPECT_EQ(motion_.status(state_).motion_possible, 1);
  expect(command(moto::kStopTrajectoryMode), moto::ok);
  run(0.1);
  EXPECT_FALSE(state_.running());
  EXPECT_FALSE(state_.outputs[889]);
  EXPECT_FALSE(state_.outputs[890]);
}

TEST_F(MotoRos, RefusesToStartWhatOnlyAPersonCanPutRight) {
  state_.press_emergency_stop();
  expect(start(), moto::not_ready, moto::because_emergency_stop);
  state_.release_emergency_stop();
  state_.hold_pendant = true;
  expect(start(), moto::not_ready, moto::because_servo_off);  // the first reason in MotoROS' order
  state_.servo = true;
  expect(start(), moto::not_ready, moto::because_hold);
  state_.hold_pendant = false;
  state_.turn_key_to_teach();
  expect(start(), moto::not_ready, moto::because_not_play);
  state_.turn_key_to_remote();
  state_.raise_alarm({3000, 0, "major"});
  expect(start(), moto::not_ready, moto::because_alarm);
  state_.reset_at_pendant();
  state_.raise_alarm({4107, 0, "minor"});
  expect(start(), moto::ok);  // reset from afar
  EXPECT_TRUE(state_.alarms.empty());
}

TEST_F(MotoRos, AnotherJobIsNotInterrupted) {
  state_.servo = true;
  state_.task.at = {state_.jobs.at("VISPICK"), 0};
  state_.task.running = true;
  expect(start(), moto::not_ready, moto::because_not_waiting);
  EXPECT_EQ(state_.task.at.job->name, "VISPICK");
}

TEST_F(MotoRos, StepModeNeverGetsReadyAndSaysSoAfterFiveSeconds) {
  state_.cycle = CycleMode::step;
  expect(start(), moto::not_ready, moto::because_not_started);
}

TEST_F(MotoRos, RefusalsOfPointsInTheirOrder) {
  const Joints q = home();
  expect(ask(moto_frame(point(0, 0, q))), moto::not_ready, moto::because_servo_off);
  expect(start(), moto::ok);
  auto wrong_group = point(0, 0, q);
  wrong_group.group = 1;
  expect(ask(moto_frame(wrong_group)), moto::invalid, moto::group);
  auto no_speed = point(0, 0, q);
  no_speed.valid = 3;
  expect(ask(moto_frame(no_speed)), moto::invalid, moto::fields_missing);
  expect(ask(moto_frame(point(0, 4 * 3600.0, q))), moto::invalid, moto::time);
  expect(ask(moto_frame(point(-1, 0, q))), moto::invalid, moto::sequence);
  expect(ask(moto_frame(point(0, 0, q, Joints::Constant(100)))), moto::invalid, moto::speed);
  expect(ask(moto_frame(point(0, 0, Joints::Constant(std::nan(""))))), moto::invalid, moto::data);
  MotoFrame short_frame = moto_frame(point(0, 0, q));
  short_frame.body.pop_back();
  expect(ask(short_frame), moto::invalid, moto::size);
  const MotoRosAnswer unknown = motion_.handle(state_, {4711, 2, 0, {}});
  EXPECT_TRUE(unknown.close);
  const auto reply = robot::parse_moto_reply(*unknown.frame).value();
  expect(reply, moto::invalid, moto::type);
  EXPECT_EQ(reply.group, -1);
  EXPECT_EQ(reply.sequence, -1);
  expect(command(200199), moto::invalid, moto::command);
}

TEST_F(MotoRos, TheStartMustBeWithin30PulsesOnEveryAxis) {
  expect(start(), moto::ok);
  for (int axis = 0; axis < 6; ++axis) {
    Joints q = home();
    q[axis] += 31 / state_.arm->pulses_per_rad[axis];
    expect(ask(moto_frame(point(0, 0, q))), moto::invalid, moto::start_position);
    q[axis] = home()[axis] - 29 / state_.arm->pulses_per_rad[axis];
    expect(ask(moto_frame(point(0, 0, q))), moto::ok);
  }
}

TEST_F(MotoRos, OnePointIsBufferedUntilItIsCut) {
  expect(start(), moto::ok);
  Joints q = home();
  expect(ask(moto_frame(point(0, 0, q))), moto::ok);
  // 200 increments of 4 ms: a point that ends within 0.8 s is cut at once, a later one stays in the buffer.
  q[0] += 0.1;
  expect(ask(moto_frame(point(1, 0.5, q))), moto::ok);
  EXPECT_EQ(command(moto::kQueueCount).subcode, 125);
  q[0] += 0.1;
  expect(ask(moto_frame(point(2, 1.0, q))), moto::ok);
  EXPECT_EQ(command(moto::kQueueCount).subcode, 200);
  q[0] += 0.1;
  const MotoReply busy = ask(moto_frame(point(3, 1.5, q)));
  expect(busy, moto::busy);
  EXPECT_EQ(busy.sequence, 3);
  EXPECT_EQ(busy.command, moto::kTrajectoryPoint);
  run(0.19);
  expect(ask(moto_frame(point(3, 1.5, q))), moto::busy);
  run(0.02);
  expect(ask(moto_frame(point(3, 1.5, q))), moto::ok);
  expect(command(moto::kStopTrajectoryMode), moto::no);  // not while the queue holds motion
  EXPECT_EQ(motion_.status(state_).in_motion, 1);
  run(1.5);
  EXPECT_EQ(motion_.status(state_).in_motion, 0);
  EXPECT_NEAR(state_.q[0], static_cast<double>(static_cast<float>(q[0])), 1e-9);
}

TEST_F(MotoRos, BetweenPointsPositionAndSpeedAreMetByACubic) {
  expect(start(), moto::ok);
  const Joints q0 = home();
  Joints q1 = q0, v1 = Joints::Zero();
  q1[0] += 0.2;
  v1[0] = 0.3;
  expect(ask(moto_frame(point(0, 0, q0))), moto::ok);
  expect(ask(moto_frame(point(1, 1, q1, v1))), moto::ok);
  // x(0) = 0, x'(0) = 0, x(1) = 0.2, x'(1) = 0.3: x = 0.3 t^2 - 0.1 t^3
  for (int i = 1; i <= 100; ++i) {
    run(kTick_s);
    const double t = i * kTick_s;
    EXPECT_NEAR(state_.q[0] - q0[0], 0.3 * t * t - 0.1 * t * t * t, 1e-6);
  }
}

TEST_F(MotoRos, StopEmptiesTheQueueAtOnce) {
  expect(start(), moto::ok);
  Joints q = home();
  expect(ask(moto_frame(point(0, 0, q))), moto::ok);
  q[0] += 0.5;
  expect(ask(moto_frame(point(1, 2, q))), moto::ok);
  run(0.5);
  const Joints stopped = home();
  expect(command(moto::kStop), moto::ok);
  run(0.5);
  EXPECT_EQ(home(), stopped);
  EXPECT_FALSE(motion_.holds_motion());
  expect(command(moto::kCheckReady), moto::ok);
}

/// Key, hold, emergency stop, alarm, servo: the rest of the trajectory is gone, and nothing goes on by itself.
TEST_F(MotoRos, LosingReadinessDropsTheQueue) {
  const std::vector<std::function<void(ControllerState&)>> losses = {
      [](ControllerState& s) { s.turn_key_to_teach(); }, [](ControllerState& s) { s.remote = false; },
      [](ControllerState& s) { s.hold_pendant = true; }, [](ControllerState& s) { s.press_emergency_stop(); },
      [](ControllerState& s) { s.servo = false; },       [](ControllerState& s) { s.raise_alarm({4107, 0, ""}); }};
  for (const auto& loss : losses) {
    expect(start(), moto::ok);
    Joints q = home();
    expect(ask(moto_frame(point(0, 0, q))), moto::ok);
    q[0] += 0.1;
    expect(ask(moto_frame(point(1, 1, q))), moto::ok);
    run(0.3);
    loss(state_);
    run(0.1);
    const Joints stopped = home();
    EXPECT_FALSE(motion_.holds_motion());
    state_.hold_pendant = false;
    state_.release_emergency_stop();
    state_.reset_at_pendant();
    state_.turn_key_to_remote();
    run(1);
    EXPECT_EQ(home(), stopped);
  }
}

TEST_F(MotoRos, AHostThatLeavesStopsTheArm) {
  expect(start(), moto::ok);
  Joints q = home();
  expect(ask(moto_frame(point(0, 0, q))), moto::ok);
  q[0] += 0.1;
  expect(ask(moto_frame(point(1, 1, q))), moto::ok);
  run(0.3);
  motion_.host_left();
  const Joints stopped = home();
  run(0.5);
  EXPECT_EQ(home(), stopped);
}

TEST_F(MotoRos, AnAxisLimitInATrajectoryIsAnAlarm) {
  expect(start(), moto::ok);
  Joints q = home();
  q[0] = state_.arm->upper[0] + 0.1;
  expect(ask(moto_frame(point(0, 0, home()))), moto::ok);
  expect(ask(moto_frame(point(1, 5, q))), moto::ok);  // MotoROS does not know the soft limits
  run(5);
  ASSERT_FALSE(state_.alarms.empty());
  EXPECT_EQ(state_.alarms.front().code, kAlarmPulseLimit);
  EXPECT_TRUE(inside_limits(*state_.arm, state_.q));
  EXPECT_EQ(motion_.status(state_).error_code, kAlarmPulseLimit);
  EXPECT_EQ(motion_.status(state_).in_error, 1);
}

TEST_F(MotoRos, GroupsAndTools) {
  expect(start(), moto::ok);
  robot::MotoTrajectoryPointEx ex;
  ex.groups = 1;
  ex.parts[0].valid = 7;
  for (int i = 0; i < 6; ++i) ex.parts[0].position[static_cast<std::size_t>(i)] = static_cast<float>(home()[i]);
  const MotoReply taken = ask(moto_frame(ex));
  expect(taken, moto::ok);
  EXPECT_EQ(taken.command, moto::kTrajectoryPointEx);
  ex.groups = 2;
  expect(ask(moto_frame(ex)), moto::invalid, moto::group);
  expect(ask(moto_frame(robot::MotoSelectTool{0, 3, 9})), moto::ok);
  EXPECT_EQ(state_.tool, 3);
  expect(ask(moto_frame(robot::MotoSelectTool{0, 64, 9})), moto::invalid, moto::tool);
}

TEST_F(MotoRos, TellsTheLinksOfItsOneGroup) {
  const MotoRosAnswer answer = motion_.handle(state_, {2020, 2, 0, {}});
  ASSERT_TRUE(answer.frame);
  EXPECT_EQ(answer.frame->type, 2020);
  EXPECT_EQ(answer.frame->comm, moto::kReply);
  EXPECT_EQ(answer.frame->reply, moto::kSuccess);
  ASSERT_EQ(answer.frame->body.size(), 4u * 8 * 4);  // groups, links, numbers
  const auto number = [&](std::size_t link, std::size_t n) {
    return std::bit_cast<float>(answer.frame->body[link * 4 + n]);
  };
  EXPECT_FLOAT_EQ(number(0, 2), 40);    // S to L
  EXPECT_FLOAT_EQ(number(1, 2), 445);   // L to U
  EXPECT_FLOAT_EQ(number(3, 1), -440);  // U to B
  for (std::size_t word = 6 * 4; word < answer.frame->body.size(); ++word) EXPECT_EQ(answer.frame->body[word], 0u);
  expect(ask({2020, 2, 0, {1}}), moto::invalid, moto::size);
}

TEST_F(MotoRos, ContactsGroupsAndRegisters) {
  const auto io = [this](std::int32_t type, const auto& message) {
    return execute_motoros_io(state_, moto_frame(type, message));
  };
  using robot::MotoAddress, robot::MotoValue, robot::MotoWrite, robot::MotoWritten;
  EXPECT_EQ(io(moto::kWriteBit, MotoWrite{27013, 1}), moto_frame(moto::kWriteBitReply, MotoWritten{0}));
  EXPECT_EQ(io(moto::kReadBit, MotoAddress{27013}), moto_frame(moto::kReadBitReply, MotoValue{1, 0}));
  EXPECT_EQ(io(moto::kReadGroup, MotoAddress{2701}), moto_frame(moto::kReadGroupReply, MotoValue{8, 0}));
  EXPECT_EQ(state_.network_inputs.at(2701), 8);
  EXPECT_EQ(io(moto::kWriteGroup, MotoWrite{1001, 0x81}), moto_frame(moto::kWriteGroupReply, MotoWritten{0}));
  EXPECT_TRUE(state_.outputs[1] && state_.outputs[8] && !state_.outputs[2]);
  EXPECT_EQ(io(moto::kWriteRegister, MotoWrite{5, 700}), moto_frame(moto::kWriteRegister, MotoWritten{0}));
  EXPECT_EQ(io(moto::kReadRegister, MotoAddress{5}), moto_frame(moto::kReadRegister, MotoValue{700, 0}));
  // the result codes of the reference
  EXPECT_EQ(io(moto::kReadBit, MotoAddress{27018}), moto_frame(moto::kReadBitReply, MotoValue{0, 1001}));
  EXPECT_EQ(io(moto::kReadGroup, MotoAddress{4'000'000'000}), moto_frame(moto::kReadGroupReply, MotoValue{0, 1001}));
  EXPECT_EQ(io(moto::kReadRegister, MotoAddress{1000}), moto_frame(moto::kReadRegister, MotoValue{0, 1001}));
  EXPECT_EQ(io(moto::kWriteBit, MotoWrite{10, 1}), moto_frame(moto::kWriteBitReply, MotoWritten{1002}));
  EXPECT_EQ(io(moto::kWriteGroup, MotoWrite{1, 1}), moto_frame(moto::kWriteGroupReply, MotoWritten{1002}));
  EXPECT_EQ(io(moto::kWriteRegister, MotoWrite{560, 1}), moto_frame(moto::kWriteRegister, MotoWritten{1002}));
  EXPECT_EQ(io(moto::kWriteBit, MotoWrite{27010, 2}), moto_frame(moto::kWriteBitReply, MotoWritten{1003}));
  EXPECT_EQ(io(moto::kWriteGroup, MotoWrite{2701, 256}), moto_frame(moto::kWriteGroupReply, MotoWritten{1003}));
  EXPECT_EQ(io(moto::kWriteRegister, MotoWrite{0, 65536}), moto_frame(moto::kWriteRegister, MotoWritten{1003}));
  EXPECT_EQ(execute_motoros_io(state_, {2011, 2, 0, {}}), moto_frame(robot::MotoIoRefusal{3, 3003}));
  EXPECT_EQ(execute_motoros_io(state_, {2003, 2, 0, {}}), moto_frame(robot::MotoIoRefusal{3, 3001}));
}

}  // namespace
}  // namespace pickcell::sim
