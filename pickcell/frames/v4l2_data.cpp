#include "pickcell/frames/v4l2_data.hpp"

#include <linux/videodev2.h>

#include <algorithm>
#include <cctype>
#include <cstring>

#include "pickcell/frames/pixel_format.hpp"
#include "pickcell/image/codec.hpp"

namespace pickcell::frames::v4l2 {

namespace {

template <class T>
std::optional<T> structure(std::span<const std::byte> bytes) {
  if (bytes.size() < sizeof(T)) return std::nullopt;
  T out;
  std::memcpy(&out, bytes.data(), sizeof out);
  return out;
}

template <std::size_t N>
std::string text(const unsigned char (&field)[N]) {
  std::string out;
  for (std::size_t i = 0; i < N && field[i] != 0; ++i)
    out += field[i] < 0x20 || field[i] > 0x7e ? '?' : static_cast<char>(field[i]);
  return out;
}

/// "Exposure Time, Absolute" -> "exposure_time_absolute"
std::string key_of(const std::string& name) {
  std::string out;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (!out.empty() && out.back() != '_')
      out += '_';
  }
  while (!out.empty() && out.back() == '_') out.pop_back();
  return out;
}

struct Known {
  std::uint32_t fourcc, pfnc;
};
/// Best first.
constexpr Known kKnown[] = {
    {V4L2_PIX_FMT_GREY, kMono8},       {V4L2_PIX_FMT_Y10, kMono10},       {V4L2_PIX_FMT_Y12, kMono12},
    {V4L2_PIX_FMT_Y16, kMono16},       {V4L2_PIX_FMT_YUYV, kYuyv},        {V4L2_PIX_FMT_UYVY, kUyvy},
    {V4L2_PIX_FMT_RGB24, kRgb8},       {V4L2_PIX_FMT_BGR24, kBgr8},       {V4L2_PIX_FMT_SGRBG8, 0x01080008},
    {V4L2_PIX_FMT_SRGGB8, 0x01080009}, {V4L2_PIX_FMT_SGBRG8, 0x0108000a}, {V4L2_PIX_FMT_SBGGR8, 0x0108000b},
    {V4L2_PIX_FMT_MJPEG, kJpeg},       {V4L2_PIX_FMT_JPEG, kJpeg},
};

}  // namespace

std::string fourcc_name(std::uint32_t fourcc) {
  std::string out;
  for (int i = 0; i < 4; ++i) {
    const auto c = static_cast<unsigned char>(fourcc >> 8 * i);
    out += c < 0x20 || c > 0x7e ? '?' : static_cast<char>(c);
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

std::optional<std::uint32_t> pfnc_of(std::uint32_t fourcc) {
  for (const Known& k : kKnown)
    if (k.fourcc == fourcc) return k.pfnc;
  return std::nullopt;
}

int preference(std::uint32_t fourcc) {
  const auto* at =
      std::find_if(std::begin(kKnown), std::end(kKnown), [&](const Known& k) { return k.fourcc == fourcc; });
  return static_cast<int>(at - std::begin(kKnown));
}

std::optional<Capability> parse_capability(std::span<const std::byte> bytes) {
  const auto c = structure<v4l2_capability>(bytes);
  if (!c) return std::nullopt;
  const std::uint32_t caps = (c->capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? c->device_caps : c->capabilities;
  return Capability{text(c->driver), text(c->card), text(c->bus_info), (caps & V4L2_CAP_VIDEO_CAPTURE) != 0,
                    (caps & V4L2_CAP_STREAMING) != 0};
}

std::optional<FormatName> parse_format_name(std::span<const std::byte> bytes) {
  const auto f = structure<v4l2_fmtdesc>(bytes);
  if (!f) return std::nullopt;
  return FormatName{f->pixelformat, text(f->description)};
}

std::optional<Layout> parse_layout(std::span<const std::byte> bytes) {
  const auto f = structure<v4l2_format>(bytes);
  if (!f || f->type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return std::nullopt;
  const v4l2_pix_format& p = f->fmt.pix;
  constexpr auto kMost = static_cast<std::uint32_t>(image::kMaxSidePx);
  if (p.width == 0 || p.height == 0 || p.width > kMost || p.height > kMost) return std::nullopt;
  return Layout{p.pixelformat, static_cast<int>(p.width), static_cast<int>(p.height), p.bytesperline, p.sizeimage};
}

std::optional<Control> parse_control(std::span<const std::byte> bytes) {
  const auto c = structure<v4l2_queryctrl>(bytes);
  if (!c) return std::nullopt;
  Control out;
  out.id = c->id;
  out.name = text(c->name);
  out.key = key_of(out.name);
  out.is_number = c->type == V4L2_CTRL_TYPE_INTEGER;
  out.is_boolean = c->type == V4L2_CTRL_TYPE_BOOLEAN;
  out.is_menu = c->type == V4L2_CTRL_TYPE_MENU || c->type == V4L2_CTRL_TYPE_INTEGER_MENU;
  out.is_button = c->type == V4L2_CTRL_TYPE_BUTTON;
  out.usable = (c->flags & (V4L2_CTRL_FLAG_DISABLED | V4L2_CTRL_FLAG_READ_ONLY)) == 0;
  out.least = c->minimum;
  out.most = c->maximum;
  out.step = std::max(c->step, 1);
  out.otherwise = c->default_value;
  return out;
}

std::optional<Filled> parse_filled(std::span<const std::byte> bytes) {
  const auto b = structure<v4l2_buffer>(bytes);
  if (!b || b->type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return std::nullopt;
  // Microseconds beyond a second, or a time before the start, are no time.
  const bool timed = b->timestamp.tv_sec >= 0 && b->timestamp.tv_sec < 1'000'000'000 && b->timestamp.tv_usec >= 0 &&
                     b->timestamp.tv_usec < 1'000'000;
  Filled out;
  out.index = b->index;
  out.sequence = b->sequence;
  out.bytes = b->bytesused;
  out.time_ns = timed ? (std::int64_t{b->timestamp.tv_sec} * 1'000'000 + b->timestamp.tv_usec) * 1000 : 0;
  out.damaged = (b->flags & V4L2_BUF_FLAG_ERROR) != 0;
  out.monotonic = (b->flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  return out;
}

}  // namespace pickcell::frames::v4l2
