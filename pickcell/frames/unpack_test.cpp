#include "pickcell/frames/unpack.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "pickcell/frames/pixel_format.hpp"
#include "pickcell/image/codec.hpp"

namespace pickcell::frames {
namespace {

using Samples = std::vector<std::uint32_t>;

/// Packs samples the slow way, bit by bit, as the format's description says.
std::vector<std::byte> packed(const Samples& samples, const PixelFormat& format) {
  std::vector<std::byte> out((samples.size() * 16 + 7) / 8 + 3);
  const auto set_bit = [&](std::size_t bit, bool on) {
    if (on) out[bit / 8] |= static_cast<std::byte>(1U << bit % 8);
  };
  const int bits = format.sample_bits;
  std::size_t end = 0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (int b = 0; b < bits; ++b) {
      const bool on = (samples[i] >> b & 1U) != 0;
      const auto bit = static_cast<std::size_t>(b);
      std::size_t at = 0;
      if (format.packing == Packing::whole) {
        at = i * (bits > 8 ? 16 : 8) + bit;
      } else if (format.packing == Packing::lsb) {
        at = i * static_cast<std::size_t>(bits) + bit;
      } else {  // two pixels in three bytes: high, low bits of both, high
        const auto low = static_cast<std::size_t>(bits - 8);
        const std::size_t byte = i / 2 * 3;
        at = bit >= low ? (byte + (i % 2 == 0 ? 0 : 2)) * 8 + bit - low : (byte + 1) * 8 + (i % 2) * 4 + bit;
      }
      set_bit(at, on);
      end = std::max(end, at / 8 + 1);
    }
  if (format.packing == Packing::whole) end = samples.size() * (bits > 8 ? 2 : 1);
  if (format.packing == Packing::lsb) end = (samples.size() * static_cast<std::size_t>(bits) + 7) / 8;
  if (format.packing == Packing::gige) end = samples.size() / 2 * 3 + samples.size() % 2 * 2;
  out.resize(end);
  return out;
}

class Unpack : public ::testing::TestWithParam<const char*> {
 protected:
  std::mt19937 random_{20251125};
  int size() { return std::uniform_int_distribution<int>(1, 37)(random_); }
  Samples samples(int n, std::uint32_t max) {
    std::uniform_int_distribution<std::uint32_t> value(0, max);
    Samples out(static_cast<std::size_t>(n));
    for (auto& s : out) s = value(random_);
    return out;
  }
};

TEST_P(Unpack, GreyIsTheNearestOf256StepsForAnySize) {
  const PixelFormat* format = pixel_format(GetParam());
  ASSERT_NE(format, nullptr);
  const std::uint32_t max = (1U << format->sample_bits) - 1;
  for (int round = 0; round < 40; ++round) {
    const int w = size(), h = size();
    const Samples values = samples(w * h, max);
    const auto bytes = packed(values, *format);
    RawPicture raw{bytes, format->code, w, h, 0};
    EXPECT_EQ(bytes_needed(raw), bytes.size());
    image::Image out;
    ASSERT_TRUE(unpack(raw, out));
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const double exact = 255.0 * values[static_cast<std::size_t>(y * w + x)] / max;
        ASSERT_NEAR(out.at(x, y), exact, 0.5 + 1e-9) << x << "," << y << " of " << w << "x" << h;
      }
    raw.bytes = raw.bytes.first(bytes.size() - 1);
    EXPECT_FALSE(unpack(raw, out)) << "a byte too few";
  }
}

TEST_P(Unpack, RowsMayBePadded) {
  const PixelFormat* format = pixel_format(GetParam());
  const std::uint32_t max = (1U << format->sample_bits) - 1;
  for (int round = 0; round < 10; ++round) {
    const int w = size(), h = size();
    const std::size_t stride = packed(samples(w, 0), *format).size() + static_cast<std::size_t>(round);
    std::vector<std::byte> bytes;
    std::vector<Samples> rows;
    for (int y = 0; y < h; ++y) {
      rows.push_back(samples(w, max));
      auto row = packed(rows.back(), *format);
      row.resize(stride, std::byte{0xee});
      bytes.insert(bytes.end(), row.begin(), row.end());
    }
    image::Image out;
    ASSERT_TRUE(unpack({bytes, format->code, w, h, stride}, out));
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        ASSERT_NEAR(out.at(x, y), 255.0 * rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] / max,
                    0.5 + 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, Unpack,
                         ::testing::Values("Mono8", "Mono10", "Mono12", "Mono14", "Mono16", "Mono10p", "Mono12p",
                                           "Mono10Packed", "Mono12Packed"));

TEST(UnpackColour, ConstantColourIsItsLumaInEveryMosaic) {
  // Red 200, green 100, blue 50: BT.601 luma 0.299 * 200 + 0.587 * 100 + 0.114 * 50 = 124.2.
  const struct {
    const char* name;
    int first[4];  // of the two by two block
  } mosaics[] = {{"BayerRG8", {200, 100, 100, 50}},
                 {"BayerGR8", {100, 200, 50, 100}},
                 {"BayerGB8", {100, 50, 200, 100}},
                 {"BayerBG8", {50, 100, 100, 200}}};
  for (const auto& m : mosaics)
    for (const auto& [w, h] : {std::pair{2, 2}, std::pair{7, 5}, std::pair{8, 3}}) {
      std::vector<std::byte> bytes;
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) bytes.push_back(static_cast<std::byte>(m.first[y % 2 * 2 + x % 2]));
      image::Image out;
      ASSERT_TRUE(unpack({bytes, pixel_format(m.name)->code, w, h, 0}, out));
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) EXPECT_EQ(out.at(x, y), 124) << m.name << " " << x << "," << y;
    }
  const std::byte rgb[] = {std::byte{200}, std::byte{100}, std::byte{50}};
  image::Image out;
  ASSERT_TRUE(unpack({rgb, kRgb8, 1, 1, 0}, out));
  EXPECT_EQ(out.at(0, 0), 124);
  const std::byte yuyv[] = {std::byte{11}, std::byte{200}, std::byte{22}, std::byte{30}};
  ASSERT_TRUE(unpack({yuyv, kYuyv, 2, 1, 0}, out));
  EXPECT_EQ(out.at(0, 0), 11);
  EXPECT_EQ(out.at(1, 0), 22);
  ASSERT_TRUE(unpack({yuyv, kUyvy, 2, 1, 0}, out));
  EXPECT_EQ(out.at(0, 0), 200);
}

