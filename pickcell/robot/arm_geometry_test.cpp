#include "pickcell/robot/arm_geometry.hpp"

#include <gtest/gtest.h>

#include <random>

#include "pickcell/core/units.hpp"
#include "pickcell/robot/pose_angles.hpp"

namespace pickcell::robot {
namespace {

ArmJoints deg(double s, double l, double u, double r, double b, double t) {
  return ArmJoints{s, l, u, r, b, t} * (core::kPi / 180);
}

struct Reference {
  const char* model;
  ArmJoints q;
  Eigen::Vector3d at_mm;
  ZyxAngles angles;
};

/// docs/yaskawa-protocols.md section 5, computed there from the vendor's URDF models.
TEST(ArmGeometry, ReferencePoses) {
  const Reference all[] = {
      {"gp7", deg(0, 0, 0, 0, -90, 0), {480, 0, 405}, {180, 0, 0}},
      {"gp7", deg(30, 20, -10, 15, -60, 40), {523.758, 281.686, 154.849}, {170.548, 8.939, 76.792}},
      {"gp7", deg(-45, 35, -20, 0, -35, 90), {410.392, -410.392, -52.961}, {180, 0, 45}},
      {"gp8", deg(0, 0, 0, 0, -90, 0), {380, 0, 305}, {180, 0, 0}},
      {"gp8", deg(30, 20, -10, 15, -60, 40), {419.138, 221.284, 110.879}, {170.548, 8.939, 76.792}},
      {"motomini", deg(0, 0, 0, 0, 0, 0), {185, 0, 125}, {180, 0, 0}},
      {"motomini", deg(30, 20, -10, 15, -60, 40), {158.185, 85.351, 73.139}, {-88.141, 62.942, 129.092}},
  };
  for (const Reference& r : all) {
    const FlangeInBase T = flange_in_base(*arm_geometry(r.model), r.q);
    EXPECT_LT((T.translation_m() * 1e3 - r.at_mm).norm(), 1e-3) << r.model;
    EXPECT_LT((T.rotation() - rotation(r.angles)).norm(), 4e-5) << r.model;
  }
  EXPECT_EQ(arm_geometry("ur5"), nullptr);
}

TEST(ArmGeometry, JointsForAPoseNearbyLeadBackToIt) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> some(-1, 1);
  for (const char* model : {"gp7", "gp8", "motomini"}) {
    const ArmGeometry& arm = *arm_geometry(model);
    const double b = model == std::string("motomini") ? 30 : -90;
    for (int i = 0; i < 200; ++i) {
      const ArmJoints near = deg(60 * some(random), 10 + 20 * some(random), 20 * some(random), 20 * some(random),
                                 b + 30 * some(random), 60 * some(random));
      ArmJoints q = near;
      for (double& v : q) v += 0.1 * some(random);
      const auto found = joints_near(arm, flange_in_base(arm, q), near);
      ASSERT_TRUE(found);
      EXPECT_LT((*found - q).norm(), 1e-4);
    }
    const FlangeInBase far(Eigen::Matrix3d::Identity(), Eigen::Vector3d(2, 0, 0));
    EXPECT_FALSE(joints_near(arm, far, deg(0, 0, 0, 0, b, 0)));
  }
}

}  // namespace
}  // namespace pickcell::robot
