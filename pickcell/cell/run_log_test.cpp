#include "pickcell/cell/run_log.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "pickcell/core/config.hpp"

namespace pickcell::cell {
namespace {

constexpr std::int64_t kStartUs = 1'767'225'600'000'000;  // 2026-01-01T00:00:00Z

class RunLogTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("pickcell_run_log_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  RunLog create(bool record_frames = false) {
    auto log = RunLog::create(folder_ / "runs", {"cell \"1\"", "/etc/CELL.toml", "cam", "sim", "best", kStartUs, true},
                              record_frames);
    EXPECT_TRUE(log) << log.error().line();
    return std::move(*log);
  }
  static ShownFrame frame_with_one() {
    ShownFrame shown;
    shown.frame.picture = std::make_shared<const image::Image>(8, 6);
    shown.frame.sequence = 7;
    shown.frame.camera_id = "cam";
    Detection d;
    d.id = 3;
    d.part = "gear";
    d.state = DetectionState::rejected;
    d.why = "score 0.50 is below the threshold 0.70";
    shown.detections = {d};
    return shown;
  }

  std::filesystem::path folder_;
};

TEST_F(RunLogTest, EveryRunHasItsOwnFolderNamedByItsStart) {
  const RunLog first = create(), second = create();
  EXPECT_EQ(first.folder().filename(), "20260101-000000");
  EXPECT_EQ(second.folder().filename(), "20260101-000000-2");
  auto info = core::Config::load(first.folder() / "run.toml");
  ASSERT_TRUE(info) << info.error().line();
  EXPECT_EQ(info->string("cell"), "cell \"1\"");
  EXPECT_EQ(info->string("started"), "2026-01-01T00:00:00Z");
  EXPECT_TRUE(info->boolean_or("simulated", false));
}

TEST_F(RunLogTest, KeepsPictureDetectionPickAndItsEnd) {
  RunLog log = create(true);
  matches::Match match;
  match.covariance.diagonal() << 0.04, 0.09, 0.01, 1e-6;
  poses::PartPose pose;
  pose.detection_id = 3;
  pose.T_base_part = core::Transform<core::Base, core::Part>(core::rotation_z(0.5), {0.4, -0.1, 0.006});
  ASSERT_TRUE(log.add_frame(frame_with_one(), {match}, {pose}));
  ASSERT_TRUE(log.add_pick({3, 12, 4, "submitted", 0, "", kStartUs, 0}));
  ASSERT_TRUE(log.end_pick({3, 12, 4, "refused", 2, "nothing gripped", kStartUs, kStartUs + 5}));
  ASSERT_TRUE(log.add_event(kStartUs, "STOPPED", "stopped by the operator"));

  auto read = Database::open(log.folder() / "picks.db");  // a second reader while the run goes on
  ASSERT_TRUE(read);
  const auto row =
      read->execute("SELECT sigma_x_px, sigma_y_px, base_x_mm, base_angle_deg, rejected, reason FROM detection");
  ASSERT_TRUE(row);
  ASSERT_EQ(row->size(), 1u);
  EXPECT_NEAR(as_real((*row)[0][0]), 0.2, 1e-12);
  EXPECT_NEAR(as_real((*row)[0][1]), 0.3, 1e-12);
  EXPECT_NEAR(as_real((*row)[0][2]), 400, 1e-9);
  EXPECT_NEAR(as_real((*row)[0][3]), 0.5 * 180 / M_PI, 1e-9);
  EXPECT_EQ(as_integer((*row)[0][4]), 1);
  const auto pick = read->execute("SELECT outcome, reason, slot, t_end_us - t_submit_us FROM pick WHERE sequence = 12");
  ASSERT_TRUE(pick);
  EXPECT_EQ(as_text((*pick)[0][0]), "refused");
  EXPECT_EQ(as_integer((*pick)[0][3]), 5);
  EXPECT_TRUE(std::filesystem::exists(log.folder() / "frames" / "00000007.png"));
}

TEST_F(RunLogTest, AHalfWrittenPictureLeavesNothing) {
  RunLog log = create();
  ShownFrame shown = frame_with_one();
  shown.detections.push_back(shown.detections.front());  // the same id twice cannot be stored
  EXPECT_FALSE(log.add_frame(shown, {}, {}));
  auto read = Database::open(log.folder() / "picks.db");
  ASSERT_TRUE(read);
  EXPECT_EQ(as_integer(read->execute("SELECT count(*) FROM frame")->front().front()), 0);
  shown.detections.pop_back();
  EXPECT_TRUE(log.add_frame(shown, {}, {})) << "the log goes on after an error";
}

TEST_F(RunLogTest, AFolderThatCannotBeMadeIsSaid) {
  const auto log = RunLog::create("/proc/no/runs", {}, false);
  ASSERT_FALSE(log);
  EXPECT_EQ(log.error().code, core::ErrorCode::unreadable);
}

}  // namespace
}  // namespace pickcell::cell
