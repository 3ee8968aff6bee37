#include "pickcell/image/codec.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <random>
#include <string_view>

#include "pickcell/core/file.hpp"

namespace pickcell::image {
namespace {

using Bytes = std::vector<std::byte>;

void put(Bytes& out, std::string_view text) {
  for (const char c : text) out.push_back(static_cast<std::byte>(c));
}
void put(Bytes& out, std::uint32_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<std::byte>(value >> (8 * i)));
}
Bytes from(std::string_view text) {
  Bytes out;
  put(out, text);
  return out;
}

/// The standard's luma in floating point: independent of the integer formula under test.
int luma(double r, double g, double b) { return static_cast<int>(std::lround(0.299 * r + 0.587 * g + 0.114 * b)); }

std::vector<int> values(const Image& picture) {
  std::vector<int> out;
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) out.push_back(picture.at(x, y));
  return out;
}

/// A PNG as libpng writes it, from big-endian samples.
Bytes png_file(int width, int height, int depth, int type, const std::vector<std::uint8_t>& samples,
               bool interlaced = false, const std::vector<png_color>& palette = {}) {
  Bytes out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &out,
      [](png_structp p, png_bytep data, std::size_t n) {
        auto& to = *static_cast<Bytes*>(png_get_io_ptr(p));
        for (std::size_t i = 0; i < n; ++i) to.push_back(std::byte{data[i]});
      },
      nullptr);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), depth, type,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  if (!palette.empty()) png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  png_write_info(png, info);
  const std::size_t row_bytes = samples.size() / static_cast<std::size_t>(height);
  std::vector<std::uint8_t> copy = samples;
  std::vector<png_bytep> rows;
  for (int y = 0; y < height; ++y) rows.push_back(copy.data() + static_cast<std::size_t>(y) * row_bytes);
  png_write_image(png, rows.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return out;
}

std::vector<int> decoded(const Bytes& bytes) {
  const auto picture = decode_grey(bytes, "t");
  EXPECT_TRUE(picture) << (picture ? "" : picture.error().line());
  return picture ? values(*picture) : std::vector<int>{};
}

Image textured(int width, int height) {
  Image out(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      out.at(x, y) = static_cast<std::uint8_t>(128 + 60 * std::sin(x * 0.2) + 60 * std::cos(y * 0.13));
  return out;
}

TEST(Png, GreyOfEveryDepth) {
  EXPECT_EQ(decoded(png_file(3, 1, 8, PNG_COLOR_TYPE_GRAY, {0, 77, 255})), (std::vector<int>{0, 77, 255}));
  EXPECT_EQ(decoded(png_file(4, 1, 1, PNG_COLOR_TYPE_GRAY, {0b01010000})), (std::vector<int>{0, 255, 0, 255}));
  EXPECT_EQ(decoded(png_file(2, 1, 4, PNG_COLOR_TYPE_GRAY, {0x3f})), (std::vector<int>{51, 255}));
}

TEST(Png, SixteenBitIsScaledAndRounded) {
  const auto got = decoded(png_file(4, 1, 16, PNG_COLOR_TYPE_GRAY, {0, 0, 0x00, 0x81, 0x7f, 0xff, 0xff, 0xff}));
  EXPECT_EQ(got, (std::vector<int>{0, 1, 127, 255}));  // 129/257 = 0.502, 32767/257 = 127.498
}

TEST(Png, ColourBecomesLumaAndAlphaIsIgnored) {
  EXPECT_EQ(decoded(png_file(2, 1, 8, PNG_COLOR_TYPE_RGB, {200, 30, 90, 0, 255, 1})),
            (std::vector<int>{luma(200, 30, 90), luma(0, 255, 1)}));
  EXPECT_EQ(decoded(png_file(2, 1, 8, PNG_COLOR_TYPE_RGBA, {200, 30, 90, 0, 0, 255, 1, 255})),
            (std::vector<int>{luma(200, 30, 90), luma(0, 255, 1)}));
  EXPECT_EQ(decoded(png_file(2, 1, 8, PNG_COLOR_TYPE_GRAY_ALPHA, {9, 0, 200, 255})), (std::vector<int>{9, 200}));
  EXPECT_EQ(decoded(png_file(1, 1, 16, PNG_COLOR_TYPE_RGB, {200, 0, 30, 0, 90, 0})),
            (std::vector<int>{luma(199, 30, 90)}));
  EXPECT_EQ(decoded(png_file(4, 1, 2, PNG_COLOR_TYPE_PALETTE, {0b00011011}, false,
                             {{10, 20, 30}, {255, 0, 0}, {0, 0, 255}, {9, 9, 9}})),
            (std::vector<int>{luma(10, 20, 30), luma(255, 0, 0), luma(0, 0, 255), 9}));
}

TEST(Png, InterlacedReadsLikePlain) {
  std::vector<std::uint8_t> samples(19 * 13);
  std::mt19937 random(1);
  for (auto& s : samples) s = static_cast<std::uint8_t>(random());
  EXPECT_EQ(decoded(png_file(19, 13, 8, PNG_COLOR_TYPE_GRAY, samples, true)),
            decoded(png_file(19, 13, 8, PNG_COLOR_TYPE_GRAY, samples, false)));
}

TEST(Png, SavedPicturesReadBackExactly) {
  const auto path = std::filesystem::path(::testing::TempDir()) / "codec_test.png";
  const Image grey = textured(67, 41);
  ASSERT_TRUE(save_png(path, grey.view().crop(3, 2, 50, 30)));
  const auto back = load_grey(path);
  ASSERT_TRUE(back);
  EXPECT_EQ(values(*back), values(Image(grey.view().crop(3, 2, 50, 30))));
  RgbImage colour(5, 4, {12, 200, 7});
  colour.at(4, 3) = {255, 0, 0};
  ASSERT_TRUE(save_png(path, colour));
  const auto luma_back = load_grey(path);
  ASSERT_TRUE(luma_back);
  EXPECT_EQ(luma_back->at(0, 0), luma(12, 200, 7));
  EXPECT_EQ(luma_back->at(4, 3), luma(255, 0, 0));
  std::filesystem::remove(path);
}

TEST(Png, AFolderThatIsNotThereIsAnErrorNamingTheFile) {
  const auto saved = save_png("/nonexistent-folder/x.png", textured(8, 8).view());
  ASSERT_FALSE(saved);
  EXPECT_EQ(saved.error().what, "/nonexistent-folder/x.png");
}

TEST(Jpeg, EncodedPicturesComeBackNearly) {
  const Image grey = textured(120, 80);
  const auto back = decode_grey(encode_jpeg(grey.view(), 95), "t.jpg");
  ASSERT_TRUE(back);
  ASSERT_EQ(back->width(), 120);
  ASSERT_EQ(back->height(), 80);
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 120; ++x) ASSERT_NEAR(back->at(x, y), grey.at(x, y), 8);
  EXPECT_LT(encode_jpeg(grey.view(), 20).size(), encode_jpeg(grey.view(), 95).size());
  EXPECT_THROW(encode_jpeg(grey.view(), 0), std::invalid_argument);
  EXPECT_THROW(encode_jpeg(ImageView(), 80), std::invalid_argument);
}

