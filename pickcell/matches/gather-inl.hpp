// Reading pictures at scattered places, for files that are compiled once per SIMD target (hence the guard of Highway).

#if defined(PICKCELL_MATCHES_GATHER_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef PICKCELL_MATCHES_GATHER_INL_HPP
#undef PICKCELL_MATCHES_GATHER_INL_HPP
#else
#define PICKCELL_MATCHES_GATHER_INL_HPP
#endif

#include <cstdint>

#include <hwy/highway.h>

#include "pickcell/image/image.hpp"

HWY_BEFORE_NAMESPACE();
namespace pickcell::matches::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most 16 lanes: the promise of kPointBlock.
using DF = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<DF>;
using VF = hn::Vec<DF>;
using VI = hn::Vec<DI>;

struct Place {
  VF x, y;
};

/// 0 <= v <= hi; not-a-number becomes a number.
HWY_INLINE VF clamped(VF v, float hi) { return hn::Min(hn::Max(v, hn::Zero(DF())), hn::Set(DF(), hi)); }

struct Corner {
  VI x, y;    ///< whole part, at most size - 2
  VF fx, fy;  ///< the rest, 0..1
};

HWY_INLINE Corner corner_of(const Place& p, int width, int height) {
  const DI di;
  const DF d;
  const VF x = clamped(p.x, static_cast<float>(width - 1));
  const VF y = clamped(p.y, static_cast<float>(height - 1));
  const VI ix = hn::Min(hn::ConvertTo(di, x), hn::Set(di, width - 2));
  const VI iy = hn::Min(hn::ConvertTo(di, y), hn::Set(di, height - 2));
  return {ix, iy, hn::Sub(x, hn::ConvertTo(d, ix)), hn::Sub(y, hn::ConvertTo(d, iy))};
}

/// Four bytes from each place.
HWY_INLINE VI four_bytes(const void* base, VI offset) {
  return hn::GatherOffset(DI(), static_cast<const std::int32_t*>(base), offset);
}

HWY_INLINE VF blend(VF a, VF b, VF f) { return hn::MulAdd(f, hn::Sub(b, a), a); }

/// Bilinear grey values of the pixels at and after an offset, in two rows.
HWY_INLINE VF blend_at(image::ImageView p, VI offset, VF fx, VF fy) {
  const DI di;
  const DF d;
  const VI byte = hn::Set(di, 255);
  const VI up = four_bytes(p.row(0), offset);
  const VI down = four_bytes(p.row(1), offset);
  const auto first = [&](VI v) HWY_ATTR { return hn::ConvertTo(d, hn::And(v, byte)); };
  const auto second = [&](VI v) HWY_ATTR { return hn::ConvertTo(d, hn::And(hn::ShiftRight<8>(v), byte)); };
  return blend(blend(first(up), second(up), fx), blend(first(down), second(down), fx), fy);
}

/// Bilinear grey values at places given less half a pixel each way, all of which lie inside by more than arithmetic
/// rounds; pictures of up to two million pixels a side. Rounding to whole numbers happens in the sum with 1.5 * 2^23,
/// whose last bits are the whole number.
HWY_INLINE VF sample_inside(image::ImageView p, const Place& less_half) {
  const DF d;
  const DI di;
  constexpr std::uint32_t kBits = 0x4b400000;  // of that sum for 0
  const VF rounder = hn::Set(d, 12582912.f), half = hn::Set(d, 0.5f);
  const VF x = hn::Add(less_half.x, rounder), y = hn::Add(less_half.y, rounder);
  const VF fx = hn::Add(hn::Sub(less_half.x, hn::Sub(x, rounder)), half);
  const VF fy = hn::Add(hn::Sub(less_half.y, hn::Sub(y, rounder)), half);
  const auto stride = static_cast<std::uint32_t>(p.stride());
  const VI bias = hn::Set(di, static_cast<std::int32_t>(kBits * stride + kBits));
  const VI row = hn::Mul(hn::BitCast(di, y), hn::Set(di, static_cast<std::int32_t>(stride)));
  return blend_at(p, hn::Sub(hn::Add(row, hn::BitCast(di, x)), bias), fx, fy);
}

/// Bilinear grey values; a place outside reads the border. The last pixel itself is read by a hair before it.
HWY_INLINE VF sample(image::ImageView p, const Place& place) {
  const VF half = hn::Set(DF(), 0.5f);
  constexpr float kHair = 1 - 1e-7f;
  return sample_inside(p, {hn::Sub(clamped(place.x, static_cast<float>(p.width() - 1) * kHair), half),
                           hn::Sub(clamped(place.y, static_cast<float>(p.height() - 1) * kHair), half)});
}

}  // namespace pickcell::matches::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
