#include "pickcell/cell/camera_watch.hpp"

#include <gtest/gtest.h>

namespace pickcell::cell {
namespace {

class Source final : public frames::FrameSource {
 public:
  [[nodiscard]] frames::SourceInfo info() const override { return {"cam", 640, 480, false}; }
  [[nodiscard]] core::Result<frames::Frame> grab(core::Seat&, core::Duration) override {
    return core::failure(core::ErrorCode::timeout, "cam", "not asked for here");
  }
  [[nodiscard]] core::Status health() const override { return state; }
  [[nodiscard]] frames::FrameCounters counters() const override { return counted; }
  core::Status state;
  frames::FrameCounters counted;
};

class CameraWatchTest : public ::testing::Test {
 protected:
  bool look() { return watch_.look(alarms_, ++now_us_); }
  void lose(const char* remedy = "check its cable") {
    source_.state = core::failure(core::ErrorCode::device, "cam", "no answer", remedy);
  }
  Source source_;
  AlarmList alarms_;
  CameraWatch watch_{source_};
  std::int64_t now_us_ = 0;
};

TEST_F(CameraWatchTest, ALossIsToldOnceAndItsEndToo) {
  EXPECT_FALSE(look());
  EXPECT_FALSE(watch_.hindrance());
  lose();
  EXPECT_TRUE(look());
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(look()) << "no news";
  ASSERT_EQ(alarms_.rows().size(), 1u);
  const CellAlarm lost = alarms_.rows().front();
  EXPECT_EQ(lost.code, "CAMERA_LOST");
  EXPECT_TRUE(lost.active);
  EXPECT_EQ(lost.count, 1);
  EXPECT_EQ(lost.last_unix_us, lost.first_unix_us) << "a row that changes at every look is sent at every look";
  EXPECT_EQ(lost.remedies, std::vector<std::string>{"check its cable"});
  ASSERT_TRUE(watch_.hindrance());
  EXPECT_EQ(watch_.hindrance()->why, "cam: no answer");
  source_.state = {};
  source_.counted.reconnects = 1;
  EXPECT_TRUE(look());
  EXPECT_FALSE(alarms_.rows().front().active);
  EXPECT_EQ(watch_.view().reconnects, 1);
  lose();
  EXPECT_TRUE(look());
  EXPECT_EQ(alarms_.rows().front().count, 2);
}

TEST_F(CameraWatchTest, ResetDoesNotHideALossThatLasts) {
  lose();
  look();
  alarms_.clear_all(++now_us_);
  watch_.alarms_cleared();
  look();
  EXPECT_TRUE(alarms_.rows().front().active);
}

TEST_F(CameraWatchTest, ALossWithoutARemedyHasOne) {
  lose("");
  look();
  EXPECT_FALSE(watch_.view().remedy.empty());
}

TEST_F(CameraWatchTest, LostFramesAreShownByCause) {
  source_.counted.frames = 100;
  source_.counted.incomplete = 3;
  source_.counted.late = 1;
  EXPECT_TRUE(look());
  EXPECT_EQ(watch_.view().losses, (std::map<std::string, std::int64_t>{{"incomplete", 3}, {"late", 1}}));
  source_.counted.frames = 200;
  EXPECT_FALSE(look()) << "good frames are no news here";
}

}  // namespace
}  // namespace pickcell::cell
