#include "pickcell/frames/live_source.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <deque>
#include <functional>
#include <set>
#include <vector>

#include "pickcell/frames/pixel_format.hpp"

namespace pickcell::frames {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// What a scripted camera does; shared between the test and each of its connections.
struct Script {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Arrival> coming;  ///< delivered as soon as asked for
  bool there = true;           ///< answers at all
  bool forgot_us = false;      ///< answers, but the connection is void
  bool answers_triggers = true;
  int triggers = 0, connects = 0;
  int spoil = 0;  ///< so many of the next triggered frames arrive incomplete
  std::uint64_t id = 0;
  std::vector<std::byte> pixels = std::vector<std::byte>(std::size_t{8} * 4, std::byte{50});

  Arrival frame() {
    Arrival a;
    a.id = ++id;
    a.began = steady_clock::now();
    a.device_ns = a.began.time_since_epoch().count();
    a.picture = {pixels, kMono8, 8, 4, 0};
    return a;
  }
  void deliver(Arrival a) {
    const std::lock_guard lock(mutex);
    coming.push_back(a);
    changed.notify_all();
  }
  void set(bool Script::* what, bool value) {
    const std::lock_guard lock(mutex);
    this->*what = value;
    changed.notify_all();
  }
};

class ScriptedDevice final : public CameraDevice {
 public:
  explicit ScriptedDevice(Script& script) : script_(script) {
    info_.id = "scripted";
    info_.width_px = 8;
    info_.height_px = 4;
    info_.settings.exposure_us = 1000;
    info_.settings.pixel_format = "Mono8";
  }
  [[nodiscard]] const DeviceInfo& info() const override { return info_; }
  [[nodiscard]] core::Result<std::optional<Arrival>> next(milliseconds timeout) override {
    std::unique_lock lock(script_.mutex);
    script_.changed.wait_for(lock, timeout, [&] { return !script_.coming.empty(); });
    if (script_.coming.empty() || !script_.there) return std::optional<Arrival>();
    Arrival a = script_.coming.front();
    script_.coming.pop_front();
    return std::optional<Arrival>(a);
  }
  [[nodiscard]] core::Status trigger() override {
    const std::lock_guard lock(script_.mutex);
    ++script_.triggers;
    if (!script_.answers_triggers) return {};
    Arrival a = script_.frame();
    if (script_.spoil > 0) {
      --script_.spoil;
      a.wholeness = Wholeness::incomplete;
    }
    script_.coming.push_back(a);
    script_.changed.notify_all();
    return {};
  }
  [[nodiscard]] core::Status check() override {
    const std::lock_guard lock(script_.mutex);
    if (!script_.there) return core::failure(core::ErrorCode::timeout, "scripted", "no answer", "check the cable");
    if (script_.forgot_us) return core::failure(core::ErrorCode::device, "scripted", "started anew");
    return {};
  }

 private:
  Script& script_;
  DeviceInfo info_;
};

class LiveSourceTest : public ::testing::Test {
 protected:
  std::unique_ptr<LiveSource> open(LiveSource::Options options = {}) {
    auto connect = [this]() -> core::Result<std::unique_ptr<CameraDevice>> {
      const std::lock_guard lock(script_.mutex);
      ++script_.connects;
      if (!script_.there)
        return core::failure(core::ErrorCode::device, "scripted", "nobody answers", "check the cable");
      script_.forgot_us = false;
      return std::unique_ptr<CameraDevice>(std::make_unique<ScriptedDevice>(script_));
    };
    options.retry_every = milliseconds(5);
    auto source = LiveSource::open(connect, options, clock_);
    EXPECT_TRUE(source);
    return std::move(*source);
  }
  core::Result<Frame> grab(LiveSource& source, double timeout_s = 20) {
    return source.grab(*seat_, core::duration_s(timeout_s));
  }
  void wait_for(const std::function<bool()>& condition) {
    for (int i = 0; i < 4000 && !condition(); ++i) seat_->sleep_for(milliseconds(5));
    ASSERT_TRUE(condition());
  }

