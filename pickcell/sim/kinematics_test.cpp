#include "pickcell/sim/kinematics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pickcell/core/units.hpp"
#include "pickcell/sim/dh_links.hpp"

namespace pickcell::sim {
namespace {

Joints deg(double s, double l, double u, double r, double b, double t) {
  return Joints{s, l, u, r, b, t} * (core::kPi / 180.0);
}

Eigen::Matrix3d zyx(double rx_deg, double ry_deg, double rz_deg) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(core::rad_from_deg(rz_deg), Vector3d::UnitZ()) *
          AngleAxisd(core::rad_from_deg(ry_deg), Vector3d::UnitY()) *
          AngleAxisd(core::rad_from_deg(rx_deg), Vector3d::UnitX()))
      .toRotationMatrix();
}

struct Reference {
  ArmModel model;
  Joints q;
  double x_mm, y_mm, z_mm, rx_deg, ry_deg, rz_deg;
};

TEST(Kinematics, ReachesTheReferencePosesOfTheUrdfs) {
  const Reference table[] = {
      {ArmModel::gp7, deg(0, 0, 0, 0, 0, 0), 560, 0, 485, 180, -90, 0},
      {ArmModel::gp7, deg(0, 0, 0, 0, -90, 0), 480, 0, 405, 180, 0, 0},
      {ArmModel::gp7, deg(30, 20, -10, 15, -60, 40), 523.758, 281.686, 154.849, 170.548, 8.939, 76.792},
      {ArmModel::gp7, deg(-45, 35, -20, 0, -35, 90), 410.392, -410.392, -52.961, 180, 0, 45},
      {ArmModel::gp8, deg(0, 0, 0, 0, -90, 0), 380, 0, 305, 180, 0, 0},
      {ArmModel::gp8, deg(30, 20, -10, 15, -60, 40), 419.138, 221.284, 110.879, 170.548, 8.939, 76.792},
      {ArmModel::motomini, deg(0, 0, 0, 0, 0, 0), 185, 0, 125, 180, 0, 0},
      {ArmModel::motomini, deg(30, 20, -10, 15, -60, 40), 158.185, 85.351, 73.139, -88.141, 62.942, 129.092},
  };
  for (const Reference& ref : table) {
    const FlangePose T = forward(arm(ref.model), ref.q);
    EXPECT_NEAR(core::mm_from_m(T.translation_m().x()), ref.x_mm, 6e-4);
    EXPECT_NEAR(core::mm_from_m(T.translation_m().y()), ref.y_mm, 6e-4);
    EXPECT_NEAR(core::mm_from_m(T.translation_m().z()), ref.z_mm, 6e-4);
    EXPECT_LT((T.rotation() - zyx(ref.rx_deg, ref.ry_deg, ref.rz_deg)).norm(), 4e-5) << name(ref.model);
  }
}

Joints random_joints(const Arm& a, std::mt19937& random) {
  Joints q;
  for (int i = 0; i < 6; ++i) q[i] = std::uniform_real_distribution(a.lower[i], a.upper[i])(random);
  return q;
}

class EveryArm : public testing::TestWithParam<ArmModel> {};

TEST_P(EveryArm, FindsTheWayBackFromRandomJointsInTheirForm) {
  const Arm& a = arm(GetParam());
  std::mt19937 random(7);
  for (int i = 0; i < 5000; ++i) {
    const Joints q = random_joints(a, random);
    const auto back = inverse_in_form(a, forward(a, q), form_of(a, q), q);
    ASSERT_TRUE(back.has_value()) << q.transpose();
    EXPECT_LT((*back - q).norm(), 1e-6) << q.transpose() << " / " << back->transpose();
  }
}

