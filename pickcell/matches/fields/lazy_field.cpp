#include "pickcell/matches/fields/lazy_field.hpp"

#include <algorithm>

namespace pickcell::matches {

void LazyField::start(image::ImageView picture) {
  picture_ = picture;
  field_.resize(2 * picture.width(), picture.height());
  columns_ = (picture.width() + kTileWidth - 1) / kTileWidth;
  rows_ = (picture.height() + kTileHeight - 1) / kTileHeight;
  const std::size_t tiles = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  if (tiles > room_) {
    done_ = std::make_unique<std::atomic<bool>[]>(tiles);
    room_ = tiles;
  }
  for (std::size_t i = 0; i < tiles; ++i) done_[i].store(false, std::memory_order_relaxed);
}

void LazyField::need(int x0, int y0, int x1, int y1) {
  const int last_x = picture_.width() - 1, last_y = picture_.height() - 1;
  const int c0 = std::clamp(x0, 0, last_x) / kTileWidth, c1 = std::clamp(x1, 0, last_x) / kTileWidth;
  const int r0 = std::clamp(y0, 0, last_y) / kTileHeight, r1 = std::clamp(y1, 0, last_y) / kTileHeight;
  for (int r = r0; r <= r1; ++r)
    for (int c = c0; c <= c1; ++c)
      if (!done_[static_cast<std::size_t>(r * columns_ + c)].load(std::memory_order_acquire)) compute(c, r);
}

void LazyField::compute(int column, int row) {
  const std::lock_guard lock(computing_);
  std::atomic<bool>& done = done_[static_cast<std::size_t>(row * columns_ + column)];
  if (done.load(std::memory_order_relaxed)) return;
  const int x0 = column * kTileWidth, y0 = row * kTileHeight;
  orientation_field_part(
      picture_, {x0, y0, std::min(picture_.width(), x0 + kTileWidth), std::min(picture_.height(), y0 + kTileHeight)},
      field_);
  done.store(true, std::memory_order_release);
}

}  // namespace pickcell::matches
