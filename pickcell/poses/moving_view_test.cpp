#include "pickcell/poses/moving_view.hpp"

#include <gtest/gtest.h>

#include <filesystem>

namespace pickcell::poses {
namespace {

CameraCalibration camera() {
  CameraCalibration out;
  out.lens = {800, 600, 1000, 1000, 400, 300, {}};
  return out;
}

/// A camera 0.1 m beside the flange's axis that looks down from a flange at z = 0.6.
core::Transform<core::Base, core::Flange> flange_over(double x, double y, double turn) {
  const Eigen::Matrix3d down = Eigen::Vector3d(1, -1, -1).asDiagonal();
  return {core::rotation_z(turn) * down, {x, y, 0.6}};
}

TEST(MovingView, FollowsTheArm) {
  HandeyeCalibration handeye;
  handeye.T_flange_camera = core::Transform<core::Flange, core::Camera>(Eigen::Matrix3d::Identity(), {0.1, 0, 0});
  for (const double turn : {0.0, 0.5, 2.0}) {
    const auto view = view_at_exposure(camera(), handeye, {}, flange_over(0.3, 0.2, turn));
    ASSERT_TRUE(view);
    // The middle of the picture lies under the camera, 0.1 m beside the flange in the direction it is turned to.
    const auto under = plane_point(*view, {400, 300}, 0.02);
    ASSERT_TRUE(under);
    EXPECT_NEAR(under->x(), 0.3 + 0.1 * std::cos(turn), 1e-12);
    EXPECT_NEAR(under->y(), 0.2 + 0.1 * std::sin(turn), 1e-12);
  }
  EXPECT_FALSE(view_at_exposure(camera(), handeye, {}, std::nullopt));
}

TEST(MovingView, BesideTheArmNeedsNoPose) {
  HandeyeCalibration handeye;
  const Eigen::Matrix3d down = Eigen::Vector3d(1, -1, -1).asDiagonal();
  handeye.T_base_camera = core::Transform<core::Base, core::Camera>(down, {0.5, 0, 1});
  const auto view = view_at_exposure(camera(), handeye, {}, std::nullopt);
  ASSERT_TRUE(view);
  EXPECT_NEAR(plane_point(*view, {400, 300}, 0)->x(), 0.5, 1e-12);
}

TEST(MovingView, TheWorkPlaneIsWhereTheBoardLayOrAsHighAsIsSaid) {
  const Eigen::Matrix3d face_up = Eigen::Vector3d(1, -1, -1).asDiagonal();
  HandeyeCalibration handeye;
  EXPECT_FALSE(work_plane(handeye, std::nullopt));
  EXPECT_NEAR(work_plane(handeye, -0.01)->translation_m().z(), -0.01, 1e-15);
  handeye.T_base_board = core::Transform<core::Base, core::Board>(core::rotation_z(0.4) * face_up, {0.5, 0.1, 0.02});
  const auto plane = work_plane(handeye, std::nullopt);
  ASSERT_TRUE(plane) << plane.error().line();
  EXPECT_NEAR(plane->rotation()(2, 2), 1, 1e-12);
  EXPECT_NEAR(plane->translation_m().z(), 0.02, 1e-15);
  // A board held up before the camera says nothing about the table.
  handeye.T_base_board = core::Transform<core::Base, core::Board>(
      Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()).toRotationMatrix() * face_up, {0.5, 0.1, 0.02});
  EXPECT_FALSE(work_plane(handeye, std::nullopt));
}

TEST(HandeyeFile, SurvivesSavingAndLoading) {
  const auto file = std::filesystem::path(testing::TempDir()) / "handeye_file_test.toml";
  HandeyeCalibration handeye;
  handeye.T_flange_camera = core::Transform<core::Flange, core::Camera>(core::rotation_z(0.3), {0.1, 0.2, 0.3});
  handeye.T_base_board = core::Transform<core::Base, core::Board>(core::rotation_z(-1), {0.5, 0, 0});
  handeye.camera = "crc32:12345678";
  handeye.spread_mm = 0.4;
  handeye.verdict = Verdict::good;
  handeye.date = "2026-11-01T10:00:00Z";
  ASSERT_TRUE(save_handeye(file, handeye));
  const auto back = load_handeye(file);
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_TRUE(back->T_flange_camera->matrix().isApprox(handeye.T_flange_camera->matrix(), 1e-15));
  EXPECT_FALSE(back->T_base_camera);
  EXPECT_EQ(back->verdict, Verdict::good);
  auto lens = camera();
  lens.verdict = Verdict::good;
  lens.date = handeye.date;
  lens.checksum = handeye.camera;
  const CalibrationUse use{800, 600, "", 365, 1'793'600'000'000'000};
  EXPECT_TRUE(check_fits(lens, *back, use));
  lens.checksum = "crc32:00000000";
  EXPECT_FALSE(check_fits(lens, *back, use));
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace pickcell::poses