TEST_P(EveryArm, TheLinksOfDenavitAndHartenbergLeadToTheSameFlange) {
  const Arm& a = arm(GetParam());
  std::mt19937 random(10);
  const auto links = dh_links(a);
  for (int i = 0; i < 200; ++i) {
    const Joints q = random_joints(a, random);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    for (int n = 0; n < 6; ++n) {
      const DhLink& link = links[static_cast<std::size_t>(n)];
      T = T * Eigen::AngleAxisd(link.theta_rad + q[n], Eigen::Vector3d::UnitZ()) *
          Eigen::Translation3d(link.a_m * Eigen::Vector3d::UnitX() + link.d_m * Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(link.alpha_rad, Eigen::Vector3d::UnitX());
    }
    EXPECT_LT((T.matrix() - forward(a, q).matrix()).norm(), 1e-12);
  }
}

TEST_P(EveryArm, EveryWayLeadsToThePose) {
  const Arm& a = arm(GetParam());
  std::mt19937 random(8);
  std::size_t ways = 0;
  for (int i = 0; i < 2000; ++i) {
    const FlangePose T = forward(a, random_joints(a, random));
    for (const Joints& q : inverse(a, T, random_joints(a, random))) {
      ++ways;
      EXPECT_LT((forward(a, q).matrix() - T.matrix()).norm(), 1e-7);
    }
  }
  EXPECT_GT(ways, 2000u * 4);
}

TEST_P(EveryArm, FollowsASmallStepContinuously) {
  const Arm& a = arm(GetParam());
  std::mt19937 random(9);
  std::normal_distribution<double> step(0, 1e-4);
  for (int i = 0; i < 2000; ++i) {
    const Joints q = random_joints(a, random);
    Joints next = q;
    for (int k = 0; k < 6; ++k) next[k] += step(random);
    if (form_of(a, q).elbow_below != form_of(a, next).elbow_below || form_of(a, q).back != form_of(a, next).back)
      continue;
    const auto found = inverse_continuing(a, forward(a, next), q);
    ASSERT_TRUE(found.has_value());
    EXPECT_LT((*found - next).norm(), 1e-6);
  }
}

TEST_P(EveryArm, RefusesWhatIsOutOfReach) {
  const Arm& a = arm(GetParam());
  EXPECT_TRUE(inverse(a, FlangePose(zyx(180, 0, 0), {1.2, 0, 0}), Joints::Zero()).empty());
  EXPECT_FALSE(inverse_in_form(a, FlangePose(zyx(180, 0, 0), {0.3, 0, 0.9}), {}, Joints::Zero()).has_value());
}

TEST_P(EveryArm, KeepsRWhenTheWristIsInLine) {
  const Arm& a = arm(GetParam());
  Joints q = deg(10, 5, -5, 33, 0, 20);
  q[4] = -a.b_zero_rad;
  const auto found = inverse_continuing(a, forward(a, q), q);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT((*found - q).norm(), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Kinematics, EveryArm, testing::Values(ArmModel::gp7, ArmModel::gp8, ArmModel::motomini),
                         [](const auto& tested) { return std::string(name(tested.param)); });

/// The simulated cell works with the tool (150 mm) straight down over this box: every turn of the tool must be
/// reachable in the form of a taught position (all bits 0) including the approach 80 mm above.
TEST(Kinematics, GP7CoversTheWorkAreaWithTheToolDown) {
  const Arm& a = arm(ArmModel::gp7);
  int missed = 0;
  for (int x = 300; x <= 650; x += 25)
    for (int y = -300; y <= 300; y += 25)
      for (int z = -280; z <= 180; z += 20)
        for (int rz = -179; rz <= 180; rz += 21) {
          const FlangePose T(zyx(180, 0, rz), Eigen::Vector3d(x, y, z + 150) * 1e-3);
          if (!inverse_in_form(a, T, Form{}, Joints::Zero())) ++missed;
        }
  EXPECT_EQ(missed, 0);
}

TEST(Arm, PulsesAndJointsAgree) {
  const Arm& a = arm(ArmModel::gp7);
  const Pulses p{134140, -1341, 1, -1000, 90000, 62200};
  EXPECT_EQ(pulses_from_joints(a, joints_from_pulses(a, p)), p);
  EXPECT_NEAR(core::deg_from_rad(joints_from_pulses(a, p)[0]), 100, 1e-9);
  EXPECT_FALSE(inside_limits(a, deg(0, 0, 0, 0, 140, 0)));
  EXPECT_TRUE(inside_limits(a, a.upper));
}

}  // namespace
}  // namespace pickcell::sim
