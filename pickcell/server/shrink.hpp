#pragma once
/// Smaller pictures for screens.

#include "pickcell/image/image.hpp"

namespace pickcell::server {

/// Every result pixel is the mean of the area it covers, rounded to nearest; the height follows the width (at least 1).
/// With centres at integers: x_small = (x + 0.5) * width / picture.width() - 0.5. width 1..picture.width(), else throws
/// std::invalid_argument.
[[nodiscard]] image::Image shrink(image::ImageView picture, int width);

}  // namespace pickcell::server
