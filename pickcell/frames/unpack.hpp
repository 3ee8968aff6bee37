#pragma once
/// From a camera's bytes to grey: 8-bit copy, 10 to 16 bits scaled and rounded, colour by ITU-R BT.601 luma, Bayer
/// mosaics by bilinear interpolation of the three colours and then luma.

#include <cstddef>
#include <cstdint>
#include <span>

#include "pickcell/core/result.hpp"
#include "pickcell/image/image.hpp"
#include "pickcell/image/jpeg_decoder.hpp"

namespace pickcell::frames {

/// One frame as the camera sent it; somebody else owns the bytes.
struct RawPicture {
  std::span<const std::byte> bytes;
  std::uint32_t format = 0;  ///< PFNC code, or kJpeg
  int width_px = 0;
  int height_px = 0;
  std::size_t stride_bytes = 0;  ///< from row to row; 0: rows follow each other without padding
};

/// Bytes that a whole picture needs; empty for sizes below 1 or above image::kMaxSidePx, unknown formats, rows that do
/// not fit the stride, and kJpeg.
[[nodiscard]] std::size_t bytes_needed(const RawPicture& raw);

/// Keeps the memory that some formats need on the way: the second frame of a size allocates nothing any more. One
/// thread at a time.
class Unpacker {
 public:
  /// Into out, whose memory is kept when it suffices. Errors: device (format not understood, fewer bytes than needed,
  /// JPEG damaged or of another size).
  [[nodiscard]] core::Status unpack(const RawPicture& raw, image::Image& out);

 private:
  [[nodiscard]] core::Status unpack_jpeg(const RawPicture& raw, image::Image& out);

  image::Image mosaic_;  ///< of Bayer formats wider than 8 bits, in 8 bits
  image::JpegDecoder jpeg_;
};

/// The same for a single frame. Thread-safe.
[[nodiscard]] core::Status unpack(const RawPicture& raw, image::Image& out);

}  // namespace pickcell::frames
