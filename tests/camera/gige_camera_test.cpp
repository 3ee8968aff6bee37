/// Real GigE Vision on loopback, against a camera that is not ours. With PICKCELL_SOAK the long forms.

#include <malloc.h>

#include <fstream>
#include <future>
#include <map>
#include <set>

#include "fake_camera.hpp"
#include "pickcell/frames/camera_list.hpp"
#include "pickcell/frames/open_source.hpp"

namespace pickcell {
namespace {

using frames::LiveSource;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

#ifdef PICKCELL_SOAK
constexpr int kFrames = 10'000, kRestarts = 20;
#else
constexpr int kFrames = 250, kRestarts = 2;
#endif

class GigeCamera : public ::testing::Test {
 protected:
  void SetUp() override {
    wait_for_turn();
    if (!std::filesystem::exists(FakeCamera::kProgram)) GTEST_SKIP() << "needs Debian's aravis-tools";
    if (frames::GvcpProbe(kLoopback).identify(milliseconds(100)))
      GTEST_SKIP() << "another GigE Vision camera is served on this machine's loopback";
  }

  core::Result<std::unique_ptr<frames::FrameSource>> open(const std::vector<std::string>& settings,
                                                          LiveSource::Policy policy = LiveSource::Policy::newest,
                                                          const std::string& name = "127.0.0.1") {
    frames::SourceOptions options;
    options.settings = *frames::parse_camera_settings(settings);
    options.policy = policy;
    return frames::open_source("aravis:" + name, options, clock_);
  }
  core::Result<frames::Frame> grab(frames::FrameSource& source, double timeout_s = 5) {
    return source.grab(*seat_, core::duration_s(timeout_s));
  }

  core::RealClock clock_;
  std::unique_ptr<core::Seat> seat_ = clock_.join("test");
};

/// The fake camera's pattern at gain 0 and 10 ms: (x + y + frame) mod 255, so that one pixel tells the frame that every
/// other must belong to.
void expect_one_pattern(const image::Image& picture) {
  const int first = picture.at(0, 0);
  int wrong = 0;
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) wrong += picture.at(x, y) != (first + x + y) % 255;
  EXPECT_EQ(wrong, 0) << "pixels of another frame";
}

struct Case {
  int lost_per_thousand;
  const char* roi;
};
class GigeLosses : public GigeCamera, public ::testing::WithParamInterface<Case> {};

TEST_P(GigeLosses, EveryFrameIsAccountedForAndNoneIsTorn) {
  const FakeCamera fake(GetParam().lost_per_thousand);
  auto source = open({std::string("roi_px=") + GetParam().roi, "fps=200", "exposure_us=10000", "packet_bytes=1500"},
                     LiveSource::Policy::every);
  ASSERT_TRUE(source) << source.error().line();
  std::uint64_t last = 0, first = 0, got = 0;
  for (int i = 0; i < kFrames; ++i) {
    auto frame = grab(**source);
    ASSERT_TRUE(frame) << frame.error().line();
    if (first == 0) first = frame->sequence;
    EXPECT_GT(frame->sequence, last) << "newer than the one before";
    last = frame->sequence;
    ++got;
    if (i % 10 == 0) expect_one_pattern(*frame->picture);
  }
  const frames::FrameCounters c = (*source)->counters();
  // What was read and what still waits to be read are whole; everything else has its cause.
  const std::uint64_t otherwise = c.incomplete + c.missing + c.torn + c.late;
  EXPECT_EQ(c.torn, 0u);
  EXPECT_EQ(c.repeated, 0u);
  EXPECT_EQ(c.late, 0u) << "loopback overtakes nothing";
  // Exposures that are known of, less those that wait unread: the numbers from the first to the last one read.
  constexpr std::uint64_t kUnread = 80;
  EXPECT_GE(c.frames + otherwise, last - first + 1);
  EXPECT_LE(c.frames + otherwise, last + kUnread);
  EXPECT_LE(last - got, otherwise + (first - 1));
  EXPECT_GE(c.frames, got);
  if (GetParam().lost_per_thousand == 0)
    EXPECT_LE(otherwise, static_cast<std::uint64_t>(kFrames / 50)) << "only what a loaded machine drops";
  else
    EXPECT_GT(c.incomplete + c.missing, 0u);
  std::printf("lost %d/1000, %s: %llu frames, %llu incomplete, %llu missing, %llu late, %llu resends asked\n",
              GetParam().lost_per_thousand, GetParam().roi, static_cast<unsigned long long>(c.frames),
              static_cast<unsigned long long>(c.incomplete), static_cast<unsigned long long>(c.missing),
              static_cast<unsigned long long>(c.late), static_cast<unsigned long long>(c.resends));
}

constexpr Case kCases[] = {{0, "0,0,512,512"},    {1, "0,0,512,512"},
                           {10, "0,0,256,128"},
#ifdef PICKCELL_SOAK
                           {0, "0,0,64,48"},      {10, "0,0,512,512"},
                           {1, "16,32,1280,1024"}
#endif
};
INSTANTIATE_TEST_SUITE_P(Ratios, GigeLosses, ::testing::ValuesIn(kCases));

TEST_F(GigeCamera, IsHealedAfterEveryRestart) {
  FakeCamera fake;
  auto source = open({});
  ASSERT_TRUE(source) << source.error().line();
  ASSERT_TRUE(grab(**source));
  for (int i = 0; i < kRestarts; ++i) {
    fake.kill();
    const auto died = steady_clock::now();
    while ((*source)->health()) {
      ASSERT_LT(steady_clock::now() - died, std::chrono::seconds(20)) << "the loss was never seen";
      seat_->sleep_for(milliseconds(5));
    }
    const auto seen = steady_clock::now() - died;
    const auto lost = grab(**source, 0.05);
    ASSERT_FALSE(lost);
    EXPECT_EQ(lost.error().code, core::ErrorCode::device);
    EXPECT_FALSE(lost.error().remedy.empty());
    fake.start();
    const auto back = steady_clock::now();
    const auto frame = grab(**source, 20);
    ASSERT_TRUE(frame) << frame.error().line();
    const auto healed = steady_clock::now() - back;
    std::printf("restart %d: loss seen after %lld ms, healed %lld ms after the return\n", i,
                static_cast<long long>(std::chrono::duration_cast<milliseconds>(seen).count()),
                static_cast<long long>(std::chrono::duration_cast<milliseconds>(healed).count()));
  }
  EXPECT_EQ((*source)->counters().reconnects, static_cast<std::uint64_t>(kRestarts));
}

TEST_F(GigeCamera, ASecondClientIsToldWhoHoldsIt) {
  const FakeCamera fake;
  auto first = open({});
  ASSERT_TRUE(first) << first.error().line();
  const auto second = open({});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, core::ErrorCode::device);
  EXPECT_NE(second.error().why.find("another program holds the camera"), std::string::npos) << second.error().line();
  first->reset();
  const auto third = open({});
  EXPECT_TRUE(third) << "free again once it is closed";
}

