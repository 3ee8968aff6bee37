#pragma once
/// What Video4Linux answers to ioctls, read from its bytes (structures of <linux/videodev2.h> of this machine). Nothing
/// is believed: sizes first, texts end where their field ends.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace pickcell::frames::v4l2 {

/// "GREY", "YUYV"; bytes that do not print are replaced.
[[nodiscard]] std::string fourcc_name(std::uint32_t fourcc);
/// The format by its PFNC code (kJpeg for compressed ones); empty for those that are not understood.
[[nodiscard]] std::optional<std::uint32_t> pfnc_of(std::uint32_t fourcc);
/// Which of two understood formats is the better one to ask for: grey before YUV before mosaics before JPEG. Lower is
/// better.
[[nodiscard]] int preference(std::uint32_t fourcc);

struct Capability {
  std::string driver, card, bus;
  bool captures = false, streams = false;
};
/// VIDIOC_QUERYCAP: v4l2_capability.
[[nodiscard]] std::optional<Capability> parse_capability(std::span<const std::byte> bytes);

struct FormatName {
  std::uint32_t fourcc = 0;
  std::string description;
};
/// VIDIOC_ENUM_FMT: v4l2_fmtdesc.
[[nodiscard]] std::optional<FormatName> parse_format_name(std::span<const std::byte> bytes);

struct Layout {
  std::uint32_t fourcc = 0;
  int width_px = 0, height_px = 0;
  std::size_t stride_bytes = 0;  ///< 0: none told, as for JPEG
  std::size_t image_bytes = 0;
};
/// VIDIOC_G_FMT: v4l2_format of a single-plane capture. Empty for sizes that no picture has.
[[nodiscard]] std::optional<Layout> parse_layout(std::span<const std::byte> bytes);

struct Control {
  std::uint32_t id = 0;
  std::string name;  ///< as the driver calls it: "Exposure Time, Absolute"
  std::string key;   ///< the same for the shell: "exposure_time_absolute"
  bool is_number = false, is_boolean = false, is_menu = false, is_button = false;
  bool usable = false;  ///< neither disabled nor read only
  std::int64_t least = 0, most = 0, step = 1, otherwise = 0;
};
/// VIDIOC_QUERYCTRL: v4l2_queryctrl.
[[nodiscard]] std::optional<Control> parse_control(std::span<const std::byte> bytes);

struct Filled {
  std::uint32_t index = 0, sequence = 0;
  std::size_t bytes = 0;
  std::int64_t time_ns = 0;
  bool damaged = false;    ///< the driver lost a part
  bool monotonic = false;  ///< time_ns is CLOCK_MONOTONIC
};
/// VIDIOC_DQBUF: v4l2_buffer.
[[nodiscard]] std::optional<Filled> parse_filled(std::span<const std::byte> bytes);

}  // namespace pickcell::frames::v4l2
