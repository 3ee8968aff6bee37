#include "pickcell/server/client_queue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <random>

namespace pickcell::server {
namespace {

using namespace std::chrono_literals;

const WallTime kBegin = WallTime{} + 1h;

ShownFramePtr frame(std::uint64_t sequence) {
  auto shown = std::make_shared<cell::ShownFrame>();
  shown->frame.sequence = sequence;
  return shown;
}

/// What next() says, as written at once.
Outgoing take(ClientQueue& queue, WallTime now) {
  Outgoing out = queue.next(now);
  queue.written(now);
  return out;
}

TEST(ClientQueue, TextsGoOutOnceInTheOrderOfUrgency) {
  ClientQueue queue;
  for (const Topic t : {Topic::heartbeat, Topic::log, Topic::state, Topic::snap, Topic::hello, Topic::state})
    queue.mark(t);
  for (const Topic t : {Topic::hello, Topic::snap, Topic::state, Topic::log, Topic::heartbeat})
    EXPECT_EQ(take(queue, kBegin).topic, t);
  EXPECT_TRUE(take(queue, kBegin).empty());
}

TEST(ClientQueue, AlarmsKeepTheirOrderAndASnapSwallowsThem) {
  ClientQueue queue;
  ASSERT_TRUE(queue.push_alarm("a"));
  ASSERT_TRUE(queue.push_alarm("b"));
  queue.mark(Topic::state);
  EXPECT_EQ(take(queue, kBegin).alarm, "a");
  queue.mark(Topic::snap);
  ASSERT_TRUE(queue.push_alarm("c")) << "the snap will contain it";
  EXPECT_EQ(take(queue, kBegin).topic, Topic::snap);
  EXPECT_EQ(take(queue, kBegin).topic, Topic::state);
  EXPECT_TRUE(take(queue, kBegin).empty());
}

TEST(ClientQueue, TooManyAlarmsEndTheConnection) {
  ClientQueue queue;
  for (int i = 0; i < 256; ++i) ASSERT_TRUE(queue.push_alarm("x"));
  EXPECT_FALSE(queue.push_alarm("x"));
}

TEST(ClientQueue, NothingWhileAMessageIsBeingWritten) {
  ClientQueue queue;
  queue.mark(Topic::hello);
  queue.mark(Topic::snap);
  EXPECT_EQ(queue.next(kBegin).topic, Topic::hello);
  EXPECT_TRUE(queue.next(kBegin).empty());
  queue.written(kBegin);
  EXPECT_EQ(queue.next(kBegin).topic, Topic::snap);
}

TEST(ClientQueue, TextGoesBeforeAWaitingFrame) {
  ClientQueue queue;
  queue.subscribe({});
  queue.offer(frame(1));
  queue.mark(Topic::heartbeat);
  EXPECT_EQ(take(queue, kBegin).topic, Topic::heartbeat);
  EXPECT_TRUE(take(queue, kBegin).frame);
}

TEST(ClientQueue, AtMostTheAskedRate) {
  ClientQueue queue;
  queue.subscribe({.max_fps = 10});
  queue.offer(frame(1));
  EXPECT_TRUE(take(queue, kBegin).frame);
  queue.acknowledge(1, kBegin + 1ms);
  queue.offer(frame(2));
  EXPECT_FALSE(take(queue, kBegin + 99ms).frame);
  EXPECT_EQ(queue.wake_at(), kBegin + 100ms);
  EXPECT_TRUE(take(queue, kBegin + 100ms).frame);
}

TEST(ClientQueue, WithoutAcknowledgementNoFrameAndInTheEndNoSubscription) {
  ClientQueue queue;
  queue.subscribe({});
  queue.offer(frame(1));
  ASSERT_TRUE(take(queue, kBegin).frame);
  queue.offer(frame(2));
  EXPECT_TRUE(take(queue, kBegin + 29s).empty());
  EXPECT_EQ(queue.check(kBegin + 29s), QueueVerdict::fine);
  EXPECT_EQ(queue.check(kBegin + 31s), QueueVerdict::video_dropped);
  EXPECT_FALSE(queue.video());
  EXPECT_EQ(take(queue, kBegin + 31s).topic, Topic::video) << "the page is told";
  queue.offer(frame(3));
  EXPECT_TRUE(take(queue, kBegin + 32s).empty());
}

TEST(ClientQueue, AWriteThatDoesNotEndIsCut) {
  ClientQueue queue;
  queue.mark(Topic::hello);
  (void)queue.next(kBegin);
  EXPECT_EQ(queue.check(kBegin + 9s), QueueVerdict::fine);
  EXPECT_EQ(queue.check(kBegin + 11s), QueueVerdict::cut);
}

TEST(ClientQueue, ForeignAcknowledgementsGiveNoCredit) {
  ClientQueue queue;
  queue.subscribe({});
  queue.offer(frame(5));
  ASSERT_TRUE(take(queue, kBegin).frame);
  queue.offer(frame(6));
  for (const std::uint32_t id : {0u, 4u, 6u, 0xFFFFFFFFu}) queue.acknowledge(id, kBegin + 1s);
  EXPECT_FALSE(take(queue, kBegin + 1s).frame);
  queue.acknowledge(5, kBegin + 1s);
  EXPECT_TRUE(take(queue, kBegin + 1s).frame);
}

/// Whatever happens in whatever order: never two frames without acknowledgement, never more than one waiting, frames
/// only forward.
TEST(ClientQueue, PropertyOneFrameOutOneWaiting) {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    ClientQueue queue;
    WallTime now = kBegin;
    std::uint64_t made = 0;
    std::uint32_t out = 0, last = 0;
    for (int step = 0; step < 300; ++step) {
      now += std::chrono::milliseconds(random() % 40);
      switch (random() % 6) {
        case 0:
          queue.subscribe({});
          out = 0;
          break;
        case 1:
        case 2:
          queue.offer(frame(++made));
          break;
        case 3:
          queue.acknowledge(static_cast<std::uint32_t>(random() % 4 == 0 ? random() : out), now);
          break;
        default:
          if (const Outgoing next = take(queue, now); next.frame) {
            const std::uint32_t id = wire_frame_id(*next.frame->shown);
            ASSERT_GT(id, last) << "never an older one";
            last = out = id;
          }
      }
      ASSERT_LE(queue.frames_waiting(), 1u);
    }
  }
}

/// T9's logic on a clock of its own: 30 frames per second at a page that takes 200 ms for each.
TEST(ClientQueue, ASlowPageFallsBehindByOneFrameWhereNaivePushGrows) {
  ClientQueue queue;
  queue.subscribe({.max_fps = 30});
  std::deque<WallTime> naive;  // capture times of frames that wait with a page that is sent everything
  std::optional<std::pair<std::uint32_t, WallTime>> drawing;
  WallTime naive_free = kBegin;
  WallDuration worst{}, naive_worst{};
  for (int ms = 0; ms < 20000; ++ms) {
    const WallTime now = kBegin + std::chrono::milliseconds(ms);
    if (ms % 33 == 0) {
      queue.offer(frame(static_cast<std::uint64_t>(ms) + 1));
      naive.push_back(now);
    }
    if (drawing && now >= drawing->second) {
      worst = std::max<WallDuration>(worst, now - (kBegin + std::chrono::milliseconds(drawing->first - 1)));
      queue.acknowledge(drawing->first, now);
      drawing.reset();
    }
    if (const Outgoing out = take(queue, now); out.frame) drawing = {wire_frame_id(*out.frame->shown), now + 200ms};
    if (!naive.empty() && now >= naive_free) {
      naive_worst = std::max<WallDuration>(naive_worst, now + 200ms - naive.front());
      naive.pop_front();
      naive_free = now + 200ms;
    }
  }
  EXPECT_LE(worst, 300ms) << "one being drawn, one that waited at most a frame";
  EXPECT_GT(naive_worst, 10s) << "the same page, pushed everything";
}

TEST(AdaptiveVideo, StepsDownSlowlyAndRecoversAfterTenSeconds) {
  AdaptiveVideo video;
  WallTime now = kBegin;
  const auto acknowledge = [&](int n, WallDuration trip, WallDuration every) {
    for (int i = 0; i < n; ++i) video.acknowledged(trip, now += every);
  };
  const VideoRequest asked{0, 1280, 20, 80};
  acknowledge(9, 500ms, 100ms);
  EXPECT_EQ(video.rung(), 0) << "nine are no sample";
  acknowledge(1, 500ms, 100ms);
  EXPECT_EQ(video.limit(asked).max_fps, 10);
  EXPECT_EQ(video.limit(asked).max_width_px, 1280);
  acknowledge(10, 500ms, 100ms);
  EXPECT_EQ(video.limit(asked).max_width_px, 960);
  acknowledge(10, 500ms, 100ms);
  EXPECT_EQ(video.limit(asked).max_width_px, 640);
  EXPECT_EQ(video.limit(asked).quality, 80);
  acknowledge(100, 500ms, 100ms);
  EXPECT_EQ(video.limit(asked).quality, 60);
  EXPECT_EQ(video.rung(), AdaptiveVideo::kRungs - 1);
  acknowledge(10, 20ms, 100ms);
  const int before = video.rung();
  acknowledge(50, 20ms, 100ms);
  EXPECT_EQ(video.rung(), before) << "not within ten seconds";
  acknowledge(600, 20ms, 100ms);
  EXPECT_EQ(video.rung(), 0);
}

TEST(AdaptiveVideo, OneSlowFrameOfTenIsNoReason) {
  AdaptiveVideo video;
  for (int i = 0; i < 100; ++i)
    video.acknowledged(i % 11 == 0 ? 900ms : 30ms, kBegin + std::chrono::milliseconds(100 * i));
  EXPECT_EQ(video.rung(), 0);
}

}  // namespace
}  // namespace pickcell::server
