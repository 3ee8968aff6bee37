// JPEG through libjpeg-turbo. It reports errors by longjmp: the functions that call setjmp hold nothing but plain data,
// every C++ object lives in their callers. The decoder gives the Y channel, which is BT.601 luma.

#include <cstdio>  // jpeglib.h needs FILE

#include <jerror.h>
#include <jpeglib.h>

#include <csetjmp>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <utility>

#include "pickcell/image/codec.hpp"
#include "pickcell/image/formats.hpp"
#include "pickcell/image/jpeg_decoder.hpp"

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

/// The memory of one picture's decoding, used again for the next: one block as large as the largest picture took.
class Arena {
 public:
  Arena() = default;
  ~Arena() {
    free_extra();
    std::free(base_);
  }
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  /// Aligned for SIMD; null when the machine has no more. Never throws: C is above it.
  [[nodiscard]] void* take(std::size_t bytes) {
    bytes = rounded(bytes);
    asked_ += bytes;
    if (capacity_ - used_ >= bytes) return base_ + std::exchange(used_, used_ + bytes);
    auto* block = static_cast<Block*>(std::aligned_alloc(kAlign, kAlign + bytes));
    if (block == nullptr) return nullptr;
    block->next = std::exchange(extra_, block);
    return reinterpret_cast<std::byte*>(block) + kAlign;
  }
  void clear() {
    free_extra();
    if (asked_ > capacity_) {
      std::free(base_);
      base_ = static_cast<std::byte*>(std::aligned_alloc(kAlign, asked_));
      capacity_ = base_ == nullptr ? 0 : asked_;
    }
    used_ = asked_ = 0;
  }
  static constexpr std::size_t rounded(std::size_t bytes) { return (bytes + kAlign - 1) / kAlign * kAlign; }

 private:
  static constexpr std::size_t kAlign = 64;
  struct Block {
    Block* next;
  };
  void free_extra() {
    while (extra_ != nullptr) std::free(std::exchange(extra_, extra_->next));
  }
  std::byte* base_ = nullptr;
  std::size_t capacity_ = 0, used_ = 0, asked_ = 0;
  Block* extra_ = nullptr;
};

}  // namespace

