#pragma once
/// By which turns a part looks the same.

#include "pickcell/image/image.hpp"

namespace pickcell::matches {

constexpr int kAnyAngle = 360;

struct Symmetry {
  int order = 1;  ///< turning by 360/order gives the same part; 1: none, kAnyAngle: a disc, no angle can be told
  /// The same if a mark is overlooked, such as a keyway in a gear.
  int nearly = 1;
  double nearly_likeness = 0;  ///< of the part and its turn by 360/nearly, 0..1
};

/// mask: same size, >= 128 is part; empty: everything. Grey values and outline of the mask must agree but for noise,
/// light that changes evenly across the part, and a fraction of a pixel; a mark is an area of a few pixels that differs
/// by more.
[[nodiscard]] Symmetry find_symmetry(image::ImageView picture, image::ImageView mask);

}  // namespace pickcell::matches
