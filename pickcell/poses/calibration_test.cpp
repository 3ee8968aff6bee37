#include "pickcell/poses/calibration.hpp"

#include <gtest/gtest.h>

#include "pickcell/core/file.hpp"

namespace pickcell::poses {
namespace {

class CalibrationFiles : public testing::Test {
 protected:
  CalibrationFiles()
      : folder_(std::filesystem::path(testing::TempDir()) /
                testing::UnitTest::GetInstance()->current_test_info()->name()) {
    std::filesystem::create_directories(folder_);
    camera_.lens = {1280, 1024, 2850.25, 2848.5, 644.2, 508.7, {-0.12, 0.05, 0.0008, -0.0006, 0.01, 0, 0, 0}};
    camera_.model = "brown5";
    camera_.camera_id = "cam-1";
    camera_.verdict = Verdict::good;
    camera_.date = "2026-11-01T10:00:00Z";
    auto saved = save_camera(folder_ / "camera.toml", camera_);
    EXPECT_TRUE(saved);
    camera_ = *saved;
    plane_.T_base_camera = core::Transform<core::Base, core::Camera>(core::rotation_z(1), {0.1, 0.2, 0.9});
    plane_.camera = camera_.checksum;
    plane_.verdict = Verdict::good;
    plane_.date = "2026-11-01T10:00:00Z";
    use_ = {1280, 1024, "cam-1", 365, 1'793'600'000'000'000};  // 2026-11-02, the day after the files' date
  }
  ~CalibrationFiles() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
  CameraCalibration camera_;
  PlaneCalibration plane_;
  CalibrationUse use_;
};

TEST_F(CalibrationFiles, SurviveSavingAndLoading) {
  const auto camera = load_camera(folder_ / "camera.toml");
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->checksum, camera_.checksum);
  EXPECT_EQ(camera->lens.fx_px, 2850.25);
  EXPECT_EQ(camera->lens.distortion[4], 0.01);
  ASSERT_TRUE(save_plane(folder_ / "plane.toml", plane_));
  const auto plane = load_plane(folder_ / "plane.toml");
  ASSERT_TRUE(plane);
  EXPECT_TRUE(plane->T_base_camera.matrix().isApprox(plane_.T_base_camera.matrix(), 1e-12));
  EXPECT_TRUE(check_fits(*camera, *plane, use_));
}

TEST_F(CalibrationFiles, WhatDoesNotFitTheCellIsRefusedWithItsReason) {
  const auto why = [&](auto change) {
    auto camera = camera_;
    auto plane = plane_;
    auto use = use_;
    change(camera, plane, use);
    const auto status = check_fits(camera, plane, use);
    return status ? std::string("accepted") : status.error().line();
  };
  EXPECT_NE(why([](auto& c, auto&, auto&) { c.verdict = Verdict::reject; }).find("reject"), std::string::npos);
  EXPECT_NE(why([](auto&, auto& p, auto&) { p.verdict = Verdict::reject; }).find("reject"), std::string::npos);
  EXPECT_NE(why([](auto&, auto&, auto& u) { u.width_px = 640; }).find("1280x1024"), std::string::npos);
  EXPECT_NE(why([](auto&, auto&, auto& u) { u.camera_id = "cam-2"; }).find("cam-2"), std::string::npos);
  EXPECT_NE(why([](auto&, auto& p, auto&) { p.camera = "crc32:00000000"; }).find("another camera.toml"),
            std::string::npos);
  EXPECT_NE(why([](auto&, auto& p, auto&) { p.board_frame_only = true; }).find("robot frame"), std::string::npos);
  EXPECT_NE(why([](auto&, auto&, auto& u) { u.now_unix_us += 400LL * 86400 * 1000000; }).find("365 days"),
            std::string::npos);
  EXPECT_NE(why([](auto&, auto&, auto& u) { u.now_unix_us -= 7LL * 86400 * 1000000; }).find("in the future"),
            std::string::npos);
  EXPECT_NE(why([](auto&, auto& p, auto&) { p.date = "2027-01-01T00:00:00Z"; }).find("in the future"),
            std::string::npos);
  EXPECT_NE(why([](auto& c, auto&, auto&) { c.date = "yesterday"; }).find("no date"), std::string::npos);
  EXPECT_EQ(why([](auto& c, auto&, auto&) { c.camera_id.clear(); }), "accepted");
}

TEST_F(CalibrationFiles, DamagedFilesAreNamed) {
  const auto with = [&](std::string_view from, std::string_view to) {
    std::string text = core::read_text_file(folder_ / "camera.toml").value();
    text.replace(text.find(from), from.size(), to);
    EXPECT_TRUE(core::write_file_atomically(folder_ / "bad.toml", text));
    const auto loaded = load_camera(folder_ / "bad.toml");
    return loaded ? std::string("accepted") : loaded.error().why;
  };
  EXPECT_EQ(with("fx_px = 2850.25", "fx_px = nan"), "'fx_px' must be a finite number");
  EXPECT_EQ(with("fx_px = 2850.25", "fx_px = -1"), "'fx_px' must be positive");
  EXPECT_EQ(with("cx_px", "cx_pix"), "'cx_px' is missing");
  EXPECT_EQ(with("\"good\"", "\"fine\""), "'verdict' must be excellent, good, usable or reject");
  ASSERT_TRUE(core::write_file_atomically(
      folder_ / "plane.toml", std::string_view("T_base_plane = [[1,0,0,0],[0,2,0,0],[0,0,1,0],[0,0,0,1]]\n")));
  EXPECT_NE(load_plane(folder_ / "plane.toml").error().why.find("rigid"), std::string::npos);
}

}  // namespace
}  // namespace pickcell::poses
