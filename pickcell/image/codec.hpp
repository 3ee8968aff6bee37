#pragma once
/// Picture files. Everything is matched in 8-bit grey: colour is converted by ITU-R BT.601 luma, 16-bit samples are
/// scaled to 8 bit (65535 becomes 255) and rounded, alpha and gamma are ignored.

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/image/image.hpp"
#include "pickcell/image/rgb_image.hpp"

namespace pickcell::image {

/// Largest side and pixel count accepted from a file.
constexpr int kMaxSidePx = 32768;
constexpr std::size_t kMaxPixels = std::size_t{1} << 28;

/// PNG, JPEG, BMP (uncompressed 1, 4, 8, 24 and 32 bit), PGM/PPM (binary); recognised by content, not by name.
/// Truncated or damaged files are refused, naming the file. Thread-safe.
[[nodiscard]] core::Result<Image> load_grey(const std::filesystem::path& path);
/// The same from memory; name is used in errors.
[[nodiscard]] core::Result<Image> decode_grey(std::span<const std::byte> bytes, const std::string& name);

[[nodiscard]] core::Status save_png(const std::filesystem::path& path, ImageView picture);
[[nodiscard]] core::Status save_png(const std::filesystem::path& path, const RgbImage& picture);

/// quality 1..100.
[[nodiscard]] std::vector<std::byte> encode_jpeg(ImageView picture, int quality);

}  // namespace pickcell::image
