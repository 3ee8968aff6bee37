#pragma once
/// JPEG pictures one after the other, as a camera sends them.

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "pickcell/core/result.hpp"
#include "pickcell/image/image.hpp"

namespace pickcell::image {

/// Keeps all memory that decoding takes: after the first pictures of a stream nothing is allocated any more, except for
/// progressive ones. Tables that a picture leaves out are those of the one before, else the standard ones, as Motion
/// JPEG has it. One thread at a time.
class JpegDecoder {
 public:
  JpegDecoder();
  ~JpegDecoder();
  JpegDecoder(JpegDecoder&&) noexcept;
  JpegDecoder& operator=(JpegDecoder&&) noexcept;

  /// The picture's BT.601 luma into out, whose memory is kept when it suffices. width_px and height_px: what it must
  /// have, checked before any pixel is read; 0: any within the limits of codec.hpp. Errors: unreadable (truncated,
  /// damaged, CMYK, of another size), naming the picture; out is of no use then.
  [[nodiscard]] core::Status decode(std::span<const std::byte> bytes, const std::string& name, Image& out,
                                    int width_px = 0, int height_px = 0);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pickcell::image