/// The bytes of a BMP with a 40-byte header.
Bytes bmp_file(int width, int height, int bits, const std::vector<std::uint32_t>& palette_bgr, const Bytes& pixels,
               std::uint32_t compression = 0, std::uint32_t used = 0) {
  Bytes out = from("BM");
  const auto offset = static_cast<std::uint32_t>(54 + 4 * palette_bgr.size());
  for (const std::uint32_t v : {offset + static_cast<std::uint32_t>(pixels.size()), 0u, offset, 40u}) put(out, v, 4);
  put(out, static_cast<std::uint32_t>(width), 4);
  put(out, static_cast<std::uint32_t>(height), 4);
  put(out, 1, 2);
  put(out, static_cast<std::uint32_t>(bits), 2);
  for (const std::uint32_t v : {compression, 0u, 2835u, 2835u, used, 0u}) put(out, v, 4);
  for (const std::uint32_t colour : palette_bgr) put(out, colour, 4);
  out.insert(out.end(), pixels.begin(), pixels.end());
  return out;
}

Bytes raw(std::initializer_list<int> v) {
  Bytes out;
  for (const int i : v) out.push_back(static_cast<std::byte>(i));
  return out;
}

TEST(Bmp, EveryUncompressedDepthBottomUpAndTopDown) {
  EXPECT_EQ(decoded(bmp_file(2, 2, 24, {}, raw({1, 2, 3, 10, 20, 30, 0, 0, 9, 9, 9, 5, 5, 5, 0, 0}))),
            (std::vector<int>{9, 5, luma(3, 2, 1), luma(30, 20, 10)}));
  EXPECT_EQ(decoded(bmp_file(2, -2, 24, {}, raw({1, 2, 3, 10, 20, 30, 0, 0, 9, 9, 9, 5, 5, 5, 0, 0}))),
            (std::vector<int>{luma(3, 2, 1), luma(30, 20, 10), 9, 5}));
  EXPECT_EQ(decoded(bmp_file(1, 1, 32, {}, raw({100, 150, 200, 255}))), (std::vector<int>{luma(200, 150, 100)}));
  std::vector<std::uint32_t> palette(256);
  for (std::uint32_t i = 0; i < 256; ++i) palette[i] = (255 - i) * 0x010101u;
  EXPECT_EQ(decoded(bmp_file(3, 1, 8, palette, raw({0, 1, 255, 0}))), (std::vector<int>{255, 254, 0}));
  EXPECT_EQ(decoded(bmp_file(3, 1, 4, {0x000000, 0x0000ff, 0xff0000}, raw({0x12, 0x00, 0, 0}), 0, 3)),
            (std::vector<int>{luma(0, 0, 255), luma(255, 0, 0), 0}));  // 0xRRGGBB
  EXPECT_EQ(decoded(bmp_file(9, 1, 1, {0x000000, 0xffffff}, raw({0b10110000, 0b10000000, 0, 0}))),
            (std::vector<int>{255, 0, 255, 255, 0, 0, 0, 0, 255}));
}

