#pragma once
/// Pixel formats of cameras by their code in GenICam's Pixel Format Naming Convention (PFNC): colour class in the top
/// byte, bits per pixel in the next, a number below. GigE Vision and USB3 Vision carry these codes; V4L2's are mapped.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace pickcell::frames {

/// How the samples of a pixel lie in memory.
enum class Packing : std::uint8_t {
  whole,       ///< 8 bits, or 16 little endian with the value in the low bits
  lsb,         ///< "p": a stream of bits, low bits first, across the ends of rows
  gige,        ///< "Packed": two pixels in three bytes, high bytes outside, low bits together in the middle
  interleaved  ///< several channels of 8 bits in turn
};

enum class Mosaic : std::uint8_t { none, gr, rg, gb, bg };  ///< colours of the first two pixels of the first row

struct PixelFormat {
  std::uint32_t code = 0;
  std::string_view name;   ///< PFNC name
  int bits_per_pixel = 8;  ///< in memory
  int sample_bits = 8;     ///< of one sample's value
  Packing packing = Packing::whole;
  Mosaic mosaic = Mosaic::none;
  /// Of interleaved formats: bytes per pixel, and where red, green and blue are; -1 when luma is at `luma`.
  int red = -1, green = -1, blue = -1, luma = -1;
};

constexpr std::uint32_t kMono8 = 0x01080001;
constexpr std::uint32_t kMono10 = 0x01100003;
constexpr std::uint32_t kMono12 = 0x01100005;
constexpr std::uint32_t kMono16 = 0x01100007;
constexpr std::uint32_t kYuyv = 0x02100032;
constexpr std::uint32_t kUyvy = 0x0210001f;
constexpr std::uint32_t kRgb8 = 0x02180014;
constexpr std::uint32_t kBgr8 = 0x02180015;
/// Not of PFNC: one JPEG file per frame, as V4L2's MJPEG.
constexpr std::uint32_t kJpeg = 0x80000001;

/// Null for formats that are not understood (kJpeg is none of a fixed layout and so is not among them).
[[nodiscard]] const PixelFormat* pixel_format(std::uint32_t code);
[[nodiscard]] const PixelFormat* pixel_format(std::string_view name);
/// The PFNC name, "JPEG", or the code in hexadecimal.
[[nodiscard]] std::string format_name(std::uint32_t code);
/// "Mono8, Mono10, ...", for messages.
[[nodiscard]] std::string known_formats();

}  // namespace pickcell::frames
