/// Answers as drivers give them, laid out byte by byte by hand from the kernel's documentation: no struct of ours reads
/// what a struct of ours wrote. 64-bit machines.

#include "pickcell/frames/v4l2_data.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "pickcell/frames/pixel_format.hpp"

namespace pickcell::frames::v4l2 {
namespace {

/// Little endian bytes at given places of a structure.
class Bytes {
 public:
  explicit Bytes(std::size_t size) : bytes_(size) {}
  Bytes& u32(std::size_t at, std::uint32_t v) {
    std::memcpy(bytes_.data() + at, &v, 4);
    return *this;
  }
  Bytes& u64(std::size_t at, std::uint64_t v) {
    std::memcpy(bytes_.data() + at, &v, 8);
    return *this;
  }
  Bytes& text(std::size_t at, const std::string& t) {
    std::memcpy(bytes_.data() + at, t.data(), t.size());
    return *this;
  }
  [[nodiscard]] std::span<const std::byte> all() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

constexpr std::uint32_t kYuyvCode = 0x56595559, kMjpg = 0x47504a4d, kGrey = 0x59455247;

template <class Parse>
void refuses_everything_shorter(std::span<const std::byte> bytes, Parse parse) {
  EXPECT_TRUE(parse(bytes));
  for (std::size_t n = 0; n < bytes.size(); ++n) ASSERT_FALSE(parse(bytes.first(n))) << n;
}

TEST(V4l2Data, ACapabilityOfAUvcCamera) {
  // driver 16, card 32, bus 32, version, capabilities, device_caps, reserved 3 * 4
  const auto bytes = Bytes(104)
                         .text(0, "uvcvideo")
                         .text(16, "HD Pro Webcam C920")
                         .text(48, "usb-0000:00:14.0-2")
                         .u32(84, 0x84a00001)
                         .u32(88, 0x04200001);
  const auto c = parse_capability(bytes.all());
  ASSERT_TRUE(c);
  EXPECT_EQ(c->driver, "uvcvideo");
  EXPECT_EQ(c->card, "HD Pro Webcam C920");
  EXPECT_EQ(c->bus, "usb-0000:00:14.0-2");
  EXPECT_TRUE(c->captures);
  EXPECT_TRUE(c->streams);
  // Its second node carries metadata: the whole device captures, this node does not.
  const auto metadata = Bytes(104).u32(84, 0x84a00001).u32(88, 0x04a00000);
  EXPECT_FALSE(parse_capability(metadata.all())->captures);
  refuses_everything_shorter(bytes.all(), [](auto b) { return parse_capability(b).has_value(); });
}

TEST(V4l2Data, FormatsAndTheirOrder) {
  // index, type, flags, description 32, pixelformat, mbus_code, reserved 3 * 4
  const auto bytes = Bytes(64).u32(4, 1).u32(8, 1).text(12, "Motion-JPEG").u32(44, kMjpg);
  const auto f = parse_format_name(bytes.all());
  ASSERT_TRUE(f);
  EXPECT_EQ(fourcc_name(f->fourcc), "MJPG");
  EXPECT_EQ(f->description, "Motion-JPEG");
  EXPECT_EQ(pfnc_of(kMjpg), kJpeg);
  EXPECT_EQ(pfnc_of(kYuyvCode), kYuyv);
  EXPECT_EQ(pfnc_of(0x34363248), std::nullopt) << "H264";
  EXPECT_LT(preference(kGrey), preference(kYuyvCode));
  EXPECT_LT(preference(kYuyvCode), preference(kMjpg));
  EXPECT_EQ(fourcc_name(0x20303159), "Y10");
  EXPECT_EQ(fourcc_name(0x01020304), "????");
  refuses_everything_shorter(bytes.all(), [](auto b) { return parse_format_name(b).has_value(); });
}

TEST(V4l2Data, ALayoutAndSizesThatNoPictureHas) {
  // type, padding, then v4l2_pix_format: width, height, pixelformat, field, bytesperline, sizeimage
  const auto layout = [](std::uint32_t w, std::uint32_t h, std::uint32_t type = 1) {
    return Bytes(208).u32(0, type).u32(8, w).u32(12, h).u32(16, kYuyvCode).u32(20, 1).u32(24, 1280).u32(28, 614400);
  };
  const auto l = parse_layout(layout(640, 480).all());
  ASSERT_TRUE(l);
  EXPECT_EQ(l->width_px, 640);
  EXPECT_EQ(l->height_px, 480);
  EXPECT_EQ(l->stride_bytes, 1280u);
  EXPECT_EQ(l->image_bytes, 614400u);
  EXPECT_FALSE(parse_layout(layout(0, 480).all()));
  EXPECT_FALSE(parse_layout(layout(640, 0xffffffff).all()));
  EXPECT_FALSE(parse_layout(layout(640, 480, 9).all())) << "a multi-plane format";
  const auto whole = layout(640, 480);
  refuses_everything_shorter(whole.all(), [](auto b) { return parse_layout(b).has_value(); });
}

TEST(V4l2Data, AControlAndItsName) {
  // id, type, name 32, minimum, maximum, step, default, flags, reserved 2 * 4
  const auto bytes = Bytes(68)
                         .u32(0, 0x009a0902)
                         .u32(4, 1)
                         .text(8, "Exposure Time, Absolute")
                         .u32(40, 3)
                         .u32(44, 2047)
                         .u32(48, 1)
                         .u32(52, 250);
  const auto c = parse_control(bytes.all());
  ASSERT_TRUE(c);
  EXPECT_EQ(c->key, "exposure_time_absolute");
  EXPECT_TRUE(c->is_number);
  EXPECT_TRUE(c->usable);
  EXPECT_EQ(c->least, 3);
  EXPECT_EQ(c->most, 2047);
  EXPECT_EQ(c->otherwise, 250);
  const auto disabled = Bytes(68).u32(4, 2).text(8, "White Balance, Automatic").u32(56, 1);
  EXPECT_FALSE(parse_control(disabled.all())->usable);
  EXPECT_TRUE(parse_control(disabled.all())->is_boolean);
  refuses_everything_shorter(bytes.all(), [](auto b) { return parse_control(b).has_value(); });
}

TEST(V4l2Data, AFilledBuffer) {
  // index, type, bytesused, flags, field, padding, timeval 16, timecode 16, sequence, memory, m 8, length, ...
  const auto filled = [](std::uint32_t flags, std::uint64_t s = 1234, std::uint64_t us = 567890) {
    return Bytes(88).u32(0, 3).u32(4, 1).u32(8, 614400).u32(12, flags).u64(24, s).u64(32, us).u32(56, 42).u32(60, 1);
  };
  const auto f = parse_filled(filled(0x2001).all());
  ASSERT_TRUE(f);
  EXPECT_EQ(f->index, 3u);
  EXPECT_EQ(f->sequence, 42u);
  EXPECT_EQ(f->bytes, 614400u);
  EXPECT_EQ(f->time_ns, 1'234'567'890'000);
  EXPECT_TRUE(f->monotonic);
  EXPECT_FALSE(f->damaged);
  EXPECT_TRUE(parse_filled(filled(0x2041).all())->damaged);
  EXPECT_FALSE(parse_filled(filled(0x0001).all())->monotonic);
  EXPECT_EQ(parse_filled(filled(0x2001, ~0ULL).all())->time_ns, 0);
  EXPECT_EQ(parse_filled(filled(0x2001, 1, 1'000'000).all())->time_ns, 0);
  const auto whole = filled(0x2001);
  refuses_everything_shorter(whole.all(), [](auto b) { return parse_filled(b).has_value(); });
}

}  // namespace
}  // namespace pickcell::frames::v4l2