TEST(Bmp, WhatWeDoNotReadIsSaidSo) {
  const auto compressed =
      decode_grey(bmp_file(4, 1, 8, std::vector<std::uint32_t>(256), raw({4, 0, 0, 1}), 1), "rle.bmp");
  ASSERT_FALSE(compressed);
  EXPECT_NE(compressed.error().why.find("compressed"), std::string::npos);
  EXPECT_FALSE(decode_grey(bmp_file(1, 1, 16, {}, raw({0, 0, 0, 0})), "b.bmp"));
  EXPECT_FALSE(decode_grey(bmp_file(0, 1, 8, std::vector<std::uint32_t>(256), {}), "b.bmp"));
  EXPECT_FALSE(decode_grey(bmp_file(1, INT32_MIN, 8, std::vector<std::uint32_t>(256), {}), "b.bmp"));
}

TEST(Pnm, GreyColourCommentsAndSixteenBit) {
  EXPECT_EQ(decoded(from("P5\n# made by hand\n2 2 #x\n255\n\x01\x02\x03\x04")), (std::vector<int>{1, 2, 3, 4}));
  EXPECT_EQ(decoded(from("P6 1 1 255 abc")), (std::vector<int>{luma('a', 'b', 'c')}));
  EXPECT_EQ(decoded(from(std::string_view("P5 2 1 65535 \xff\xff\x00\x81", 17))), (std::vector<int>{255, 1}));
  EXPECT_EQ(decoded(from(std::string_view("P5 3 1 15 \x00\x0f\x07", 13))), (std::vector<int>{0, 255, 119}));
  EXPECT_FALSE(decode_grey(from("P5 2 2 255 abc"), "t"));
  EXPECT_FALSE(decode_grey(from("P5 2 2 0 abcd"), "t"));
  EXPECT_FALSE(decode_grey(from("P5 99999999999 2 255 abcd"), "t"));
}

TEST(Codec, ErrorsNameTheFile) {
  const auto missing = load_grey("/nonexistent/picture.png");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().what, "/nonexistent/picture.png");
  const auto text = decode_grey(from("hello"), "notes.txt");
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().line(), "notes.txt: not a PNG, JPEG, BMP or binary PGM/PPM picture; convert it to PNG");
  EXPECT_FALSE(decode_grey({}, "empty.png"));
}

TEST(Codec, HugePicturesAreRefusedBeforeMemoryIsTaken) {
  for (const std::string_view header : {"P5 40000 10 255 ", "P5 32768 32768 255 "}) {
    const auto huge = decode_grey(from(header), "huge");
    ASSERT_FALSE(huge);
    EXPECT_NE(huge.error().why.find("too large"), std::string::npos) << huge.error().line();
  }
  Bytes png = png_file(8, 8, 8, PNG_COLOR_TYPE_GRAY, std::vector<std::uint8_t>(64, 9));
  png[18] = std::byte{0x3f};  // width 0x3f08; the checksum of the header no longer fits, libpng says so
  EXPECT_FALSE(decode_grey(png, "huge.png"));
}

std::vector<Bytes> one_of_each() {
  const Image grey = textured(40, 30);
  std::vector<std::uint8_t> samples;
  for (const int v : values(grey)) samples.push_back(static_cast<std::uint8_t>(v));
  Bytes pgm = from("P5 40 30 255 "), pixels;
  for (const std::uint8_t v : samples) pixels.push_back(std::byte{v});
  pgm.insert(pgm.end(), pixels.begin(), pixels.end());
  return {png_file(40, 30, 8, PNG_COLOR_TYPE_GRAY, samples), png_file(40, 30, 8, PNG_COLOR_TYPE_GRAY, samples, true),
          encode_jpeg(grey.view(), 80), bmp_file(40, 30, 8, std::vector<std::uint32_t>(256), pixels), pgm};
}

TEST(Codec, EveryTruncationOfEveryFormatIsRefused) {
  for (const Bytes& whole : one_of_each()) {
    ASSERT_TRUE(decode_grey(whole, "whole"));
    for (std::size_t n = 0; n < whole.size(); ++n) {
      const auto cut = decode_grey(std::span(whole).first(n), "cut.img");
      ASSERT_FALSE(cut) << n << " of " << whole.size();
      ASSERT_EQ(cut.error().what, "cut.img");
    }
  }
}

TEST(Codec, DamagedBytesNeverBreakTheReader) {
  std::mt19937 random(3);
  for (const Bytes& whole : one_of_each())
    for (int round = 0; round < 300; ++round) {
      Bytes damaged = whole;
      for (unsigned k = 0; k <= random() % 4; ++k)
        damaged[random() % std::min<std::size_t>(damaged.size(), round % 2 ? 64 : damaged.size())] =
            static_cast<std::byte>(random());
      const auto picture = decode_grey(damaged, "damaged");
      EXPECT_TRUE(!picture || !picture->empty());
    }
}

}  // namespace
}  // namespace pickcell::image
