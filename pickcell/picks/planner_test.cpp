#include "pickcell/picks/planner.hpp"

#include <gtest/gtest.h>

#include <random>

#include "pickcell/core/units.hpp"
#include "pickcell/picks/polygon.hpp"

namespace pickcell::picks {
namespace {

using core::Base;
using core::Part;
using core::rad_from_deg;
using core::Tool;

core::Transform<Part, Tool> grasp_on_part(double x, double y, double angle_deg) {
  const Eigen::Matrix3d down = Eigen::AngleAxisd(core::kPi, Eigen::Vector3d::UnitX()).toRotationMatrix();
  return {core::rotation_z(rad_from_deg(angle_deg)) * down, {x, y, 0}};
}

poses::PartPose part_at(double x, double y, double angle_deg, std::uint64_t id, int kind = 0) {
  poses::PartPose part;
  part.model = "bracket";
  part.model_index = kind;
  part.detection_id = id;
  part.score = 0.9;
  part.T_base_part = {core::rotation_z(rad_from_deg(angle_deg)), {x, y, -0.19}};
  const auto T_part_tool = grasp_on_part(0, 0, 0);
  part.grasps = {{part.T_base_part * T_part_tool, T_part_tool, false}};
  part.covariance.diagonal() << 1e-8, 1e-8, 1e-6;
  for (const auto& [dx, dy] : {std::pair{-.02, -.01}, {.02, -.01}, {.02, .01}, {-.02, .01}})
    part.outline_m.push_back(part.T_base_part.iso().linear().topLeftCorner<2, 2>() * Eigen::Vector2d(dx, dy) +
                             Eigen::Vector2d(x, y));
  return part;
}

PlannerSettings settings() {
  PlannerSettings s;
  s.parts = {{"bracket", 1, {{0.3, 0.3, -0.19}, rad_from_deg(90), 1, 3, 0.05, 0}}};
  s.box = {{0.2, -0.4, -0.25}, {0.7, 0.4, 0.1}};
  return s;
}

std::string only_refusal(const Plan& plan) {
  return plan.picks.empty() && plan.refusals.size() == 1 ? name(plan.refusals[0].reason) : "something else";
}

TEST(Planner, ThePartEndsWhereItBelongsEvenWithAnOffCentreGrasp) {
  auto part = part_at(0.45, 0.05, 33, 1);
  const auto T_part_tool = grasp_on_part(0.012, -0.004, 25);
  part.grasps = {{part.T_base_part * T_part_tool, T_part_tool, false}};
  const Plan plan = plan_picks(std::vector{part}, settings(), {{0}});
  ASSERT_EQ(plan.picks.size(), 1u);
  // The tool carries the part rigidly from grasp to place.
  const auto T_placed = plan.picks[0].T_base_place * plan.picks[0].T_base_grasp.inverse() * part.T_base_part;
  EXPECT_TRUE(T_placed.matrix().isApprox(settings().parts[0].place.slot(1).matrix(), 1e-9));
  EXPECT_EQ(plan.picks[0].place_slot, 1);
}

TEST(Planner, SlotsAreGivenOnceAndRunOut) {
  std::vector<poses::PartPose> parts;
  for (int i = 0; i < 4; ++i) parts.push_back(part_at(0.35 + 0.08 * i, 0, 0, static_cast<std::uint64_t>(i)));
  const Plan plan = plan_picks(parts, settings(), {});
  ASSERT_EQ(plan.picks.size(), 3u);
  std::set<int> slots;
  for (const Pick& p : plan.picks) slots.insert(p.place_slot);
  EXPECT_EQ(slots, (std::set<int>{0, 1, 2}));
  ASSERT_EQ(plan.refusals.size(), 1u);
  EXPECT_EQ(plan.refusals[0].reason, RefusalReason::pattern_full);
}

TEST(Planner, DoubtfulPartsAreRefusedWithTheirReason) {
  EXPECT_EQ(only_refusal(plan_picks(std::vector{part_at(0.9, 0, 0, 1)}, settings(), {})), "box");
  auto part = part_at(0.45, 0, 0, 1);
  part.covariance(0, 0) = 1.1e-3 * 1.1e-3;
  EXPECT_EQ(only_refusal(plan_picks(std::vector{part}, settings(), {})), "uncertain");
  part = part_at(0.45, 0, 0, 1);
  part.covariance(2, 2) = std::nan("");
  EXPECT_EQ(only_refusal(plan_picks(std::vector{part}, settings(), {})), "uncertain");
  part = part_at(0.45, 0, 0, 1);
  part.grasps.clear();
  EXPECT_EQ(only_refusal(plan_picks(std::vector{part}, settings(), {})), "no_grasp");
  EXPECT_EQ(only_refusal(plan_picks(std::vector{part_at(0.45, 0, 0, 1, 5)}, settings(), {})), "unknown_part");
}

TEST(Planner, AnAmbiguousAngleIsTakenOnlyWhenTheGraspIsTheSame) {
  auto part = part_at(0.45, 0, 10, 1);
  part.ambiguous_deg = {180};
  EXPECT_EQ(only_refusal(plan_picks(std::vector{part}, settings(), {})), "ambiguous");
  part.grasps[0].sym180 = true;
  EXPECT_EQ(plan_picks(std::vector{part}, settings(), {}).picks.size(), 1u);
  const auto off_centre = grasp_on_part(0.01, 0, 0);
  part.grasps = {{part.T_base_part * off_centre, off_centre, true}};
  EXPECT_EQ(only_refusal(plan_picks(std::vector{part}, settings(), {})), "ambiguous");
  part = part_at(0.45, 0, 10, 1);
  part.grasps[0].sym180 = true;
  part.ambiguous_deg = {51.4};
  EXPECT_EQ(only_refusal(plan_picks(std::vector{part}, settings(), {})), "ambiguous");
}

TEST(Planner, OnePartFoundTwiceIsPickedOnce) {
  auto better = part_at(0.45, 0, 0, 1), worse = part_at(0.4503, 0, 2, 2);
  worse.score = 0.7;
  const Plan plan = plan_picks(std::vector{worse, better}, settings(), {});
  ASSERT_EQ(plan.picks.size(), 1u);
  EXPECT_EQ(plan.picks[0].detection_id, 1u);
  EXPECT_EQ(plan.refusals[0].reason, RefusalReason::duplicate);
}

TEST(Planner, TheGripperNeedsRoom) {
  auto s = settings();
  s.gripper_length_m = 0.08;
  s.gripper_width_m = 0.02;
  const auto a = part_at(0.45, 0, 0, 1);  // the open gripper reaches 40 mm to either side along x
  EXPECT_EQ(plan_picks(std::vector{a, part_at(0.45, 0.03, 0, 2)}, s, {}).picks.size(), 2u);
  const Plan tight = plan_picks(std::vector{a, part_at(0.495, 0, 0, 2)}, s, {});
  EXPECT_TRUE(tight.picks.empty());
  EXPECT_EQ(tight.refusals[0].reason, RefusalReason::clearance);
}

TEST(Planner, ASymmetricGraspKeepsTheWristInItsMiddle) {
  auto part = part_at(0.45, 0, 170, 1);
  part.grasps[0].sym180 = true;
  auto s = settings();
  s.parts[0].place.angle_rad = rad_from_deg(170);
  const Plan plan = plan_picks(std::vector{part}, s, {});
  ASSERT_EQ(plan.picks.size(), 1u);
  const Eigen::Vector3d x = plan.picks[0].T_base_grasp.rotation().col(0);
  EXPECT_NEAR(core::deg_from_rad(std::atan2(x.y(), x.x())), -10, 1e-6);
}

TEST(Polygon, OverlapOfTurnedRectanglesAgreesWithMonteCarlo) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto rectangle = [&](double cx, double cy, double w, double h, double a) {
    Polygon p;
    for (const auto& [i, j] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
      p.emplace_back(cx + std::cos(a) * i * w - std::sin(a) * j * h, cy + std::sin(a) * i * w + std::cos(a) * j * h);
    return p;
  };
  for (int round = 0; round < 20; ++round) {
    const double ax = u(random) * .3, ay = u(random) * .3, aa = u(random) * 3, bx = u(random) * .3, by = u(random) * .3,
                 ba = u(random) * 3;
    const Polygon a = rectangle(ax, ay, .5, .3, aa), b = rectangle(bx, by, .4, .2, ba);
    int both = 0;
    constexpr int kShots = 40000;
    for (int i = 0; i < kShots; ++i) {
      const double x = 1.2 * u(random), y = 1.2 * u(random);
      const auto in = [&](double cx, double cy, double w, double h, double t) {
        const double dx = x - cx, dy = y - cy;
        return std::abs(std::cos(t) * dx + std::sin(t) * dy) < w && std::abs(-std::sin(t) * dx + std::cos(t) * dy) < h;
      };
      both += in(ax, ay, .5, .3, aa) && in(bx, by, .4, .2, ba);
    }
    EXPECT_NEAR(overlap(a, b), both * 5.76 / kShots / .32, 0.06);
  }
}

}  // namespace
}  // namespace pickcell::picks
