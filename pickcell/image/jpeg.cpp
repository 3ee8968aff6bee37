// JPEG through libjpeg-turbo. It reports errors by longjmp: the functions that call setjmp hold nothing but plain data,
// every C++ object lives in their callers. The decoder gives the Y channel, which is BT.601 luma.

#include <cstdio>  // jpeglib.h needs FILE

#include <jerror.h>
#include <jpeglib.h>

#include <csetjmp>
#include <cstdlib>
#include <memory>
#include <stdexcept>

#include "pickcell/image/codec.hpp"
#include "pickcell/image/formats.hpp"

namespace pickcell::image {

namespace {

/// A progressive file may repeat scans without end; real ones have about ten.
constexpr int kMaxScans = 200;

struct JpegError {
  jpeg_error_mgr base;  // first: libjpeg knows this part only
  std::jmp_buf jump;
  char text[JMSG_LENGTH_MAX];
};

[[noreturn]] void give_up(j_common_ptr info) {
  auto* error = reinterpret_cast<JpegError*>(info->err);
  info->err->format_message(info, error->text);
  std::longjmp(error->jump, 1);
}

/// libjpeg goes on after damage with grey blocks and a warning; a matcher must not.
void refuse_damage(j_common_ptr info, int level) {
  if (level >= 0) return;
  const int code = info->err->msg_code;
  if (code == JWRN_EXTRANEOUS_DATA || code == JWRN_ADOBE_XFORM || code == JWRN_JFIF_MAJOR) return;
  give_up(info);
}

void limit_scans(j_common_ptr info) {
  auto* decoder = reinterpret_cast<j_decompress_ptr>(info);
  if (decoder->input_scan_number <= kMaxScans) return;
  auto* error = reinterpret_cast<JpegError*>(info->err);
  std::snprintf(error->text, sizeof(error->text), "more than %d scans", kMaxScans);
  std::longjmp(error->jump, 1);
}

jpeg_error_mgr* install(JpegError& error) {
  error.text[0] = 0;
  jpeg_std_error(&error.base);
  error.base.error_exit = give_up;
  error.base.emit_message = refuse_damage;
  return &error.base;
}

struct Decoder {
  jpeg_decompress_struct info{};
  jpeg_progress_mgr progress{};
  JpegError error{};
  Decoder() {
    info.err = install(error);
    progress.progress_monitor = limit_scans;
  }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;
  ~Decoder() { jpeg_destroy_decompress(&info); }
};

bool read_header(Decoder* d, const unsigned char* data, unsigned long size) {
  if (setjmp(d->error.jump)) return false;
  jpeg_create_decompress(&d->info);
  d->info.progress = &d->progress;
  jpeg_mem_src(&d->info, data, size);
  jpeg_read_header(&d->info, TRUE);
  return true;
}

bool read_rows(Decoder* d, Image* out) {
  if (setjmp(d->error.jump)) return false;
  d->info.out_color_space = JCS_GRAYSCALE;
  jpeg_start_decompress(&d->info);
  while (d->info.output_scanline < d->info.output_height) {
    JSAMPROW row = out->row(static_cast<int>(d->info.output_scanline));
    jpeg_read_scanlines(&d->info, &row, 1);
  }
  jpeg_finish_decompress(&d->info);
  return true;
}

struct Encoder {
  jpeg_compress_struct info{};
  JpegError error{};
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  Encoder() { info.err = install(error); }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;
  ~Encoder() {
    jpeg_destroy_compress(&info);
    std::free(bytes);
  }
};

bool encode(Encoder* e, const ImageView* picture, int quality) {
  if (setjmp(e->error.jump)) return false;
  jpeg_create_compress(&e->info);
  jpeg_mem_dest(&e->info, &e->bytes, &e->size);
  e->info.image_width = static_cast<JDIMENSION>(picture->width());
  e->info.image_height = static_cast<JDIMENSION>(picture->height());
  e->info.input_components = 1;
  e->info.in_color_space = JCS_GRAYSCALE;
  jpeg_set_defaults(&e->info);
  jpeg_set_quality(&e->info, quality, TRUE);
  jpeg_start_compress(&e->info, TRUE);
  while (e->info.next_scanline < e->info.image_height) {
    auto* row =
        const_cast<JSAMPLE*>(picture->row(static_cast<int>(e->info.next_scanline)));  // libjpeg is not const-correct
    jpeg_write_scanlines(&e->info, &row, 1);
  }
  jpeg_finish_compress(&e->info);
  return true;
}

}  // namespace

namespace formats {

core::Result<Image> decode_jpeg(Bytes bytes, const std::string& name) {
  const auto decoder = std::make_unique<Decoder>();
  if (!read_header(decoder.get(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()))
    return damaged(name, decoder->error.text);
  const auto& info = decoder->info;
  if (auto size = check_size(info.image_width, info.image_height, name); !size) return core::forward(size);
  if (info.jpeg_color_space == JCS_CMYK || info.jpeg_color_space == JCS_YCCK)
    return core::failure(core::ErrorCode::unreadable, name, "a CMYK JPEG", "convert it to grey or RGB");
  Image out(static_cast<int>(info.image_width), static_cast<int>(info.image_height));
  if (!read_rows(decoder.get(), &out)) return damaged(name, decoder->error.text);
  return out;
}

}  // namespace formats

std::vector<std::byte> encode_jpeg(ImageView picture, int quality) {
  if (picture.empty() || picture.width() > JPEG_MAX_DIMENSION || picture.height() > JPEG_MAX_DIMENSION)
    throw std::invalid_argument("encode_jpeg: picture size");
  if (quality < 1 || quality > 100) throw std::invalid_argument("encode_jpeg: quality must be 1..100");
  const auto encoder = std::make_unique<Encoder>();
  if (!encode(encoder.get(), &picture, quality)) throw std::runtime_error(encoder->error.text);
  const auto* begin = reinterpret_cast<const std::byte*>(encoder->bytes);
  return {begin, begin + encoder->size};
}

}  // namespace pickcell::image
