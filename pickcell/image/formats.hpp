#pragma once
/// The decoders behind codec.hpp, one file each. All take bytes that have already been recognised by their first bytes,
/// check every length against the span, and refuse truncated or damaged content with an error that names the file.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "pickcell/core/result.hpp"
#include "pickcell/image/image.hpp"

namespace pickcell::image::formats {

using Bytes = std::span<const std::byte>;

[[nodiscard]] core::Result<Image> decode_png(Bytes bytes, const std::string& name);
[[nodiscard]] core::Result<Image> decode_jpeg(Bytes bytes, const std::string& name);
[[nodiscard]] core::Result<Image> decode_bmp(Bytes bytes, const std::string& name);
[[nodiscard]] core::Result<Image> decode_pnm(Bytes bytes, const std::string& name);

/// ITU-R BT.601 luma, rounded to nearest.
[[nodiscard]] constexpr std::uint8_t luma(unsigned r, unsigned g, unsigned b) {
  return static_cast<std::uint8_t>((299 * r + 587 * g + 114 * b + 500) / 1000);
}

/// Fails unless 1 <= sides <= kMaxSidePx and the pixel count is at most kMaxPixels.
[[nodiscard]] core::Status check_size(std::int64_t width, std::int64_t height, const std::string& name);

/// "truncated or damaged" with the library's words.
[[nodiscard]] tl::unexpected<core::Error> damaged(const std::string& name, const std::string& why);

}  // namespace pickcell::image::formats
