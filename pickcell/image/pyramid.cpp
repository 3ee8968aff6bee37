#include "pickcell/image/pyramid.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace pickcell::image {
namespace {

constexpr int kLookEach = 64;  // rows between two questions whether to stop

/// The compiler's own vectors: whatever the machine at least has.
using Words = std::uint16_t __attribute__((vector_size(16)));
using Bytes = std::uint8_t __attribute__((vector_size(8)));

/// Means of 2 x 2 pixels, rounded half up: n of them from two rows. Eight at a time in 16-bit lanes, each of which
/// holds two neighbours.
void halve_rows(const std::uint8_t* a, const std::uint8_t* b, int n, std::uint8_t* out) {
  const auto pairs = [](const std::uint8_t* p) {
    Words v;
    std::memcpy(&v, p, sizeof v);
    return (v & 0xff) + (v >> 8);
  };
  int x = 0;
  for (; x + 8 <= n; x += 8) {
    const Words mean = (pairs(a + 2 * x) + pairs(b + 2 * x) + 2) >> 2;
    const Bytes eight = __builtin_convertvector(mean, Bytes);
    std::memcpy(out + x, &eight, sizeof eight);
  }
  for (; x < n; ++x) out[x] = static_cast<std::uint8_t>((a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1] + 2) >> 2);
}

}  // namespace

void Pyramid::build(ImageView picture, int min_side_px) {
  static_cast<void>(build_unless([] { return false; }, picture, min_side_px));
}

bool Pyramid::build_unless(const std::function<bool()>& stop, ImageView picture, int min_side_px) {
  count_ = 1;
  for (int side = std::min(picture.width(), picture.height()) / 2; side >= std::max(1, min_side_px); side /= 2)
    ++count_;
  if (planes_.size() < static_cast<std::size_t>(count_)) planes_.resize(static_cast<std::size_t>(count_));
  for (int l = 0; l < count_; ++l)
    planes_[static_cast<std::size_t>(l)].resize(picture.width() >> l, picture.height() >> l);
  // Level 1 from each two rows of the picture as they are copied: a large one is read from far memory once.
  Image& copy = planes_[0];
  for (int y = 0; y < picture.height(); ++y) {
    if (y % kLookEach == 0 && stop()) return false;
    std::memcpy(copy.row(y), picture.row(y), static_cast<std::size_t>(picture.width()));
    if (y % 2 == 1 && count_ > 1) halve_rows(copy.row(y - 1), copy.row(y), planes_[1].width(), planes_[1].row(y / 2));
  }
  for (int l = 2; l < count_; ++l) {
    const Image& fine = planes_[static_cast<std::size_t>(l - 1)];
    Image& coarse = planes_[static_cast<std::size_t>(l)];
    for (int y = 0; y < coarse.height(); ++y) {
      if (y % kLookEach == 0 && stop()) return false;
      halve_rows(fine.row(2 * y), fine.row(2 * y + 1), coarse.width(), coarse.row(y));
    }
  }
  return true;
}

}  // namespace pickcell::image
