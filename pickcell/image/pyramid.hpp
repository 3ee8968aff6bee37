#pragma once
/// The picture at halved sizes, built once per frame for all models and engines.

#include <functional>
#include <vector>

#include "pickcell/image/image.hpp"

namespace pickcell::image {

/// Level 0 is a copy of the picture; level l+1 averages 2x2 boxes of level l (odd last rows and columns are dropped),
/// rounding to nearest. x_l = (x_0 + 0.5) / 2^l - 0.5.
class Pyramid {
 public:
  /// Levels until the shorter side would fall below min_side_px. Reuses memory when called again.
  void build(ImageView picture, int min_side_px = 8);
  /// The same, and asks now and then whether to stop: then returns false, and there is no pyramid.
  [[nodiscard]] bool build_unless(const std::function<bool()>& stop, ImageView picture, int min_side_px = 8);
  [[nodiscard]] int levels() const { return count_; }
  [[nodiscard]] ImageView level(int l) const { return planes_[static_cast<std::size_t>(l)].view(); }

 private:
  std::vector<Image> planes_;
  int count_ = 0;
};

}  // namespace pickcell::image