TEST_F(GigeCamera, IsFoundByEveryOfItsNames) {
  const FakeCamera fake;
  for (const std::string name : {"127.0.0.1", "GV01", "Aravis-Fake-GV01", ""}) {
    const auto source = open({}, LiveSource::Policy::newest, name);
    ASSERT_TRUE(source) << name << ": " << source.error().line();
    EXPECT_EQ((*source)->info().camera_id, "Aravis-Fake-GV01");
  }
  const auto other = open({}, LiveSource::Policy::newest, "GV02");
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, core::ErrorCode::device);
}

TEST_F(GigeCamera, NobodyThereIsAnErrorInTime) {
  const auto begin = steady_clock::now();
  const auto none = open({});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, core::ErrorCode::device);
  EXPECT_LT(steady_clock::now() - begin, std::chrono::seconds(10)) << "Aravis alone waits far longer";
}

TEST_F(GigeCamera, TakesSettingsAndRefusesWhatItDoesNotHave) {
  const FakeCamera fake;
  for (const auto& [setting, words] :
       std::vector<std::pair<std::string, std::string>>{{"exposure_us=1e9", "takes"},
                                                        {"NoSuchFeature=1", "neither"},
                                                        {"pixel_format=Mono99", "refuses"},
                                                        {"chunks=ExposureTime", "no chunk data"},
                                                        {"roi_px=2000,0,512,512", "sensor"}}) {
    const auto refused = open({setting});
    ASSERT_FALSE(refused) << setting;
    EXPECT_NE(refused.error().line().find(words), std::string::npos) << refused.error().line();
  }
  auto source = open({"exposure_us=2500", "roi_px=8,16,200,100", "TestRegister=7"});
  ASSERT_TRUE(source) << source.error().line();
  const auto frame = grab(**source);
  ASSERT_TRUE(frame) << frame.error().line();
  EXPECT_EQ(frame->picture->width(), 200);
  EXPECT_EQ(frame->picture->height(), 100);
  ASSERT_TRUE(frame->settings);
  EXPECT_EQ(frame->settings->exposure_us, 2500);
  EXPECT_EQ(frame->settings->offset_x_px, 8);
  EXPECT_EQ(frame->settings->offset_y_px, 16);
  EXPECT_TRUE(frame->device_ns);
}

