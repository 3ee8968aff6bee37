#include "pickcell/poses/locate.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "pickcell/core/units.hpp"

namespace pickcell::poses {
namespace {

using core::Base;
using core::Camera;
using core::Plane;

/// A camera 0.9 m above the plane, tilted, with a lens that bends by several pixels.
View test_view() {
  View view;
  view.lens = {1280, 1024, 2850, 2848, 644.2, 508.7, {-0.12, 0.05, 0.0008, -0.0006, 0.01, 0, 0, 0}};
  view.T_base_plane = core::Transform<Base, Plane>(core::rotation_z(0.4), {0.45, 0.02, -0.2});
  const Eigen::Matrix3d looks_down = Eigen::AngleAxisd(core::kPi, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const Eigen::Matrix3d tilt =
      (Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(-0.02, Eigen::Vector3d::UnitY()))
          .toRotationMatrix();
  view.T_base_camera = core::Transform<Base, Camera>(core::rotation_z(1.2) * looks_down * tilt, {0.46, 0.0, 0.7});
  return view;
}

/// The formula of the OpenCV documentation, written out by itself as independent truth.
Eigen::Vector2d see(const View& v, const Eigen::Vector3d& p_base) {
  const Eigen::Vector3d p = v.T_base_camera.rotation().transpose() * (p_base - v.T_base_camera.translation_m());
  const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
  const auto& d = v.lens.distortion;
  const double radial = (1 + d[0] * r2 + d[1] * r2 * r2 + d[4] * r2 * r2 * r2);
  return {v.lens.fx_px * (x * radial + 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x)) + v.lens.cx_px,
          v.lens.fy_px * (y * radial + d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y) + v.lens.cy_px};
}

matches::Model square_model(int side_px, double height_m) {
  matches::Model model;
  model.picture = image::Image(side_px, side_px);
  model.ref_x_px = model.ref_y_px = (side_px - 1) / 2.0;
  model.height_m = height_m;
  return model;
}

/// What a perfect matcher reports for a part of which every pixel of the template is seen: a similarity fitted by a
/// general least-squares solver (not by the closed form under test).
matches::Match perfect_match(const View& v, double x, double y, double theta, double height, double m_per_px,
                             int side) {
  Eigen::MatrixXd A(2 * side * side, 4);
  Eigen::VectorXd b(2 * side * side);
  int row = 0;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i, row += 2) {
      const double tx = i - (side - 1) / 2.0, ty = j - (side - 1) / 2.0;
      const double px = m_per_px * tx, py = -m_per_px * ty;
      const Eigen::Vector3d p_plane(x + std::cos(theta) * px - std::sin(theta) * py,
                                    y + std::sin(theta) * px + std::cos(theta) * py, height);
      const Eigen::Vector2d seen = see(v, v.T_base_plane.iso() * p_plane);
      A.row(row) << tx, ty, 1, 0;       // u =  sc tx + ss ty + cx
      A.row(row + 1) << ty, -tx, 0, 1;  // v = -ss tx + sc ty + cy
      b[row] = seen.x();
      b[row + 1] = seen.y();
    }
  const Eigen::Vector4d s = A.colPivHouseholderQr().solve(b);
  matches::Match match;
  match.pose = {s[2], s[3], core::deg_from_rad(std::atan2(s[1], s[0])), std::hypot(s[0], s[1])};
  return match;
}

TEST(Lens, UndistortUndoesTheDocumentedFormula) {
  const View view = test_view();
  for (int v = 0; v < 1024; v += 93)
    for (int u = 0; u < 1280; u += 97) {
      const auto p = plane_point(view, Eigen::Vector2d(u, v), 0.012);
      ASSERT_TRUE(p);
      const Eigen::Vector2d back = see(view, view.T_base_plane.iso() * Eigen::Vector3d(p->x(), p->y(), 0.012));
      EXPECT_LT((back - Eigen::Vector2d(u, v)).norm(), 1e-7);
    }
}

TEST(Lens, NoDirectionWhereTheModelFoldsOver) {
  Lens lens{1280, 1024, 500, 500, 640, 512, {-0.9, 0, 0, 0, 0, 0, 0, 0}};
  EXPECT_TRUE(undistort(lens, {700, 512}));
  EXPECT_FALSE(undistort(lens, {1279, 1023}));
}

TEST(Locate, FindsThePoseBehindTheMatchAnywhereInThePicture) {
  const View view = test_view();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-0.14, 0.14), turn(-core::kPi, core::kPi);
  const double height = 0.018, m_per_px = 0.00031;
  const Locator locator(square_model(161, height));
  for (int i = 0; i < 30; ++i) {
    const double x = place(random), y = place(random), theta = turn(random);
    const auto found = locator.locate(perfect_match(view, x, y, theta, height, m_per_px, 161), view);
    ASSERT_TRUE(found);
    const core::Transform<Plane, core::Part> truth(core::rotation_z(theta), {x, y, height});
    const auto error = (view.T_base_plane * truth).inverse() * found->T_base_part;
    EXPECT_LT(core::mm_from_m(error.translation_m().norm()), 0.002);
    EXPECT_LT(core::deg_from_rad(Eigen::AngleAxisd(error.rotation()).angle()), 0.002);
  }
}

