#include "pickcell/image/pyramid.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

namespace pickcell::image {
namespace {

/// Means of 2 x 2 pixels, rounded half up: n of them from two rows. Four at a time in the 16-bit lanes of a word.
void halve_rows(const std::uint8_t* a, const std::uint8_t* b, int n, std::uint8_t* out) {
  constexpr std::uint64_t kEven = 0x00ff00ff00ff00ffULL, kTwo = 0x0002000200020002ULL;
  int x = 0;
  if constexpr (std::endian::native == std::endian::little) {
    const auto pairs = [](const std::uint8_t* p) {
      std::uint64_t v = 0;
      std::memcpy(&v, p, sizeof v);
      return (v & kEven) + (v >> 8 & kEven);
    };
    for (; x + 4 <= n; x += 4) {
      std::uint64_t mean = (pairs(a + 2 * x) + pairs(b + 2 * x) + kTwo) >> 2 & kEven;
      mean = (mean | mean >> 8) & 0x0000ffff0000ffffULL;
      const auto four = static_cast<std::uint32_t>(mean | mean >> 16);
      std::memcpy(out + x, &four, sizeof four);
    }
  }
  for (; x < n; ++x) out[x] = static_cast<std::uint8_t>((a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1] + 2) >> 2);
}

}  // namespace

void Pyramid::build(ImageView picture, int min_side_px) {
  count_ = 1;
  for (int side = std::min(picture.width(), picture.height()) / 2; side >= std::max(1, min_side_px); side /= 2)
    ++count_;
  if (planes_.size() < static_cast<std::size_t>(count_)) planes_.resize(static_cast<std::size_t>(count_));
  planes_[0].resize(picture.width(), picture.height());
  for (int y = 0; y < picture.height(); ++y)
    std::memcpy(planes_[0].row(y), picture.row(y), static_cast<std::size_t>(picture.width()));
  for (int l = 1; l < count_; ++l) {
    const Image& fine = planes_[static_cast<std::size_t>(l - 1)];
    Image& coarse = planes_[static_cast<std::size_t>(l)];
    coarse.resize(fine.width() / 2, fine.height() / 2);
    for (int y = 0; y < coarse.height(); ++y)
      halve_rows(fine.row(2 * y), fine.row(2 * y + 1), coarse.width(), coarse.row(y));
  }
}

}  // namespace pickcell::image
