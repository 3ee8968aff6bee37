// PNG through libpng. libpng reports errors by longjmp: the functions that call setjmp hold nothing but plain data,
// every C++ object lives in their callers.

#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "pickcell/core/file.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/image/formats.hpp"

namespace pickcell::image {

namespace {

/// What the callbacks share with us.
struct PngState {
  formats::Bytes input;
  std::size_t used = 0;
  std::vector<std::byte> output;
  char text[160] = {};
};

void keep_error(png_structp png, png_const_charp message) {
  auto* state = static_cast<PngState*>(png_get_error_ptr(png));
  std::strncpy(state->text, message, sizeof(state->text) - 1);
  png_longjmp(png, 1);
}

void ignore_warning(png_structp, png_const_charp) {}

void read_bytes(png_structp png, png_bytep out, std::size_t n) {
  auto* state = static_cast<PngState*>(png_get_io_ptr(png));
  if (n > state->input.size() - state->used) png_error(png, "the file ends too early");
  std::memcpy(out, state->input.data() + state->used, n);
  state->used += n;
}

bool append(std::vector<std::byte>& out, png_const_bytep data, std::size_t n) noexcept {
  try {
    const auto* from = reinterpret_cast<const std::byte*>(data);
    out.insert(out.end(), from, from + n);
    return true;
  } catch (...) {
    return false;
  }
}

void write_bytes(png_structp png, png_bytep data, std::size_t n) {
  if (!append(static_cast<PngState*>(png_get_io_ptr(png))->output, data, n)) png_error(png, "out of memory");
}

void flush_nothing(png_structp) {}

/// Owns libpng's two structures.
class PngReader {
 public:
  explicit PngReader(PngState& state)
      : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, &state, keep_error, ignore_warning)),
        info(png ? png_create_info_struct(png) : nullptr) {
    if (!info) {
      png_destroy_read_struct(&png, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png, &state, read_bytes);
  }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }

  png_structp png;
  png_infop info;
};

struct Header {
  std::int64_t width = 0, height = 0;
  std::size_t raw_bytes = 0;  ///< of the whole picture before any conversion
  int channels = 0;           ///< after the conversion to 8 bit without alpha: 1 or 3
  int passes = 1;
};

bool read_header(png_structp png, png_infop info, Header* header) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_user_limits(png, 0x7fffffff, 0x7fffffff);  // our own check has the better words
  png_read_info(png, info);
  header->width = png_get_image_width(png, info);
  header->height = png_get_image_height(png, info);
  header->raw_bytes = png_get_rowbytes(png, info) * static_cast<std::size_t>(header->height);
  return true;
}

bool ask_for_grey_or_rgb(png_structp png, png_infop info, Header* header) {
  if (setjmp(png_jmpbuf(png))) return false;
  if (png_get_color_type(png, info) == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
  if (png_get_color_type(png, info) == PNG_COLOR_TYPE_GRAY) png_set_expand_gray_1_2_4_to_8(png);
  png_set_scale_16(png);
  png_set_strip_alpha(png);
  header->passes = png_set_interlace_handling(png);
  png_read_update_info(png, info);
  header->channels = png_get_channels(png, info);
  return true;
}

bool read_rows(png_structp png, png_infop info, std::uint8_t* rows, std::size_t row_bytes, std::size_t row_count,
               int passes) {
  if (setjmp(png_jmpbuf(png))) return false;
  for (int pass = 0; pass < passes; ++pass)
    for (std::size_t y = 0; y < row_count; ++y) png_read_row(png, rows + y * row_bytes, nullptr);
  png_read_end(png, info);
  return true;
}

void to_grey(const std::vector<std::uint8_t>& rows, int channels, Image& out) {
  const std::size_t row_bytes = static_cast<std::size_t>(out.width()) * static_cast<std::size_t>(channels);
  for (int y = 0; y < out.height(); ++y) {
    const std::uint8_t* from = rows.data() + static_cast<std::size_t>(y) * row_bytes;
    if (channels == 1)
      std::memcpy(out.row(y), from, row_bytes);
    else
      for (int x = 0; x < out.width(); ++x, from += 3) out.row(y)[x] = formats::luma(from[0], from[1], from[2]);
  }
}

class PngWriter {
 public:
  explicit PngWriter(PngState& state)
      : png(png_create_write_struct(PNG_LIBPNG_VER_STRING, &state, keep_error, ignore_warning)),
        info(png ? png_create_info_struct(png) : nullptr) {
    if (!info) {
      png_destroy_write_struct(&png, nullptr);
      throw std::bad_alloc();
    }
    png_set_write_fn(png, &state, write_bytes, flush_nothing);
  }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter() { png_destroy_write_struct(&png, &info); }

  png_structp png;
  png_infop info;
};

bool write_rows(png_structp png, png_infop info, const std::uint8_t* rows, std::ptrdiff_t stride, unsigned width,
                unsigned height, int color_type) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_compression_level(png, 3);  // a third of the time of level 6 for a few percent of size
  png_set_IHDR(png, info, width, height, 8, color_type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  for (unsigned y = 0; y < height; ++y) png_write_row(png, rows + stride * static_cast<std::ptrdiff_t>(y));
  png_write_end(png, info);
  return true;
}

core::Status write_png(const std::filesystem::path& path, const std::uint8_t* rows, std::ptrdiff_t stride, int width,
                       int height, int color_type) {
  if (width < 1 || height < 1) throw std::invalid_argument("save_png: empty picture");
  PngState state;
  PngWriter writer(state);
  if (!write_rows(writer.png, writer.info, rows, stride, static_cast<unsigned>(width), static_cast<unsigned>(height),
                  color_type))
    return core::failure(core::ErrorCode::unreadable, path.string(), std::string("cannot be encoded: ") + state.text);
  return core::write_file_atomically(path, state.output);
}

}  // namespace

namespace formats {

core::Result<Image> decode_png(Bytes bytes, const std::string& name) {
  PngState state;
  state.input = bytes;
  PngReader reader(state);
  Header header;
  if (!read_header(reader.png, reader.info, &header)) return damaged(name, state.text);
  if (auto size = check_size(header.width, header.height, name); !size) return core::forward(size);
  // deflate cannot expand more than 1032-fold: a small file that claims a huge picture is refused before any allocation
  if (header.raw_bytes / 1040 > bytes.size()) return damaged(name, "the file ends too early");
  if (!ask_for_grey_or_rgb(reader.png, reader.info, &header)) return damaged(name, state.text);
  const std::size_t row_bytes = static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.channels);
  std::vector<std::uint8_t> rows(row_bytes * static_cast<std::size_t>(header.height));
  if (!read_rows(reader.png, reader.info, rows.data(), row_bytes, static_cast<std::size_t>(header.height),
                 header.passes))
    return damaged(name, state.text);
  Image out(static_cast<int>(header.width), static_cast<int>(header.height));
  to_grey(rows, header.channels, out);
  return out;
}

}  // namespace formats

core::Status save_png(const std::filesystem::path& path, ImageView picture) {
  return write_png(path, picture.empty() ? nullptr : picture.row(0), picture.stride(), picture.width(),
                   picture.height(), PNG_COLOR_TYPE_GRAY);
}

core::Status save_png(const std::filesystem::path& path, const RgbImage& picture) {
  static_assert(sizeof(Rgb) == 3);
  return write_png(path, reinterpret_cast<const std::uint8_t*>(picture.pixels.data()),
                   std::ptrdiff_t{3} * picture.width, picture.width, picture.height, PNG_COLOR_TYPE_RGB);
}

}  // namespace pickcell::image
