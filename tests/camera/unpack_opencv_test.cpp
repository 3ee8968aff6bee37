/// Pixel unpacking against OpenCV on random pictures.

#include <gtest/gtest.h>

#include <cstdlib>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "pickcell/frames/pixel_format.hpp"
#include "pickcell/frames/unpack.hpp"

namespace pickcell {
namespace {

std::mt19937& random_bits() {
  static std::mt19937 random(99);
  return random;
}

cv::Mat noise(int w, int h, int type, double max) {
  cv::Mat out(h, w, type);
  cv::RNG rng(random_bits()());
  rng.fill(out, cv::RNG::UNIFORM, 0, max);
  return out;
}

image::Image unpacked(const cv::Mat& raw, const char* format, int w, int h) {
  image::Image out;
  const auto* bytes = reinterpret_cast<const std::byte*>(raw.data);
  const auto done =
      frames::unpack({{bytes, raw.total() * raw.elemSize()}, frames::pixel_format(format)->code, w, h, 0}, out);
  EXPECT_TRUE(done) << format;
  return out;
}

/// The largest difference in grey values.
int difference(const image::Image& ours, const cv::Mat& theirs) {
  int worst = 0;
  for (int y = 0; y < ours.height(); ++y)
    for (int x = 0; x < ours.width(); ++x)
      worst = std::max(worst, std::abs(ours.at(x, y) - theirs.at<std::uint8_t>(y, x)));
  return worst;
}

int size(int least) { return std::uniform_int_distribution<int>(least, 90)(random_bits()); }

TEST(UnpackOpenCv, WideGreyIsScaledAndRounded) {
  const struct {
    const char* name;
    int max;
  } formats[] = {{"Mono10", 1023}, {"Mono12", 4095}, {"Mono14", 16383}, {"Mono16", 65535}};
  for (const auto& format : formats)
    for (int i = 0; i < 20; ++i) {
      const int w = size(1), h = size(1);
      const cv::Mat raw = noise(w, h, CV_16UC1, format.max + 1);
      cv::Mat grey;
      raw.convertTo(grey, CV_8U, 255.0 / format.max);
      EXPECT_EQ(difference(unpacked(raw, format.name, w, h), grey), 0) << format.name << " " << w << "x" << h;
    }
}

TEST(UnpackOpenCv, ColourIsTheSameLuma) {
  for (int i = 0; i < 20; ++i) {
    const int w = size(1), h = size(1);
    cv::Mat grey;
    const cv::Mat rgb = noise(w, h, CV_8UC3, 256);
    cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
    EXPECT_LE(difference(unpacked(rgb, "RGB8", w, h), grey), 1);
    cv::cvtColor(rgb, grey, cv::COLOR_BGR2GRAY);
    EXPECT_LE(difference(unpacked(rgb, "BGR8", w, h), grey), 1);
    const cv::Mat bgra = noise(w, h, CV_8UC4, 256);
    cv::cvtColor(bgra, grey, cv::COLOR_BGRA2GRAY);
    EXPECT_LE(difference(unpacked(bgra, "BGRa8", w, h), grey), 1);
    const int even = w + w % 2;
    const cv::Mat yuyv = noise(even, h, CV_8UC2, 256);
    cv::cvtColor(yuyv, grey, cv::COLOR_YUV2GRAY_YUY2);
    EXPECT_EQ(difference(unpacked(yuyv, "YUV422_8", even, h), grey), 0);
    cv::cvtColor(yuyv, grey, cv::COLOR_YUV2GRAY_UYVY);
    EXPECT_EQ(difference(unpacked(yuyv, "YUV422_8_UYVY", even, h), grey), 0);
  }
}

/// OpenCV names a mosaic by the pixels one further right and down, and knows no edge: it gets one mirrored around,
/// which keeps the mosaic in step, and the edge is cut off again.
TEST(UnpackOpenCv, MosaicsAreInterpolatedTheSameToTheEdge) {
  const struct {
    const char* name;
    int code;
  } mosaics[] = {{"BayerRG8", cv::COLOR_BayerBG2RGB},
                 {"BayerGR8", cv::COLOR_BayerGB2RGB},
                 {"BayerGB8", cv::COLOR_BayerGR2RGB},
                 {"BayerBG8", cv::COLOR_BayerRG2RGB}};
  for (const auto& mosaic : mosaics)
    for (int i = 0; i < 15; ++i) {
      const int w = size(3), h = size(3);
      const cv::Mat raw = noise(w, h, CV_8UC1, 256);
      cv::Mat framed, rgb, grey;
      cv::copyMakeBorder(raw, framed, 2, 2, 2, 2, cv::BORDER_REFLECT_101);
      cv::cvtColor(framed, rgb, mosaic.code);
      cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
      const cv::Mat inside = grey(cv::Rect(2, 2, w, h));
      EXPECT_LE(difference(unpacked(raw, mosaic.name, w, h), inside), 1) << mosaic.name << " " << w << "x" << h;
    }
}

/// A part of a larger picture: rows with foreign bytes between them, which must not be seen.
image::Image unpacked_part(const cv::Mat& part, const char* format) {
  image::Image out;
  const std::size_t row = static_cast<std::size_t>(part.cols) * part.elemSize();
  const std::size_t bytes = static_cast<std::size_t>(part.rows - 1) * part.step + row;
  const auto done = frames::unpack({{reinterpret_cast<const std::byte*>(part.data), bytes},
                                    frames::pixel_format(format)->code,
                                    part.cols,
                                    part.rows,
                                    part.step},
                                   out);
  EXPECT_TRUE(done) << format;
  return out;
}

TEST(UnpackOpenCv, RowsWithBytesBetweenThem) {
  for (int i = 0; i < 25; ++i) {
    const int w = size(3), h = size(3);
    const cv::Rect inside(static_cast<int>(random_bits()() % 7), static_cast<int>(random_bits()() % 5), w, h);
    cv::Mat grey;
    const cv::Mat mono = noise(w + 11, h + 9, CV_8UC1, 256)(inside);
    EXPECT_EQ(difference(unpacked_part(mono, "Mono8"), mono), 0);
    const cv::Mat wide = noise(w + 11, h + 9, CV_16UC1, 4096)(inside);
    wide.convertTo(grey, CV_8U, 255.0 / 4095);
    EXPECT_EQ(difference(unpacked_part(wide, "Mono12"), grey), 0);
    const cv::Mat rgb = noise(w + 11, h + 9, CV_8UC3, 256)(inside);
    cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
    EXPECT_LE(difference(unpacked_part(rgb, "RGB8"), grey), 1);
    // A wide mosaic is the mosaic of its 8-bit picture.
    cv::Mat eight;
    wide.convertTo(eight, CV_8U, 255.0 / 4095);
    cv::Mat framed, colour;
    cv::copyMakeBorder(eight, framed, 2, 2, 2, 2, cv::BORDER_REFLECT_101);
    cv::cvtColor(framed, colour, cv::COLOR_BayerBG2RGB);
    cv::cvtColor(colour, grey, cv::COLOR_RGB2GRAY);
    EXPECT_LE(difference(unpacked_part(wide, "BayerRG12"), grey(cv::Rect(2, 2, w, h))), 1) << w << "x" << h;
  }
}

}  // namespace
}  // namespace pickcell
