#include "pickcell/matches/rst_smooth.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

namespace pickcell::matches {

void smooth(image::ImageView picture, image::Image& out) {
  const int w = picture.width(), h = picture.height();
  out.resize(w, h);
  std::vector<std::uint16_t> column(static_cast<std::size_t>(w) + 2);
  for (int y = 0; y < h; ++y) {
    const std::uint8_t* up = picture.row(std::max(0, y - 1));
    const std::uint8_t* here = picture.row(y);
    const std::uint8_t* down = picture.row(std::min(h - 1, y + 1));
    std::uint16_t* c = column.data() + 1;
    for (int x = 0; x < w; ++x) c[x] = static_cast<std::uint16_t>(up[x] + 2 * here[x] + down[x]);
    c[-1] = c[0];
    c[w] = c[w - 1];
    std::uint8_t* o = out.row(y);
    for (int x = 0; x < w; ++x) o[x] = static_cast<std::uint8_t>((c[x - 1] + 2 * c[x] + c[x + 1] + 8) >> 4);
  }
}

void smooth(image::ImageView picture, int passes, image::Image& out, image::Image& scratch) {
  if (passes == 0) {
    out = image::Image(picture);
    return;
  }
  smooth(picture, out);
  for (int i = 1; i < passes; ++i) {
    smooth(out.view(), scratch);
    out.swap(scratch);
  }
}

}  // namespace pickcell::matches
