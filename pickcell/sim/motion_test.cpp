#include "pickcell/sim/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "pickcell/core/units.hpp"
#include "pickcell/sim/position.hpp"

namespace pickcell::sim {
namespace {

constexpr double kTick_s = 0.001;

Joints deg(double s, double l, double u, double r, double b, double t) {
  return Joints{s, l, u, r, b, t} * (core::kPi / 180.0);
}

const Arm& gp7() { return arm(ArmModel::gp7); }

ToolData tool() { return ToolData(Eigen::Matrix3d::Identity(), {0, 0, 0.15}); }

ToolPose down(double x_mm, double y_mm, double z_mm, double rz_deg) {
  return ToolPose(pose_from_cartesian({static_cast<int>(x_mm * 1000), static_cast<int>(y_mm * 1000),
                                       static_cast<int>(z_mm * 1000), 1800000, 0, static_cast<int>(rz_deg * 10000)}));
}

Joints at(const ToolPose& pose) {
  const auto q = inverse_in_form(gp7(), pose * tool().inverse(), Form{}, Joints::Zero());
  return q.value();
}

struct Ride {
  double seconds = 0;
  Joints end;
  double fastest_m_s = 0;
  double off_line_m = 0;
  std::optional<MoveFault> fault;
};

Ride ride(Move move, const Joints& from, const ToolPose* line_to = nullptr) {
  Ride r{0, from, 0, 0, {}};
  const Eigen::Vector3d start = (forward(gp7(), from) * tool()).translation_m();
  for (bool finished = false; !finished && !r.fault;) {
    const Move::Step step = move.advance(kTick_s);
    const Eigen::Vector3d a = (forward(gp7(), r.end) * tool()).translation_m();
    const Eigen::Vector3d b = (forward(gp7(), step.q) * tool()).translation_m();
    r.fastest_m_s = std::max(r.fastest_m_s, (b - a).norm() / kTick_s);
    if (line_to) {
      const Eigen::Vector3d along = (line_to->translation_m() - start).normalized();
      r.off_line_m = std::max(r.off_line_m, ((b - start) - along * along.dot(b - start)).norm());
    }
    r.end = step.q;
    r.fault = step.fault;
    r.seconds += kTick_s;
    finished = step.finished;
  }
  return r;
}

TEST(Trapezoid, TakesWayOverSpeedPlusOneRamp) {
  const Trapezoid long_way{0.5, 2.0};  // ramp 0.25 s, two half ramps of way
  EXPECT_DOUBLE_EQ(long_way.duration_s(), 2.25);
  EXPECT_DOUBLE_EQ(long_way.at(0.25), 0.0625);
  EXPECT_DOUBLE_EQ(long_way.at(1.125), 0.5);
  EXPECT_DOUBLE_EQ(long_way.at(2.0), 1 - 0.0625);
  const Trapezoid short_way{10, 4};
  EXPECT_DOUBLE_EQ(short_way.duration_s(), 1.0);
  EXPECT_DOUBLE_EQ(short_way.at(0.5), 0.5);
}

TEST(Move, AxesArriveTogetherAfterTheTimeOfTheSlowest) {
  const Joints from = deg(0, 0, 0, 0, -90, 0), to = deg(90, 10, 5, 0, -80, 30);
  const Move move = Move::joint(gp7(), {}, from, to, 0.2);
  // S: 90 deg at 20 % of 375 deg/s, acceleration 375 / 0.25 s
  const double expected_s = 90 / 75.0 + 75 / 1500.0;
  EXPECT_NEAR(move.duration_s(), expected_s, 1e-12);
  const Ride r = ride(move, from);
  EXPECT_NEAR(r.seconds, expected_s, 1.5 * kTick_s);
  EXPECT_LT((r.end - to).norm(), 1e-12);
}

TEST(Move, ALineIsStraightAndKeepsItsSpeed) {
  const Joints from = at(down(400, -100, -100, 0));
  const ToolPose target = down(450, 150, -150, 60);
  const Move move = Move::line(gp7(), {}, from, tool(), target, 0.1, 10);
  const double way = std::hypot(0.05, 0.25, 0.05);
  EXPECT_NEAR(move.duration_s(), way / 0.1 + 0.1 / 3.0, 1e-9);
  const Ride r = ride(move, from, &target);
  EXPECT_FALSE(r.fault.has_value());
  EXPECT_LT(r.off_line_m, 1e-9);
  EXPECT_NEAR(r.fastest_m_s, 0.1, 1e-6);
  EXPECT_LT(((forward(gp7(), r.end) * tool()).matrix() - target.matrix()).norm(), 1e-7);
}

TEST(Move, ATurnOnTheSpotTakesTheTurningTime) {
  const Joints from = at(down(400, 0, -100, 0));
  const ToolPose target = down(400, 0, -100, 90);
  const Move move = Move::line(gp7(), {}, from, tool(), target, 0.3, 100);
  EXPECT_NEAR(move.duration_s(), 90.0 / 180 + 180.0 / 720, 1e-9);
  EXPECT_FALSE(ride(move, from).fault.has_value());
}

TEST(Move, StopsOnThePathAndGoesOnToTheSameEnd) {
  const Joints from = at(down(400, -100, -100, 0));
  const ToolPose target = down(400, 150, -100, 0);
  Move move = Move::line(gp7(), {}, from, tool(), target, 0.1, 10);
  Move::Step step{};
  for (int i = 0; i < 1000; ++i) step = move.advance(kTick_s);
  const Joints when_held = step.q;
  move.stop(0.15);
  int ticks = 0;
  for (; !move.at_rest(); ++ticks) step = move.advance(kTick_s);
  EXPECT_NEAR(ticks * kTick_s, 0.15, 1.5 * kTick_s);
  const double rolled_m =
      ((forward(gp7(), step.q) * tool()).translation_m() - (forward(gp7(), when_held) * tool()).translation_m()).norm();
  EXPECT_NEAR(rolled_m, 0.1 * 0.15 / 2, 1e-4);
  const Joints rest = step.q;
  for (int i = 0; i < 500; ++i) step = move.advance(kTick_s);
  EXPECT_EQ(step.q, rest);
  move.resume();
  while (!step.finished) step = move.advance(kTick_s);
  EXPECT_LT(((forward(gp7(), step.q) * tool()).matrix() - target.matrix()).norm(), 1e-7);
}

TEST(Move, ALineOutOfReachOrIntoALimitFaultsOnTheWayAndStays) {
  const Joints from = at(down(600, 0, 0, 0));
  const ToolPose beyond = down(1200, 0, 0, 0);
  const Ride r = ride(Move::line(gp7(), {}, from, tool(), beyond, 0.2, 10), from);
  EXPECT_TRUE(r.fault.has_value());  // the elbow cannot stretch fast enough just before the reach ends
  EXPECT_TRUE(inside_limits(gp7(), r.end));

  Joints turned = at(down(400, 0, -100, 0));
  turned[5] += 2 * core::kPi - 0.1;  // T nearly at its end
  const Ride t = ride(Move::line(gp7(), {}, turned, tool(), down(400, 0, -100, -90), 0.2, 10), turned);
  const Ride u = ride(Move::line(gp7(), {}, turned, tool(), down(400, 0, -100, 90), 0.2, 10), turned);
  EXPECT_NE(t.fault.has_value(), u.fault.has_value()) << "one way round is free, the other one blocked";
}

TEST(Move, ALineThroughTheStretchedWristFaultsBecauseAnAxisCannotFollow) {
  const Joints from = deg(0, 0, 0, 0, 2, 0);
  const ToolPose here = forward(gp7(), from) * ToolData();
  // sideways at the height where forearm and flange come into line
  const ToolPose target(here.rotation(), here.translation_m() + Eigen::Vector3d(0, 0.2, 0));
  const Ride r = ride(Move::line(gp7(), {}, from, ToolData(), target, 0.5, 10), from);
  EXPECT_EQ(r.fault, MoveFault::too_fast);
}

/// What a pick does everywhere in the cell: down 80 mm and up again, at every turn of the tool.
TEST(Move, ApproachLinesAreFreeOverTheWorkArea) {
  for (int x = 350; x <= 600; x += 125)
    for (int y = -250; y <= 250; y += 125)
      for (int z = -250; z <= -100; z += 150)
        for (int rz = -170; rz <= 180; rz += 50) {
          const Joints from = at(down(x, y, z + 80, rz));
          const ToolPose target = down(x, y, z, rz);
          Move move = Move::line(gp7(), {}, from, tool(), target, 0.3, 10);
          for (Move::Step step{from, false, {}}; !step.finished;) {
            step = move.advance(0.01);
            ASSERT_FALSE(step.fault.has_value()) << x << " " << y << " " << z << " " << rz;
          }
        }
}

}  // namespace
}  // namespace pickcell::sim
