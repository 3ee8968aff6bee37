/// Whatever a camera, a driver or a pipe may send: pixels in any format, answers of GigE Vision cameras, pictures in a
/// stream. The first byte chooses.

#include <cstdint>
#include <span>

#include "pickcell/frames/gvcp.hpp"
#include "pickcell/frames/picture_stream.hpp"
#include "pickcell/frames/pixel_format.hpp"
#include "pickcell/frames/unpack.hpp"

namespace {

using namespace pickcell::frames;  // NOLINT

constexpr const char* kNames[] = {"Mono8",           "Mono10",       "Mono12",       "Mono16",   "Mono10p",
                                  "Mono12p",         "Mono10Packed", "Mono12Packed", "BayerRG8", "BayerGB12p",
                                  "BayerBG10Packed", "RGB8",         "BGRa8",        "YUV422_8", "YUV422_8_UYVY"};

void pixels(std::span<const std::byte> data) {
  if (data.size() < 4) return;
  RawPicture raw;
  const std::size_t kind = static_cast<std::size_t>(data[0]) % (std::size(kNames) + 1);
  raw.format = kind == std::size(kNames) ? kJpeg : pixel_format(kNames[kind])->code;
  raw.width_px = static_cast<int>(data[1]);
  raw.height_px = static_cast<int>(data[2]) % 32;
  raw.stride_bytes = static_cast<std::size_t>(data[3]);
  raw.bytes = data.subspan(4);
  // As a running camera does: what one frame leaves behind must not hurt the next.
  static Unpacker unpacker;
  pickcell::image::Image out;
  const auto done = unpacker.unpack(raw, out);
  if (done && (out.width() != raw.width_px || out.height() != raw.height_px)) __builtin_trap();
}

void stream(std::span<const std::byte> data) {
  if (data.empty()) return;
  const std::size_t step = static_cast<std::size_t>(data[0]) + 1;
  data = data.subspan(1);
  PictureStream pictures("fuzz");
  for (bool ended = false; !ended;) {
    const auto now = data.first(std::min(step, data.size()));
    data = data.subspan(now.size());
    pictures.feed(now);
    if (now.empty()) pictures.end(), ended = true;
    for (auto picture = pictures.next(); picture && *picture; picture = pictures.next()) continue;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size < 1) return 0;
  const auto data = std::as_bytes(std::span(bytes, size)).subspan(1);
  switch (bytes[0] % 4) {
    case 0:
      pixels(data);
      break;
    case 1:
      stream(data);
      break;
    case 2:
      (void)gvcp::parse_discovery(data, 0xffff);
      break;
    default:
      (void)gvcp::parse_register(data, 7);
  }
  return 0;
}
