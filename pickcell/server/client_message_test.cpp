#include "pickcell/server/client_message.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <string>

namespace pickcell::server {
namespace {

TEST(ClientMessage, TheThreeThatAreKnown) {
  const auto subscribe = parse_client_message(
      R"({"type":"sub","video":{"cam":0,"maxW":900,"maxFps":12.5,"quality":70},"topics":["log"]})");
  ASSERT_TRUE(subscribe);
  const auto& s = std::get<Subscribe>(*subscribe);
  ASSERT_TRUE(s.video);
  EXPECT_EQ(s.video->max_width_px, 900);
  EXPECT_EQ(s.video->max_fps, 12.5);
  EXPECT_EQ(s.video->quality, 70);
  EXPECT_TRUE(s.log);
  const auto silent = parse_client_message(R"({"type":"sub","video":null,"topics":[]})");
  ASSERT_TRUE(silent);
  EXPECT_FALSE(std::get<Subscribe>(*silent).video);
  EXPECT_EQ(std::get<Acknowledge>(parse_client_message(R"({"type":"ack","f":4294967295})").value()).frame_id,
            UINT32_MAX);
  EXPECT_TRUE(std::holds_alternative<Resync>(parse_client_message(R"({"type":"resync"})").value()));
}

TEST(ClientMessage, WishesAreHeldToLimits) {
  const auto greedy = parse_client_message(R"({"type":"sub","video":{"maxW":1e9,"maxFps":1e9,"quality":-5}})");
  ASSERT_TRUE(greedy);
  const VideoRequest video = *std::get<Subscribe>(*greedy).video;
  EXPECT_EQ(video.max_width_px, 4096);
  EXPECT_EQ(video.max_fps, 60);
  EXPECT_EQ(video.quality, 30);
}

TEST(ClientMessage, AnythingElseIsRefusedWithTheReason) {
  for (const char* bad : {"", "{", "[]", "null", "7", "{}", R"({"type":"start"})", R"({"type":7})", R"({"type":"ack"})",
                          R"({"type":"ack","f":-1})", R"({"type":"ack","f":4294967296})", R"({"type":"ack","f":"1"})",
                          R"({"type":"sub","video":7})", R"({"type":"sub","video":{"cam":1}})",
                          R"({"type":"sub","video":{"maxW":"wide"}})", R"({"type":"sub","video":{"maxFps":null}})"}) {
    const auto parsed = parse_client_message(bad);
    ASSERT_FALSE(parsed) << bad;
    EXPECT_FALSE(parsed.error().why.empty());
  }
}

/// Alterations of good messages: parsed or refused, numbers always within their limits.
TEST(ClientMessage, PropertySurvivesAnyBytes) {
  const std::array<std::string, 3> good{
      R"({"type":"sub","video":{"cam":0,"maxW":900,"maxFps":12.5,"quality":70},"topics":["log"]})",
      R"({"type":"ack","f":123})", R"({"type":"resync"})"};
  std::mt19937 random(11);
  for (int i = 0; i < 20000; ++i) {
    std::string text = good[random() % good.size()];
    for (unsigned edits = 1 + random() % 4; edits > 0 && !text.empty(); --edits) {
      const std::size_t at = random() % text.size();
      if (random() % 3 == 0)
        text.erase(at, 1 + random() % 5);
      else
        text[at] = static_cast<char>(random() % 256);
    }
    const auto parsed = parse_client_message(text);
    if (!parsed) continue;
    const auto* subscribe = std::get_if<Subscribe>(&*parsed);
    if (subscribe == nullptr || !subscribe->video) continue;
    EXPECT_TRUE(subscribe->video->max_width_px >= 160 && subscribe->video->max_width_px <= 4096) << text;
    EXPECT_TRUE(subscribe->video->max_fps >= 0.2 && subscribe->video->max_fps <= 60) << text;
  }
}

TEST(MessageRate, LetsTheAllowedRateThroughAndNoMore) {
  MessageRate rate(50);
  const WallTime begin = WallTime{} + std::chrono::hours(1);
  int passed = 0;
  for (int ms = 0; ms < 10000; ++ms) passed += rate.allow(begin + std::chrono::milliseconds(ms)) ? 1 : 0;
  EXPECT_NEAR(passed, 550, 5) << "a burst of 50 and 50 per second";
}

}  // namespace
}  // namespace pickcell::server
