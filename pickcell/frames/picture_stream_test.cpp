#include "pickcell/frames/picture_stream.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "pickcell/core/file.hpp"
#include "pickcell/frames/video_source.hpp"
#include "pickcell/image/codec.hpp"

namespace pickcell::frames {
namespace {

std::vector<std::byte> bytes_of(const std::string& text) {
  std::vector<std::byte> out(text.size());
  std::memcpy(out.data(), text.data(), text.size());
  return out;
}

/// 3x2 pictures, all pixels the given values.
std::string y4m(const std::vector<char>& values) {
  std::string out = "YUV4MPEG2 W3 H2 F25:1 Ip A1:1 C420jpeg\n";
  for (const char v : values) out += "FRAME\n" + std::string(6, v) + std::string(4, '\x80');
  return out;
}
std::string pgm(const std::vector<char>& values) {
  std::string out;
  for (const char v : values) out += "P5\n# of a pipe\n3 2\n255\n" + std::string(6, v);
  return out;
}
std::string mjpeg(const std::vector<char>& values) {
  std::string out;
  for (const char v : values) {
    image::Image picture(16, 16);
    picture.fill(static_cast<std::uint8_t>(v));
    const auto jpeg = image::encode_jpeg(picture.view(), 90);
    out.append(reinterpret_cast<const char*>(jpeg.data()), jpeg.size());
  }
  return out;
}

class Streams : public ::testing::TestWithParam<std::string (*)(const std::vector<char>&)> {};

TEST_P(Streams, ComeOutTheSameHoweverTheBytesComeIn) {
  const auto all = bytes_of(GetParam()({10, 20, 30, 40}));
  std::mt19937 random(4);
  for (int round = 0; round < 30; ++round) {
    PictureStream stream("test");
    std::vector<int> seen;
    std::size_t at = 0;
    for (bool ended = false;;) {
      auto picture = stream.next();
      ASSERT_TRUE(picture) << picture.error().line();
      if (*picture) {
        seen.push_back((*picture)->at(0, 0));
      } else if (ended) {
        break;
      } else if (at == all.size()) {
        stream.end();
        ended = true;
      } else {
        const std::size_t n = std::min<std::size_t>(all.size() - at, random() % 40 + 1);
        stream.feed(std::span(all).subspan(at, n));
        at += n;
      }
    }
    ASSERT_EQ(seen.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(seen[i], 10 * (static_cast<int>(i) + 1), 1);
  }
}

TEST_P(Streams, ACutStreamIsAnErrorUnlessItIsCutBetweenPictures) {
  const auto all = bytes_of(GetParam()({10, 20}));
  const std::size_t none = GetParam()({}).size(), first = bytes_of(GetParam()({10})).size();
  for (std::size_t n = 1; n <= all.size(); n += 1 + all.size() / 200) {
    PictureStream stream("test");
    stream.feed(std::span(all).first(n));
    stream.end();
    auto picture = stream.next();
    while (picture && *picture) picture = stream.next();
    EXPECT_EQ(picture.has_value(), n == none || n == first || n == all.size()) << n;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, Streams, ::testing::Values(&y4m, &pgm, &mjpeg));

TEST(PictureStream, RefusesWhatItDoesNotUnderstand) {
  for (const std::string text :
       {"RIFF....AVI LIST", "YUV4MPEG2 W0 H2\nFRAME\n", "YUV4MPEG2 W3 H2 C420p10\nFRAME\n", "YUV4MPEG2 W99999 H99999\n",
        "YUV4MPEG2 W3 H2\nFRAMX\n........", "P5\n0 4\n255\n........", "P5\n99999 99999\n255\n", "P5 a b c........"}) {
    PictureStream stream("test");
    stream.feed(bytes_of(text));
    const auto picture = stream.next();
    EXPECT_FALSE(picture) << text;
    const auto after = stream.next();
    EXPECT_TRUE(after && !*after) << "over";
  }
}

TEST(VideoSource, PlaysAFileOnceOrAgainAndAgain) {
  const std::string path = ::testing::TempDir() + "pickcell_video_test.y4m";
  ASSERT_TRUE(core::write_file_atomically(path, y4m({10, 20})));
  core::SimulatedClock clock;
  const auto seat = clock.join("test");
  auto once = VideoSource::open(path, {"", 0, false}, clock);
  ASSERT_TRUE(once) << once.error().line();
  for (const int v : {10, 20}) {
    const auto frame = (*once)->grab(*seat, core::duration_s(1));
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->picture->at(2, 1), v);
  }
  const auto end = (*once)->grab(*seat, core::duration_s(1));
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().code, core::ErrorCode::negative);
  auto looped = VideoSource::open(path, {"cam", 4, true}, clock);
  ASSERT_TRUE(looped);
  for (int i = 0; i < 5; ++i) {
    const auto frame = (*looped)->grab(*seat, core::duration_s(1));
    ASSERT_TRUE(frame) << frame.error().line();
    EXPECT_EQ(frame->picture->at(0, 0), i % 2 == 0 ? 10 : 20);
    EXPECT_EQ(frame->sequence, static_cast<std::uint64_t>(i + 1));
  }
  EXPECT_DOUBLE_EQ(core::seconds(clock.now()), 1.0);
  (void)std::remove(path.c_str());
  EXPECT_FALSE(VideoSource::open(path, {}, clock));
}

}  // namespace
}  // namespace pickcell::frames