  Script script_;
  core::RealClock clock_;
  std::unique_ptr<core::Seat> seat_ = clock_.join("test");
};

LiveSource::Options triggered() {
  LiveSource::Options options;
  options.software_trigger = true;
  return options;
}
LiveSource::Options every() {
  LiveSource::Options options;
  options.policy = LiveSource::Policy::every;
  return options;
}

TEST_F(LiveSourceTest, ATriggeredFrameCarriesAllThatBelongsToIt) {
  auto source = open(triggered());
  const core::TimePoint asked = clock_.now();
  const auto frame = grab(*source);
  ASSERT_TRUE(frame) << frame.error().line();
  EXPECT_EQ(frame->sequence, 1u);
  EXPECT_EQ(frame->camera_id, "scripted");
  EXPECT_EQ(frame->picture->at(7, 3), 50);
  EXPECT_EQ(frame->settings->exposure_us, 1000);
  EXPECT_TRUE(frame->device_ns);
  EXPECT_GE(frame->exposed + std::chrono::microseconds(500), asked);
  EXPECT_LE(frame->exposed, clock_.now());
  EXPECT_NEAR(static_cast<double>(frame->exposed_unix_us - clock_.unix_us()),
              -core::seconds(clock_.now() - frame->exposed) * 1e6, 2e4);
}

TEST_F(LiveSourceTest, ASpoiltExposureIsAskedForAgain) {
  script_.spoil = 2;
  auto source = open(triggered());
  ASSERT_TRUE(grab(*source));
  EXPECT_EQ(script_.triggers, 3);
  EXPECT_EQ(source->counters().incomplete, 2u);
  EXPECT_EQ(source->counters().frames, 1u);
}

TEST_F(LiveSourceTest, NewestPolicyNeverGivesAPictureFromBeforeTheCall) {
  auto source = open();
  for (int i = 0; i < 5; ++i) script_.deliver(script_.frame());
  wait_for([&] { return source->counters().frames == 5; });
  EXPECT_FALSE(grab(*source, 0.05)) << "all were exposed before";
  std::atomic<bool> done = false;
  std::thread camera([&] {
    while (!done) {
      script_.deliver(script_.frame());
      std::this_thread::sleep_for(milliseconds(2));
    }
  });
  for (int i = 0; i < 5; ++i) {
    const core::TimePoint asked = clock_.now();
    const auto frame = grab(*source);
    EXPECT_TRUE(frame);
    EXPECT_TRUE(!frame || frame->exposed - std::chrono::microseconds(500) >= asked);
  }
  done = true;
  camera.join();
}

TEST_F(LiveSourceTest, EveryPolicyGivesAllInTheirOrder) {
  auto source = open(every());
  for (int i = 0; i < 30; ++i) script_.deliver(script_.frame());
  for (std::uint64_t n = 1; n <= 30; ++n) {
    const auto frame = grab(*source);
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->sequence, n);
  }
}

TEST_F(LiveSourceTest, RepeatedLateAndTornFramesAreCountedAndNeverGiven) {
  auto source = open(every());
  const Arrival first = script_.frame(), second = script_.frame(), third = script_.frame();
  Arrival torn = script_.frame();
  torn.picture.bytes = torn.picture.bytes.first(5);
  for (const Arrival& a : {first, first, third, second, torn, script_.frame()}) script_.deliver(a);
  for (const std::uint64_t n : {1U, 3U, 5U}) {
    const auto frame = grab(*source);
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->sequence, n);
  }
  const FrameCounters c = source->counters();
  EXPECT_EQ(c.frames, 3u);
  EXPECT_EQ(c.repeated, 1u);
  EXPECT_EQ(c.late, 1u);
  EXPECT_EQ(c.torn, 1u);
  EXPECT_EQ(c.missing, 0u) << "the overtaken one did arrive";
}