TEST_F(GigeCamera, EveryPixelFormatGivesAPicture) {
  const FakeCamera fake;
  for (const std::string format : {"Mono8", "Mono16", "RGB8", "BayerRG8", "BayerBG8", "BayerGR8", "BayerGB8"}) {
    auto source = open({"pixel_format=" + format, "roi_px=0,0,300,200"});
    ASSERT_TRUE(source) << format << ": " << source.error().line();
    const auto frame = grab(**source);
    ASSERT_TRUE(frame) << format << ": " << frame.error().line();
    EXPECT_EQ(frame->picture->width(), 300);
    EXPECT_EQ(frame->settings->pixel_format, format);
    std::set<int> values;
    for (int x = 0; x < 300; ++x) values.insert(frame->picture->at(x, 100));
    EXPECT_GT(values.size(), 20u) << format << " has no ramp";
  }
}

TEST_F(GigeCamera, ATriggeredPictureIsTakenAfterTheCall) {
  const FakeCamera fake;
  auto source = open({"trigger=software"});
  ASSERT_TRUE(source) << source.error().line();
  std::uint64_t last = 0;
  for (int i = 0; i < 5; ++i) {
    const core::TimePoint asked = clock_.now();
    const auto frame = grab(**source);
    ASSERT_TRUE(frame) << frame.error().line();
    EXPECT_GT(frame->exposed + milliseconds(110), asked);
    EXPECT_LT(frame->exposed, clock_.now());
    EXPECT_GT(frame->sequence, last);
    last = frame->sequence;
  }
}

/// The fake camera has the registers of a hardware trigger and of binning, but no line that pulses and no pixels that
/// it joins.
TEST_F(GigeCamera, AHardwareTriggerIsSetAndItsSilenceExplained) {
  const FakeCamera fake;
  {
    auto source = open({"trigger=Line0", "binning=2"});
    ASSERT_TRUE(source) << source.error().line();
    const auto frame = grab(**source, 0.3);
    ASSERT_FALSE(frame);
    EXPECT_NE(frame.error().remedy.find("waiting for a trigger"), std::string::npos) << frame.error().line();
    EXPECT_TRUE((*source)->health()) << "it is there, only silent";
  }
  const auto features = frames::camera_features("aravis:127.0.0.1");
  ASSERT_TRUE(features) << features.error().line();
  std::map<std::string, std::string> value(features->begin(), features->end());
  EXPECT_EQ(value["TriggerMode"], "On");
  EXPECT_EQ(value["TriggerSource"], "Line0");
  EXPECT_EQ(value["TriggerSelector"], "FrameStart");
  EXPECT_EQ(value["BinningHorizontal"], "2");
  EXPECT_EQ(value["BinningVertical"], "2");
}

TEST_F(GigeCamera, FreeRunningGivesAPictureBegunAfterTheCall) {
  const FakeCamera fake;
  auto source = open({"fps=50", "exposure_us=2000"});
  ASSERT_TRUE(source) << source.error().line();
  for (int i = 0; i < 5; ++i) {
    const core::TimePoint asked = clock_.now();
    const auto frame = grab(**source);
    ASSERT_TRUE(frame) << frame.error().line();
    EXPECT_GE(frame->exposed - std::chrono::microseconds(1000), asked);
  }
}

#ifdef PICKCELL_SOAK
long resident_kib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmRSS:")) return std::stol(line.substr(6));
  return 0;
}

TEST_F(GigeCamera, MemoryStaysFlatOver100000Frames) {
  const FakeCamera fake;
  auto source = open({"roi_px=0,0,320,240", "fps=500"}, LiveSource::Policy::every);
  ASSERT_TRUE(source) << source.error().line();
  // A reader that falls behind once: now every picture is made that a waiting line may ever hold.
  while ((*source)->counters().late == 0) seat_->sleep_for(milliseconds(50));
  long after_warm_up = 0;
  for (int i = 0; i < 100'000; ++i) {
    ASSERT_TRUE(grab(**source));
    if (i == 5'000) after_warm_up = resident_kib();
    if (i % 20'000 == 5'000) std::printf("resident after %d frames: %ld KiB\n", i, resident_kib());
  }
  std::printf("resident after 100000 frames: %ld KiB\n", resident_kib());
  EXPECT_LT(resident_kib() - after_warm_up, 1024);
}
#endif

}  // namespace
}  // namespace pickcell
