#include "pickcell/matches/rst_smooth.hpp"

#include <algorithm>
#include <cstdint>

namespace pickcell::matches {
namespace {

constexpr int kBlock = 16;  // a fixed length lets the compiler use vectors

/// out[x] = a[x] + 3 b[x] + 3 c[x] + d[x] for n values.
void columns_1331(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c, const std::uint8_t* d,
                  std::uint16_t* __restrict out, int n) {
  int x = 0;
  for (; x + kBlock <= n; x += kBlock)
    for (int k = x; k < x + kBlock; ++k) out[k] = static_cast<std::uint16_t>(a[k] + d[k] + 3 * (b[k] + c[k]));
  for (; x < n; ++x) out[x] = static_cast<std::uint16_t>(a[x] + d[x] + 3 * (b[x] + c[x]));
}

}  // namespace

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

void halve_binomially(image::ImageView picture, image::Image& out) {
  const int w = picture.width(), h = picture.height();
  out.resize(w / 2, h / 2);
  std::vector<std::uint16_t> column(static_cast<std::size_t>(w) + 2);
  std::uint16_t* c = column.data() + 1;
  for (int y = 0; y < out.height(); ++y) {
    columns_1331(picture.row(std::max(0, 2 * y - 1)), picture.row(2 * y), picture.row(2 * y + 1),
                 picture.row(std::min(h - 1, 2 * y + 2)), c, w);
    c[-1] = c[0];
    c[w] = c[w - 1];
    std::uint8_t* o = out.row(y);
    for (int x = 0; x < out.width(); ++x)
      o[x] = static_cast<std::uint8_t>((c[2 * x - 1] + c[2 * x + 2] + 3 * (c[2 * x] + c[2 * x + 1]) + 32) >> 6);
  }
}

image::ImageView CoarsePicture::make(const image::Pyramid& pyramid, int level, const RstSettings& settings) {
  image::ImageView out = pyramid.level(level);
  if (settings.pyramid == PyramidFilter::binomial && level > 0) {
    levels_.resize(static_cast<std::size_t>(level));
    out = pyramid.level(0);
    for (image::Image& next : levels_) {
      halve_binomially(out, next);
      out = next.view();
    }
  }
  for (int i = 0; i < settings.smooth; ++i) {
    smooth(out, scratch_);
    smoothed_.swap(scratch_);
    out = smoothed_.view();
  }
  return out;
}

}  // namespace pickcell::matches
