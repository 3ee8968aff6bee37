#include "pickcell/matches/rst/smooth.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pickcell/matches/rst/smooth.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace pickcell::matches::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// out[x] = a[x] + 3 b[x] + 3 c[x] + d[x] for n values.
void columns_1331(const std::uint8_t* HWY_RESTRICT a, const std::uint8_t* HWY_RESTRICT b,
                  const std::uint8_t* HWY_RESTRICT c, const std::uint8_t* HWY_RESTRICT d,
                  std::uint16_t* HWY_RESTRICT out, int n) {
  const hn::ScalableTag<std::uint16_t> d16;
  const hn::Rebind<std::uint8_t, decltype(d16)> d8;
  const int lanes = static_cast<int>(hn::Lanes(d16));
  const auto load = [&](const std::uint8_t* p) HWY_ATTR { return hn::PromoteTo(d16, hn::LoadU(d8, p)); };
  int x = 0;
  for (; x + lanes <= n; x += lanes) {
    const auto middle = hn::Add(load(b + x), load(c + x));
    const auto outer = hn::Add(load(a + x), load(d + x));
    hn::StoreU(hn::Add(outer, hn::Add(middle, hn::Add(middle, middle))), d16, out + x);
  }
  for (; x < n; ++x) out[x] = static_cast<std::uint16_t>(a[x] + d[x] + 3 * (b[x] + c[x]));
}

/// out[x] = (c[2x - 1] + 3 c[2x] + 3 c[2x + 1] + c[2x + 2] + 32) / 64 for n values, rounding down.
void rows_1331(const std::uint16_t* HWY_RESTRICT c, std::uint8_t* HWY_RESTRICT out, int n) {
  int x = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::ScalableTag<std::uint16_t> d16;
  const hn::Rebind<std::uint8_t, decltype(d16)> d8;
  const int lanes = static_cast<int>(hn::Lanes(d16));
  for (; x + lanes <= n; x += lanes) {
    hn::Vec<decltype(d16)> before, even, odd, after;
    hn::LoadInterleaved2(d16, c + 2 * x - 1, before, even);
    hn::LoadInterleaved2(d16, c + 2 * x + 1, odd, after);
    const auto middle = hn::Add(even, odd);
    const auto sum = hn::Add(hn::Add(before, after), hn::Add(middle, hn::Add(middle, middle)));
    const auto mean = hn::ShiftRight<6>(hn::Add(sum, hn::Set(d16, std::uint16_t{32})));
    hn::StoreU(hn::DemoteTo(d8, hn::BitCast(hn::RebindToSigned<decltype(d16)>(), mean)), d8, out + x);
  }
#endif
  for (; x < n; ++x)
    out[x] = static_cast<std::uint8_t>((c[2 * x - 1] + c[2 * x + 2] + 3 * (c[2 * x] + c[2 * x + 1]) + 32) >> 6);
}

/// out[x] = a[x] + 2 b[x] + c[x] for n values.
void columns_121(const std::uint8_t* HWY_RESTRICT a, const std::uint8_t* HWY_RESTRICT b,
                 const std::uint8_t* HWY_RESTRICT c, std::uint16_t* HWY_RESTRICT out, int n) {
  const hn::ScalableTag<std::uint16_t> d16;
  const hn::Rebind<std::uint8_t, decltype(d16)> d8;
  const int lanes = static_cast<int>(hn::Lanes(d16));
  const auto load = [&](const std::uint8_t* p) HWY_ATTR { return hn::PromoteTo(d16, hn::LoadU(d8, p)); };
  int x = 0;
  for (; x + lanes <= n; x += lanes) {
    const auto middle = load(b + x);
    hn::StoreU(hn::Add(hn::Add(load(a + x), load(c + x)), hn::Add(middle, middle)), d16, out + x);
  }
  for (; x < n; ++x) out[x] = static_cast<std::uint16_t>(a[x] + 2 * b[x] + c[x]);
}

/// out[x] = (c[x - 1] + 2 c[x] + c[x + 1] + 8) / 16 for n values, rounding down.
void rows_121(const std::uint16_t* HWY_RESTRICT c, std::uint8_t* HWY_RESTRICT out, int n) {
  const hn::ScalableTag<std::uint16_t> d16;
  const hn::Rebind<std::uint8_t, decltype(d16)> d8;
  const int lanes = static_cast<int>(hn::Lanes(d16));
  int x = 0;
  for (; x + lanes <= n; x += lanes) {
    const auto middle = hn::LoadU(d16, c + x);
    const auto outer = hn::Add(hn::LoadU(d16, c + x - 1), hn::LoadU(d16, c + x + 1));
    const auto sum = hn::Add(hn::Add(outer, hn::Set(d16, std::uint16_t{8})), hn::Add(middle, middle));
    const auto mean = hn::BitCast(hn::RebindToSigned<decltype(d16)>(), hn::ShiftRight<4>(sum));
    hn::StoreU(hn::DemoteTo(d8, mean), d8, out + x);
  }
  for (; x < n; ++x) out[x] = static_cast<std::uint8_t>((c[x - 1] + 2 * c[x] + c[x + 1] + 8) >> 4);
}

}  // namespace pickcell::matches::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pickcell::matches {

HWY_EXPORT(columns_1331);
HWY_EXPORT(rows_1331);
HWY_EXPORT(columns_121);
HWY_EXPORT(rows_121);

void smooth(image::ImageView picture, image::Image& out) {
  const int w = picture.width(), h = picture.height();
  out.resize(w, h);
  std::vector<std::uint16_t> column(static_cast<std::size_t>(w) + 2);
  std::uint16_t* c = column.data() + 1;
  const auto columns = HWY_DYNAMIC_DISPATCH(columns_121);
  const auto rows = HWY_DYNAMIC_DISPATCH(rows_121);
  for (int y = 0; y < h; ++y) {
    columns(picture.row(std::max(0, y - 1)), picture.row(y), picture.row(std::min(h - 1, y + 1)), c, w);
    c[-1] = c[0];
    c[w] = c[w - 1];
    rows(c, out.row(y), w);
  }
}

void halve_binomially(image::ImageView picture, image::Image& out) {
  const int w = picture.width(), h = picture.height();
  out.resize(w / 2, h / 2);
  std::vector<std::uint16_t> column(static_cast<std::size_t>(w) + 2);
  std::uint16_t* c = column.data() + 1;
  const auto columns = HWY_DYNAMIC_DISPATCH(columns_1331);
  const auto rows = HWY_DYNAMIC_DISPATCH(rows_1331);
  for (int y = 0; y < out.height(); ++y) {
    columns(picture.row(std::max(0, 2 * y - 1)), picture.row(2 * y), picture.row(2 * y + 1),
            picture.row(std::min(h - 1, 2 * y + 2)), c, w);
    c[-1] = c[0];
    c[w] = c[w - 1];
    rows(c, out.row(y), out.width());
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
#endif
