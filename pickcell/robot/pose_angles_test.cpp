#include "pickcell/robot/pose_angles.hpp"

#include <gtest/gtest.h>

#include <random>

namespace pickcell::robot {
namespace {

TEST(PoseAngles, AnyRotationComesBackAsAMatrix) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Matrix3d r = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                                  .normalized()
                                  .toRotationMatrix();
    const ZyxAngles a = zyx_angles(r);
    ASSERT_LT((rotation(a) - r).norm(), 1e-12);
    ASSERT_TRUE(a.rx_deg > -180 && a.rx_deg <= 180 && std::abs(a.ry_deg) <= 90 && a.rz_deg > -180 && a.rz_deg <= 180);
  }
}

TEST(PoseAngles, OrderIsFixedAxesXThenYThenZ) {  // against the definition, element by element
  const double rx = 0.3, ry = -0.7, rz = 2.1;
  Eigen::Matrix3d x, y, z;
  x << 1, 0, 0, 0, std::cos(rx), -std::sin(rx), 0, std::sin(rx), std::cos(rx);
  y << std::cos(ry), 0, std::sin(ry), 0, 1, 0, -std::sin(ry), 0, std::cos(ry);
  z << std::cos(rz), -std::sin(rz), 0, std::sin(rz), std::cos(rz), 0, 0, 0, 1;
  const double deg = 180 / 3.14159265358979323846;
  EXPECT_LT((rotation({rx * deg, ry * deg, rz * deg}) - z * y * x).norm(), 1e-12);
}

TEST(PoseAngles, AToolStraightDownReads180) {
  Eigen::Matrix3d down;
  down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  const ZyxAngles a = zyx_angles(core::rotation_z(0.5) * down);
  EXPECT_NEAR(a.rx_deg, 180, 1e-9);
  EXPECT_NEAR(a.ry_deg, 0, 1e-9);
  EXPECT_NEAR(a.rz_deg, 0.5 * 180 / 3.14159265358979323846, 1e-9);
}

TEST(PoseAngles, DegenerateAnglesStillGiveTheSameRotation) {
  for (const double ry : {90.0, -90.0, 89.9999999, -89.9999}) {
    for (double rx = -170; rx <= 180; rx += 35) {
      for (double rz = -170; rz <= 180; rz += 35) {
        const Eigen::Matrix3d r = rotation({rx, ry, rz});
        ASSERT_LT((rotation(zyx_angles(r)) - r).norm(), 1e-8) << rx << ' ' << ry << ' ' << rz;
      }
    }
  }
  EXPECT_EQ(zyx_angles(rotation({40, 90, 10})).rx_deg, 0);
}

TEST(PoseAngles, MillimetresAndBack) {
  const core::Transform<core::Base, core::Tool> T(rotation({170.548, 8.939, 76.792}),
                                                  Eigen::Vector3d(0.523758, 0.281686, 0.154849));
  const CartesianPosition p = position_from(T);
  EXPECT_NEAR(p.x_mm, 523.758, 1e-9);
  EXPECT_NEAR(p.y_mm, 281.686, 1e-9);
  EXPECT_NEAR(p.rz_deg, 76.792, 1e-9);
  EXPECT_TRUE(transform_from(p).iso().isApprox(T.iso(), 1e-12));
}

}  // namespace
}  // namespace pickcell::robot
