#pragma once
/// The low-pass filter of the coarse level.

#include "pickcell/image/image.hpp"

namespace pickcell::matches {

/// One pass of [1 2 1] / 4 in both directions, rounding to nearest; the border is repeated. out may not be the picture.
void smooth(image::ImageView picture, image::Image& out);

/// Several passes; 0 copies.
void smooth(image::ImageView picture, int passes, image::Image& out, image::Image& scratch);

}  // namespace pickcell::matches
