// Windows BMP, uncompressed, 1, 4, 8, 24 and 32 bit, bottom-up and top-down.
// Source: Microsoft, "BITMAPFILEHEADER", "BITMAPINFOHEADER", "BITMAPV4HEADER" (wingdi.h).

#include <array>
#include <cstdlib>

#include "pickcell/image/formats.hpp"

namespace pickcell::image::formats {

namespace {

constexpr std::size_t kFileHeader = 14;
constexpr std::uint32_t kUncompressed = 0;
constexpr std::uint32_t kBitFields = 3;

std::uint32_t u8(Bytes b, std::size_t at) { return std::to_integer<std::uint32_t>(b[at]); }
std::uint32_t u16(Bytes b, std::size_t at) { return u8(b, at) | u8(b, at + 1) << 8; }
std::uint32_t u32(Bytes b, std::size_t at) { return u16(b, at) | u16(b, at + 2) << 16; }
std::int64_t i32(Bytes b, std::size_t at) { return static_cast<std::int32_t>(u32(b, at)); }

struct Layout {
  std::int64_t width = 0, height = 0;
  bool top_down = false;
  std::uint32_t bits = 0;
  std::size_t pixels_at = 0;
  std::size_t row_bytes = 0;
  std::array<std::uint8_t, 256> palette{};  ///< luma of each entry
};

tl::unexpected<core::Error> unsupported(const std::string& name, const std::string& why) {
  return core::failure(core::ErrorCode::unreadable, name, why, "save it as PNG or as an uncompressed 8 or 24 bit BMP");
}

/// Fills layout.palette from the entries between the info header and the pixels.
core::Status read_palette(Bytes bytes, std::size_t at, std::uint32_t entry_bytes, std::uint32_t declared,
                          Layout& layout, const std::string& name) {
  const std::uint32_t most = 1u << layout.bits;
  if (declared > most) return damaged(name, "palette of " + std::to_string(declared) + " colours");
  const std::uint32_t count = declared == 0 ? most : declared;
  if (at + std::size_t{count} * entry_bytes > layout.pixels_at)
    return damaged(name, "the palette runs into the pixels");
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::size_t entry = at + std::size_t{i} * entry_bytes;
    layout.palette[i] = luma(u8(bytes, entry + 2), u8(bytes, entry + 1), u8(bytes, entry));
  }
  return {};
}

/// 32-bit pixels with masks other than blue, green, red in this order would need a general reader.
bool standard_masks(Bytes bytes) {
  return u32(bytes, kFileHeader + 40) == 0xFF0000u && u32(bytes, kFileHeader + 44) == 0xFF00u &&
         u32(bytes, kFileHeader + 48) == 0xFFu;
}

/// The old OS/2 header with 16-bit sizes.
void read_core_header(Bytes bytes, Layout& layout) {
  layout.width = u16(bytes, kFileHeader + 4);
  layout.height = u16(bytes, kFileHeader + 6);
  layout.bits = u16(bytes, kFileHeader + 10);
}

core::Status read_info_header(Bytes bytes, Layout& layout, const std::string& name) {
  layout.width = i32(bytes, kFileHeader + 4);
  layout.height = std::abs(i32(bytes, kFileHeader + 8));
  layout.top_down = i32(bytes, kFileHeader + 8) < 0;
  layout.bits = u16(bytes, kFileHeader + 14);
  const std::uint32_t compression = u32(bytes, kFileHeader + 16);
  if (compression == kUncompressed) return {};
  if (compression != kBitFields || layout.bits != 32) return unsupported(name, "a compressed BMP");
  if (bytes.size() < kFileHeader + 52) return damaged(name, "the header ends too early");
  if (!standard_masks(bytes)) return unsupported(name, "a BMP with unusual colour masks");
  return {};
}

core::Result<Layout> read_layout(Bytes bytes, const std::string& name) {
  if (bytes.size() < kFileHeader + 12) return damaged(name, "the header ends too early");
  Layout layout;
  layout.pixels_at = u32(bytes, 10);
  const std::uint32_t header = u32(bytes, kFileHeader);
  if (header != 12 && header < 40) return unsupported(name, "a BMP of an unknown kind");
  if (bytes.size() < kFileHeader + std::size_t{header}) return damaged(name, "the header ends too early");
  if (header == 12)
    read_core_header(bytes, layout);
  else if (auto read = read_info_header(bytes, layout, name); !read)
    return core::forward(read);
  if (layout.bits != 1 && layout.bits != 4 && layout.bits != 8 && layout.bits != 24 && layout.bits != 32)
    return unsupported(name, "a BMP with " + std::to_string(layout.bits) + " bits per pixel");
  if (auto size = check_size(layout.width, layout.height, name); !size) return core::forward(size);
  layout.row_bytes = (static_cast<std::size_t>(layout.width) * layout.bits + 31) / 32 * 4;
  if (layout.pixels_at > bytes.size() ||
      layout.row_bytes * static_cast<std::size_t>(layout.height) > bytes.size() - layout.pixels_at)
    return damaged(name, "the file ends too early");
  if (layout.bits <= 8) {
    const std::uint32_t declared = header == 12 ? 0 : u32(bytes, kFileHeader + 32);
    if (auto palette = read_palette(bytes, kFileHeader + header, header == 12 ? 3 : 4, declared, layout, name);
        !palette)
      return core::forward(palette);
  }
  return layout;
}

void convert_row(Bytes row, const Layout& layout, std::uint8_t* out) {
  const auto width = static_cast<std::size_t>(layout.width);
  if (layout.bits > 8) {
    const std::size_t step = layout.bits / 8;
    for (std::size_t x = 0; x < width; ++x)
      out[x] = luma(u8(row, x * step + 2), u8(row, x * step + 1), u8(row, x * step));
    return;
  }
  const std::size_t per_byte = 8 / layout.bits;
  const std::uint32_t mask = (1u << layout.bits) - 1;
  for (std::size_t x = 0; x < width; ++x) {
    const std::size_t shift = (per_byte - 1 - x % per_byte) * layout.bits;
    out[x] = layout.palette[u8(row, x / per_byte) >> shift & mask];
  }
}

}  // namespace

core::Result<Image> decode_bmp(Bytes bytes, const std::string& name) {
  auto layout = read_layout(bytes, name);
  if (!layout) return core::forward(layout);
  Image out(static_cast<int>(layout->width), static_cast<int>(layout->height));
  for (int y = 0; y < out.height(); ++y) {
    const auto stored = static_cast<std::size_t>(layout->top_down ? y : out.height() - 1 - y);
    convert_row(bytes.subspan(layout->pixels_at + stored * layout->row_bytes, layout->row_bytes), *layout, out.row(y));
  }
  return out;
}

}  // namespace pickcell::image::formats
