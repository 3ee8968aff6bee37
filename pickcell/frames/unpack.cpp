#include "pickcell/frames/unpack.hpp"

#include <algorithm>
#include <vector>

#include "pickcell/frames/pixel_format.hpp"
#include "pickcell/image/codec.hpp"

namespace pickcell::frames {

using core::ErrorCode;
using core::failure;

namespace {

std::uint8_t scaled(std::uint32_t value, std::uint32_t max) {
  return static_cast<std::uint8_t>((std::min(value, max) * 255U + max / 2) / max);
}

const std::uint8_t* data(const RawPicture& raw) { return reinterpret_cast<const std::uint8_t*>(raw.bytes.data()); }

/// Sample number p of the stream of pixels that begins at row.
std::uint32_t sample(const std::uint8_t* row, std::size_t p, const PixelFormat& format) {
  const auto bits = static_cast<std::size_t>(format.sample_bits);
  switch (format.packing) {
    case Packing::whole:
      return bits == 8 ? row[p] : static_cast<std::uint32_t>(row[2 * p] | row[2 * p + 1] << 8);
    case Packing::lsb: {
      const std::size_t first = p * bits / 8, shift = p * bits % 8;
      const std::uint32_t two = static_cast<std::uint32_t>(row[first] | row[first + 1] << 8);
      return two >> shift & ((1U << bits) - 1);
    }
    case Packing::gige: {
      const std::uint8_t* pair = row + p / 2 * 3;
      const std::uint32_t low_bits = static_cast<std::uint32_t>(bits - 8), mask = (1U << low_bits) - 1;
      return p % 2 == 0 ? static_cast<std::uint32_t>(pair[0]) << low_bits | (pair[1] & mask)
                        : static_cast<std::uint32_t>(pair[2]) << low_bits | (pair[1] >> 4 & mask);
    }
    case Packing::interleaved:
      break;
  }
  return 0;
}

void unpack_samples(const RawPicture& raw, const PixelFormat& format, image::Image& out) {
  const auto width = static_cast<std::size_t>(raw.width_px);
  const std::uint32_t max = (1U << format.sample_bits) - 1;
  for (int y = 0; y < raw.height_px; ++y) {
    const auto row_number = static_cast<std::size_t>(y);
    const std::uint8_t* row = data(raw) + row_number * raw.stride_bytes;
    const std::size_t first = raw.stride_bytes == 0 ? row_number * width : 0;
    std::uint8_t* to = out.row(y);
    if (format.packing == Packing::whole && format.sample_bits == 8)
      std::copy_n(row + first, width, to);
    else
      for (std::size_t x = 0; x < width; ++x) to[x] = scaled(sample(row, first + x, format), max);
  }
}

/// BT.601 in 14 bits; inputs times 4.
std::uint8_t luma_of_quarters(int r4, int g4, int b4) {
  return static_cast<std::uint8_t>((r4 * 4899 + g4 * 9617 + b4 * 1868 + (1 << 15)) >> 16);
}

void unpack_interleaved(const RawPicture& raw, const PixelFormat& format, image::Image& out) {
  const std::size_t step = static_cast<std::size_t>(format.bits_per_pixel) / 8;
  const std::size_t stride = raw.stride_bytes ? raw.stride_bytes : step * static_cast<std::size_t>(raw.width_px);
  for (int y = 0; y < raw.height_px; ++y) {
    const std::uint8_t* p = data(raw) + static_cast<std::size_t>(y) * stride;
    std::uint8_t* to = out.row(y);
    for (int x = 0; x < raw.width_px; ++x, p += step)
      to[x] = format.luma >= 0 ? p[format.luma]
                               : luma_of_quarters(4 * p[format.red], 4 * p[format.green], 4 * p[format.blue]);
  }
}

/// Index with the edge pixel as mirror: keeps the mosaic's colours in step.
int mirrored(int i, int n) {
  if (n == 1) return 0;
  if (i < 0) return -i;
  return i >= n ? 2 * n - 2 - i : i;
}

/// Is the first row's first pixel green; is the first row one with red?
struct Phase {
  bool green_first, red_row_first;
};
Phase phase(Mosaic mosaic) {
  return {mosaic == Mosaic::gr || mosaic == Mosaic::gb, mosaic == Mosaic::gr || mosaic == Mosaic::rg};
}

void demosaic(const std::uint8_t* from, std::size_t stride, Mosaic mosaic, image::Image& out) {
  const Phase at = phase(mosaic);
  const int w = out.width(), h = out.height();
  for (int y = 0; y < h; ++y) {
    const std::uint8_t* up = from + static_cast<std::size_t>(mirrored(y - 1, h)) * stride;
    const std::uint8_t* mid = from + static_cast<std::size_t>(y) * stride;
    const std::uint8_t* down = from + static_cast<std::size_t>(mirrored(y + 1, h)) * stride;
    const bool red_row = (y % 2 == 0) == at.red_row_first;
    std::uint8_t* to = out.row(y);
    for (int x = 0; x < w; ++x) {
      const int l = mirrored(x - 1, w), r = mirrored(x + 1, w);
      const bool green = (x % 2 == 0) == (at.green_first == (y % 2 == 0));
      // own: colour of this row's other pixels; far: the colour of the rows above and below.
      int own4, green4, far4;
      if (green) {
        own4 = 2 * (mid[l] + mid[r]);
        green4 = 4 * mid[x];
        far4 = 2 * (up[x] + down[x]);
      } else {
        own4 = 4 * mid[x];
        green4 = mid[l] + mid[r] + up[x] + down[x];
        far4 = up[l] + up[r] + down[l] + down[r];
      }
      to[x] = red_row ? luma_of_quarters(own4, green4, far4) : luma_of_quarters(far4, green4, own4);
    }
  }
}

}  // namespace

std::size_t bytes_needed(const RawPicture& raw) {
  const PixelFormat* format = pixel_format(raw.format);
  if (format == nullptr || raw.width_px < 1 || raw.height_px < 1 || raw.width_px > image::kMaxSidePx ||
      raw.height_px > image::kMaxSidePx)
    return 0;
  const auto w = static_cast<std::size_t>(raw.width_px), h = static_cast<std::size_t>(raw.height_px);
  if (w * h > image::kMaxPixels) return 0;
  const auto bytes_of = [&](std::size_t pixels) {
    if (format->packing == Packing::gige) return (pixels + 1) / 2 * 3 - pixels % 2;
    return (pixels * static_cast<std::size_t>(format->bits_per_pixel) + 7) / 8;
  };
  if (raw.stride_bytes == 0) return bytes_of(w * h);
  const std::size_t row = bytes_of(w);
  return row > raw.stride_bytes ? 0 : (h - 1) * raw.stride_bytes + row;
}

core::Status Unpacker::unpack_jpeg(const RawPicture& raw, image::Image& out) {
  auto decoded = jpeg_.decode(raw.bytes, "JPEG frame", out, raw.width_px, raw.height_px);
  if (!decoded) return failure(ErrorCode::device, "camera", "a JPEG frame: " + decoded.error().why, "check the cable");
  return {};
}

core::Status unpack(const RawPicture& raw, image::Image& out) { return Unpacker().unpack(raw, out); }

core::Status Unpacker::unpack(const RawPicture& raw, image::Image& out) {
  if (raw.format == kJpeg) return unpack_jpeg(raw, out);
  const PixelFormat* format = pixel_format(raw.format);
  if (format == nullptr)
    return failure(ErrorCode::device, "camera", "sends the pixel format " + format_name(raw.format),
                   "choose another, for example --set pixel_format=Mono8");
  const std::size_t need = bytes_needed(raw);
  if (need == 0 || raw.bytes.size() < need)
    return failure(ErrorCode::device, "camera",
                   "a frame of " + std::to_string(raw.bytes.size()) + " bytes is no " + std::to_string(raw.width_px) +
                       "x" + std::to_string(raw.height_px) + " picture in " + std::string(format->name));
  out.resize(raw.width_px, raw.height_px);
  if (format->packing == Packing::interleaved) {
    unpack_interleaved(raw, *format, out);
  } else if (format->mosaic == Mosaic::none) {
    unpack_samples(raw, *format, out);
  } else if (format->sample_bits == 8) {
    demosaic(data(raw), raw.stride_bytes ? raw.stride_bytes : static_cast<std::size_t>(raw.width_px), format->mosaic,
             out);
  } else {
    mosaic_.resize(raw.width_px, raw.height_px);
    unpack_samples(raw, *format, mosaic_);
    demosaic(mosaic_.row(0), static_cast<std::size_t>(mosaic_.stride()), format->mosaic, out);
  }
  return {};
}

}  // namespace pickcell::frames
