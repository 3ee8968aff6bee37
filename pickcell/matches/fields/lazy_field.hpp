#pragma once
/// The orientation field of one pyramid level, computed where it is looked at. A part covers a small share of the
/// picture, and at level 0 the whole field would cost more than everything else that happens there.

#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "pickcell/image/image.hpp"
#include "pickcell/matches/fields/orientation_field.hpp"

namespace pickcell::matches {

/// Keeps its memory from picture to picture. start() by one thread; need() and view() from any number at once: a tile's
/// values do not depend on who computes it, or when.
class LazyField {
 public:
  /// The picture must be a Plane's and outlive the use of this field.
  void start(image::ImageView picture);
  /// Makes the box of pixels (inclusive; what lies outside the picture stands for its border) valid in view().
  void need(int x0, int y0, int x1, int y1);
  [[nodiscard]] image::View<std::int8_t> view() const { return field_.view(); }

 private:
  static constexpr int kTileWidth = kFieldPartWidth;
  static constexpr int kTileHeight = kFieldPartHeight;
  void compute(int column, int row);

  image::ImageView picture_;
  OrientationField field_;
  int columns_ = 0;
  int rows_ = 0;
  std::unique_ptr<std::atomic<bool>[]> done_;
  std::size_t room_ = 0;
  std::mutex computing_;
};

}  // namespace pickcell::matches
