#include "pickcell/server/frame_encoder.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

#include "pickcell/image/codec.hpp"
#include "pickcell/server/frame_message.hpp"
#include "pickcell/server/shrink.hpp"

namespace pickcell::server {
namespace {

image::Image noise(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  image::Image out(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) out.at(x, y) = static_cast<std::uint8_t>(random());
  return out;
}

ShownFramePtr shown(std::uint64_t sequence, int width, int height) {
  auto out = std::make_shared<cell::ShownFrame>();
  out->frame.sequence = sequence;
  out->frame.picture = std::make_shared<const image::Image>(noise(width, height, 1));
  out->detections.resize(2);
  return out;
}

/// The mean over the covered area, by brute force with exact overlaps.
double area_mean(const image::Image& picture, double x0, double x1, double y0, double y1) {
  double sum = 0, area = 0;
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) {
      const double w = std::max(0.0, std::min(x + 1.0, x1) - std::max<double>(x, x0));
      const double h = std::max(0.0, std::min(y + 1.0, y1) - std::max<double>(y, y0));
      sum += w * h * picture.at(x, y);
      area += w * h;
    }
  return sum / area;
}

TEST(Shrink, IsTheMeanOfTheCoveredArea) {
  for (const auto& [w, h, to] :
       {std::array{40, 30, 20}, std::array{41, 23, 17}, std::array{64, 9, 3}, std::array{7, 50, 6}}) {
    const image::Image picture = noise(w, h, 5);
    const image::Image small = shrink(picture.view(), to);
    ASSERT_EQ(small.width(), to);
    const double sx = static_cast<double>(w) / to;
    const double sy = static_cast<double>(h) / small.height();
    for (int y = 0; y < small.height(); ++y)
      for (int x = 0; x < to; ++x)
        ASSERT_NEAR(small.at(x, y), area_mean(picture, x * sx, (x + 1) * sx, y * sy, (y + 1) * sy), 0.51)
            << x << "," << y;
  }
}

TEST(Shrink, ExtremesAndRefusals) {
  const image::Image picture = noise(50, 40, 6);
  EXPECT_EQ(shrink(picture.view(), 50).at(49, 39), picture.at(49, 39));
  EXPECT_EQ(shrink(picture.view(), 1).height(), 1);
  EXPECT_THROW((void)shrink(picture.view(), 0), std::invalid_argument);
  EXPECT_THROW((void)shrink(picture.view(), 51), std::invalid_argument);
  image::Image white(4000, 3);
  white.fill(255);
  EXPECT_EQ(shrink(white.view(), 1).at(0, 0), 255);
}

TEST(FrameEncoder, EncodesOnceForAllThatWantTheSame) {
  FrameEncoder encoder;
  const auto frame = shown(9, 64, 48);
  const auto first = encoder.message(frame, 1280, 80);
  EXPECT_EQ(encoder.message(frame, 64, 80), first) << "never wider than the sensor";
  EXPECT_EQ(encoder.jpegs_made(), 1u);
  EXPECT_NE(encoder.message(frame, 32, 80), first);
  EXPECT_NE(encoder.message(frame, 64, 60), first);
  EXPECT_EQ(encoder.jpegs_made(), 3u);
  auto changed = std::make_shared<cell::ShownFrame>(*frame);  // a part was placed: the same pixels
  changed->detections[0].state = cell::DetectionState::placed;
  EXPECT_NE(encoder.message(changed, 64, 80), first);
  EXPECT_EQ(encoder.jpegs_made(), 3u);
}

TEST(FrameEncoder, TheMessageHoldsThePictureInItsSize) {
  FrameEncoder encoder;
  const auto message = *encoder.message(shown(0x1'0000'0007, 64, 48), 32, 90);
  const auto u16 = [&](std::size_t at) {
    return std::to_integer<int>(message[at]) | std::to_integer<int>(message[at + 1]) << 8;
  };
  EXPECT_EQ(u16(8), 7) << "the low 32 bits of the sequence";
  EXPECT_EQ(u16(24), 32);
  EXPECT_EQ(u16(26), 24);
  EXPECT_EQ(u16(28), 500);
  const std::size_t overlay = static_cast<std::size_t>(u16(12));
  const auto picture = image::decode_grey(std::span(message).subspan(32 + overlay), "message");
  ASSERT_TRUE(picture) << picture.error().line();
  EXPECT_EQ(picture->width(), 32);
  EXPECT_EQ(picture->height(), 24);
}

TEST(FrameEncoder, KeepsLittle) {
  FrameEncoder encoder;
  std::weak_ptr<const cell::ShownFrame> first;
  for (std::uint64_t i = 1; i <= 30; ++i) {
    const auto frame = shown(i, 16, 16);
    if (i == 1) first = frame;
    (void)encoder.message(frame, 16, 80);
  }
  EXPECT_TRUE(first.expired());
}

}  // namespace
}  // namespace pickcell::server