TEST(UnpackColour, JpegFramesAreDecodedAndDamagedOnesRefused) {
  image::Image picture(48, 32);
  picture.fill(90);
  const auto jpeg = image::encode_jpeg(picture.view(), 90);
  image::Image out;
  ASSERT_TRUE(unpack({jpeg, kJpeg, 48, 32, 0}, out));
  EXPECT_NEAR(out.at(20, 20), 90, 1);
  EXPECT_FALSE(unpack({jpeg, kJpeg, 48, 31, 0}, out)) << "another size than announced";
  EXPECT_FALSE(unpack({std::span(jpeg).first(jpeg.size() / 2), kJpeg, 48, 32, 0}, out));
}

TEST(UnpackColour, NonsenseIsRefusedBeforeAnythingIsRead) {
  const std::byte few[4] = {};
  image::Image out;
  for (const RawPicture raw :
       {RawPicture{few, 0x12345678, 2, 2, 0}, RawPicture{few, kMono8, 0, 2, 0}, RawPicture{few, kMono8, 2, -1, 0},
        RawPicture{few, kMono8, 1 << 30, 1 << 30, 0}, RawPicture{few, kMono8, 4, 1, 3}, RawPicture{{}, kJpeg, 2, 2, 0},
        RawPicture{few, kMono8, 2, 3, 0}, RawPicture{few, kMono8, 2, 2, 3}}) {
    const auto done = unpack(raw, out);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, core::ErrorCode::device);
  }
}

image::Image texture(int w, int h, unsigned seed) {
  std::mt19937 random(seed);
  image::Image out(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      out.at(x, y) = static_cast<std::uint8_t>(x * 5 + y * 3 + static_cast<int>(random() % 30));
  return out;
}

TEST(UnpackJpeg, NothingOfADamagedFrameIsInTheNext) {
  std::mt19937 random(11);
  Unpacker unpacker;
  image::Image got;
  for (int i = 0; i < 60; ++i) {
    const int w = 1 + static_cast<int>(random() % 80), h = 1 + static_cast<int>(random() % 60);
    const std::vector<std::byte> good = image::encode_jpeg(texture(w, h, static_cast<unsigned>(i)).view(), 40 + i);
    std::vector<std::byte> bad = good;
    if (i % 2 == 0)
      bad.resize(random() % bad.size());
    else
      for (int n = 0; n < 4; ++n) bad[random() % bad.size()] ^= static_cast<std::byte>(1 + random() % 255);
    // Its luck: damage in the pixels alone still decodes.
    (void)unpacker.unpack({bad, kJpeg, w, h, 0}, got);
    const auto done = unpacker.unpack({good, kJpeg, w, h, 0}, got);
    ASSERT_TRUE(done) << done.error().line();
    const auto fresh = image::decode_grey(good, "fresh");
    ASSERT_TRUE(fresh);
    for (int y = 0; y < h; ++y)
      ASSERT_TRUE(std::equal(got.row(y), got.row(y) + w, fresh->row(y))) << i << ": " << w << "x" << h << " row " << y;
  }
}

TEST(UnpackJpeg, AnotherSizeThanAnnouncedIsRefusedBeforeItIsDecoded) {
  const std::vector<std::byte> bytes = image::encode_jpeg(texture(64, 48, 1).view(), 90);
  image::Image out;
  const auto refused = unpack({bytes, kJpeg, 48, 64, 0}, out);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().line().find("64x48 instead of 48x64"), std::string::npos) << refused.error().line();
  EXPECT_TRUE(out.empty());
}

}  // namespace
}  // namespace pickcell::frames
