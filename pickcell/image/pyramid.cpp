#include "pickcell/image/pyramid.hpp"

#include <algorithm>
#include <cstring>

namespace pickcell::image {

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
    for (int y = 0; y < coarse.height(); ++y) {
      const std::uint8_t* a = fine.row(2 * y);
      const std::uint8_t* b = fine.row(2 * y + 1);
      std::uint8_t* out = coarse.row(y);
      for (int x = 0; x < coarse.width(); ++x)
        out[x] = static_cast<std::uint8_t>((a[2 * x] + a[2 * x + 1] + b[2 * x] + b[2 * x + 1] + 2) >> 2);
    }
  }
}

}  // namespace pickcell::image
