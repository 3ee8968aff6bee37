#pragma once
/// The picture at level NP as rst and erst see it: the paper names a pyramid but not its filter.

#include <vector>

#include "pickcell/image/image.hpp"
#include "pickcell/image/pyramid.hpp"
#include "pickcell/matches/rst/settings.hpp"

namespace pickcell::matches {

/// One pass of [1 2 1] / 4 in both directions, rounding to nearest; the border is repeated. out may not be the picture.
void smooth(image::ImageView picture, image::Image& out);

/// Half the size, [1 3 3 1] / 8 in both directions, rounding to nearest; the border is repeated, odd last rows and
/// columns are dropped. The binomial filter of even length: pixel x stands where it does in image::Pyramid, at 2x + 1/2
/// (cv::pyrDown, of odd length, stands at 2x).
void halve_binomially(image::ImageView picture, image::Image& out);

/// Makes level NP from a pyramid of boxes, by the settings' filter and so many passes of smooth(). Keeps its memory.
class CoarsePicture {
 public:
  /// The view lives until the next call, and no longer than the pyramid.
  [[nodiscard]] image::ImageView make(const image::Pyramid& pyramid, int level, const RstSettings& settings);

 private:
  std::vector<image::Image> levels_;
  image::Image smoothed_, scratch_;
};

}  // namespace pickcell::matches