TEST_F(LiveSourceTest, WhatAFrameTellsOfItselfGoesBeforeTheSettings) {
  auto source = open(every());
  Arrival a = script_.frame();
  a.exposure_us = 4000;
  a.gain = 6.5;
  a.encoder = -123456;
  a.offset_x_px = 16;
  script_.deliver(a);
  script_.deliver(script_.frame());
  const auto own = grab(*source), plain = grab(*source);
  ASSERT_TRUE(own && plain);
  EXPECT_EQ(own->settings->exposure_us, 4000);
  EXPECT_EQ(own->settings->gain, 6.5);
  EXPECT_EQ(own->settings->offset_x_px, 16);
  EXPECT_EQ(own->settings->pixel_format, "Mono8");
  EXPECT_EQ(own->encoder, -123456);
  EXPECT_EQ(own->device_ns, a.device_ns);
  EXPECT_EQ(plain->settings->exposure_us, 1000);
  EXPECT_FALSE(plain->encoder);
  // Mid-exposure: half of its own exposure before it left the camera, which is no later than it was here.
  const auto half = std::chrono::microseconds(2000);
  EXPECT_LE(own->exposed + half, clock_.now());
  EXPECT_LT(own->exposed, plain->exposed) << "4 ms against 1 ms, taken one after the other";
}

TEST_F(LiveSourceTest, AFrameThatWasHeldUpIsTooOld) {
  auto source = open(every());
  script_.deliver(script_.frame());
  ASSERT_TRUE(grab(*source));
  // Its stamp says that it left the camera 0.7 s before it came.
  Arrival held_up = script_.frame();
  held_up.began += milliseconds(700);
  script_.deliver(held_up);
  wait_for([&] { return source->counters().late == 1; });
  EXPECT_EQ(source->counters().frames, 1u);
}

TEST_F(LiveSourceTest, AnInterruptionShorterThanTheTimeoutIsNoError) {
  auto source = open(triggered());
  ASSERT_TRUE(grab(*source));
  script_.set(&Script::there, false);
  wait_for([&] { return !source->health().has_value(); });
  EXPECT_EQ(source->health().error().code, core::ErrorCode::device);
  std::thread repair([&] { script_.set(&Script::there, true); });
  const auto frame = grab(*source);
  repair.join();
  EXPECT_TRUE(frame) << frame.error().line();
  EXPECT_TRUE(source->health());
  EXPECT_EQ(source->counters().reconnects, 1u);
  EXPECT_EQ(script_.connects, 1) << "both sides still knew each other";
}

TEST_F(LiveSourceTest, ACameraThatStartedAnewIsConnectedAnew) {
  auto source = open(triggered());
  ASSERT_TRUE(grab(*source));
  {
    const std::lock_guard lock(script_.mutex);
    script_.id = 0;
    script_.forgot_us = true;
    script_.answers_triggers = false;
  }
  wait_for([&] { return source->counters().reconnects == 1; });
  script_.set(&Script::answers_triggers, true);
  const auto frame = grab(*source);
  ASSERT_TRUE(frame) << frame.error().line();
  EXPECT_EQ(frame->sequence, 2u) << "counts on";
  EXPECT_EQ(source->counters().missing, 0u);
}

TEST_F(LiveSourceTest, ALossIsAnErrorThatSaysWhy) {
  auto source = open(triggered());
  script_.set(&Script::there, false);
  wait_for([&] { return !source->health().has_value(); });
  const auto frame = grab(*source, 0.01);
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().code, core::ErrorCode::device);
  EXPECT_EQ(frame.error().remedy, "check the cable");
}

TEST_F(LiveSourceTest, PicturesAreUsedAgain) {
  auto source = open(triggered());
  std::set<const image::Image*> pictures;
  for (int i = 0; i < 50; ++i) {
    const auto frame = grab(*source);
    ASSERT_TRUE(frame);
    pictures.insert(frame->picture.get());
  }
  EXPECT_LE(pictures.size(), 3u);
}

}  // namespace
}  // namespace pickcell::frames