TEST(Locate, GraspPointsDownAndFollowsThePart) {
  const View view = test_view();
  auto model = square_model(161, 0.01);
  model.grasps = {{80 + 50, 80, 30, false}};  // 50 px to the right of the reference point, tool X at 30 degrees
  const double theta = 0.7, m_per_px = 0.0003;
  const auto found = Locator(model).locate(perfect_match(view, 0.02, -0.03, theta, 0.01, m_per_px, 161), view);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->grasps.size(), 1u);
  const auto& T = found->grasps[0].T_base_tool;
  EXPECT_TRUE(T.rotation().col(2).isApprox(-Eigen::Vector3d::UnitZ(), 1e-9));
  const double rz = std::atan2(T.rotation()(1, 0), T.rotation()(0, 0));
  EXPECT_NEAR(core::wrap_rad(rz - (0.4 + theta + core::rad_from_deg(30))), 0, 1e-4);  // plane is turned by 0.4 in base
  const Eigen::Vector3d expected =
      view.T_base_plane.iso() *
      Eigen::Vector3d(0.02 + 50 * m_per_px * std::cos(theta), -0.03 + 50 * m_per_px * std::sin(theta), 0.01);
  EXPECT_LT((T.translation_m() - expected).norm(), 5e-5);
}

TEST(Locate, CovarianceIsThatOfRepeatedMeasurements) {
  const View view = test_view();
  const Locator locator(square_model(161, 0.01));
  auto match = perfect_match(view, 0.1, 0.08, 1.0, 0.01, 0.0003, 161);
  match.covariance.diagonal() << 0.04 * 0.04, 0.08 * 0.08, 0.05 * 0.05, 1e-8;
  const auto centre = locator.locate(match, view);
  ASSERT_TRUE(centre);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  constexpr int kTries = 2000;
  for (int i = 0; i < kTries; ++i) {
    auto noisy = match;
    noisy.pose.x_px += 0.04 * normal(random);
    noisy.pose.y_px += 0.08 * normal(random);
    noisy.pose.angle_deg += 0.05 * normal(random);
    const auto found = locator.locate(noisy, view);
    ASSERT_TRUE(found);
    const auto d = (view.T_base_plane.inverse() * found->T_base_part).iso();
    const auto d0 = (view.T_base_plane.inverse() * centre->T_base_part).iso();
    Eigen::Vector3d e;
    e << (d.translation() - d0.translation()).head<2>(),
        Eigen::AngleAxisd(Eigen::Matrix3d(d0.linear().transpose() * d.linear())).angle() *
            Eigen::AngleAxisd(Eigen::Matrix3d(d0.linear().transpose() * d.linear())).axis().z();
    sum += e * e.transpose();
  }
  const Eigen::Matrix3d sampled = sum / kTries;
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(centre->covariance(i, i) / sampled(i, i), 1.0, 0.15);
}

TEST(Locate, ARayBesideThePlaneIsRefused) {
  View view = test_view();
  view.T_base_camera = core::Transform<Base, Camera>(Eigen::Matrix3d::Identity(), {0, 0, 1});  // looks up
  matches::Match match;
  match.pose = {640, 512, 0, 1};
  EXPECT_FALSE(Locator(square_model(50, 0)).locate(match, view));
}

}  // namespace
}  // namespace pickcell::poses