struct JpegDecoder::State {
  jpeg_decompress_struct info{};
  jpeg_progress_mgr progress{};
  JpegError error{};
  jpeg_memory_mgr library{};  ///< libjpeg's own memory: for what outlives a picture, and for whole progressive pictures
  Arena arena;
  State() {
    info.err = install(error);
    info.client_data = this;
    progress.progress_monitor = limit_scans;
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { jpeg_destroy_decompress(&info); }

  static State& of(j_common_ptr info) { return *static_cast<State*>(info->client_data); }
  static void* take(j_common_ptr info, std::size_t bytes) {
    void* p = of(info).arena.take(bytes);
    if (p == nullptr) {
      info->err->msg_code = JERR_OUT_OF_MEMORY;
      give_up(info);
    }
    return p;
  }
  static void* take_small(j_common_ptr info, int pool, std::size_t bytes) {
    return pool == JPOOL_IMAGE ? take(info, bytes) : of(info).library.alloc_small(info, pool, bytes);
  }
  static void* take_large(j_common_ptr info, int pool, std::size_t bytes) {
    return pool == JPOOL_IMAGE ? take(info, bytes) : of(info).library.alloc_large(info, pool, bytes);
  }
  template <class Row>
  static Row* rows(j_common_ptr info, std::size_t bytes_per_row, JDIMENSION count) {
    const std::size_t step = Arena::rounded(bytes_per_row);
    auto* out = static_cast<Row*>(take(info, sizeof(Row) * count));
    auto* bytes = static_cast<std::byte*>(take(info, step * count));
    for (JDIMENSION i = 0; i < count; ++i) out[i] = reinterpret_cast<Row>(bytes + i * step);
    return out;
  }
  static JSAMPARRAY take_samples(j_common_ptr info, int pool, JDIMENSION per_row, JDIMENSION count) {
    if (pool != JPOOL_IMAGE) return of(info).library.alloc_sarray(info, pool, per_row, count);
    return rows<JSAMPROW>(info, sizeof(JSAMPLE) * per_row, count);
  }
  static JBLOCKARRAY take_blocks(j_common_ptr info, int pool, JDIMENSION per_row, JDIMENSION count) {
    if (pool != JPOOL_IMAGE) return of(info).library.alloc_barray(info, pool, per_row, count);
    return rows<JBLOCKROW>(info, sizeof(JBLOCK) * per_row, count);
  }
  static void free_pool(j_common_ptr info, int pool) {
    of(info).library.free_pool(info, pool);
    if (pool == JPOOL_IMAGE) of(info).arena.clear();
  }

  // With setjmp inside.
  static bool create(State* s);
  static bool read_header(State* s, const unsigned char* data, unsigned long size);
  static bool read_rows(State* s, Image* out);
};

bool JpegDecoder::State::create(State* s) {
  if (setjmp(s->error.jump)) return false;
  jpeg_create_decompress(&s->info);
  s->info.progress = &s->progress;
  jpeg_memory_mgr& memory = *s->info.mem;
  s->library = memory;
  memory.alloc_small = take_small;
  memory.alloc_large = take_large;
  memory.alloc_sarray = take_samples;
  memory.alloc_barray = take_blocks;
  memory.free_pool = free_pool;
  return true;
}

bool JpegDecoder::State::read_header(State* s, const unsigned char* data, unsigned long size) {
  if (setjmp(s->error.jump)) return false;
  jpeg_abort_decompress(&s->info);  // what an earlier, damaged picture left
  jpeg_mem_src(&s->info, data, size);
  jpeg_read_header(&s->info, TRUE);
  return true;
}

bool JpegDecoder::State::read_rows(State* s, Image* out) {
  if (setjmp(s->error.jump)) return false;
  s->info.out_color_space = JCS_GRAYSCALE;
  jpeg_start_decompress(&s->info);
  while (s->info.output_scanline < s->info.output_height) {
    JSAMPROW row = out->row(static_cast<int>(s->info.output_scanline));
    jpeg_read_scanlines(&s->info, &row, 1);
  }
  jpeg_finish_decompress(&s->info);
  return true;
}

namespace {

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

JpegDecoder::JpegDecoder() = default;
JpegDecoder::~JpegDecoder() = default;
JpegDecoder::JpegDecoder(JpegDecoder&&) noexcept = default;
JpegDecoder& JpegDecoder::operator=(JpegDecoder&&) noexcept = default;

core::Status JpegDecoder::decode(std::span<const std::byte> bytes, const std::string& name, Image& out, int width_px,
                                 int height_px) {
  if (!state_) {
    auto state = std::make_unique<State>();
    if (!State::create(state.get())) return formats::damaged(name, state->error.text);
    state_ = std::move(state);
  }
  if (!State::read_header(state_.get(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()))
    return formats::damaged(name, state_->error.text);
  const auto& info = state_->info;
  if (auto size = formats::check_size(info.image_width, info.image_height, name); !size) return core::forward(size);
  const int w = static_cast<int>(info.image_width), h = static_cast<int>(info.image_height);
  if (width_px > 0 && (w != width_px || h != height_px))
    return core::failure(core::ErrorCode::unreadable, name,
                         std::to_string(w) + "x" + std::to_string(h) + " instead of " + std::to_string(width_px) + "x" +
                             std::to_string(height_px));
  if (info.jpeg_color_space == JCS_CMYK || info.jpeg_color_space == JCS_YCCK)
    return core::failure(core::ErrorCode::unreadable, name, "a CMYK JPEG", "convert it to grey or RGB");
  out.resize(w, h);
  if (!State::read_rows(state_.get(), &out)) return formats::damaged(name, state_->error.text);
  return {};
}

namespace formats {

core::Result<Image> decode_jpeg(Bytes bytes, const std::string& name) {
  Image out;
  if (auto decoded = JpegDecoder().decode(bytes, name, out); !decoded) return core::forward(decoded);
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
