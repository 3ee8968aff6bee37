// Reading pictures at scattered places, for files that are compiled once per SIMD target (hence the guard of Highway).

#if defined(PICKCELL_MATCHES_GATHER_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef PICKCELL_MATCHES_GATHER_INL_HPP
#undef PICKCELL_MATCHES_GATHER_INL_HPP
#else
#define PICKCELL_MATCHES_GATHER_INL_HPP
#endif

#include <hwy/highway.h>

#include <cstdint>

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

/// The pixel up and to the left of a place, and the way from there, 0..1.
struct Corner {
  VI x, y;
  VF fx, fy;
};

/// Of places given less half a pixel each way, all of which lie inside by more than arithmetic rounds; pictures of up
/// to two million pixels a side. Rounding to whole numbers happens in the sum with 1.5 * 2^23, whose last bits are the
/// whole number.
HWY_INLINE Corner corner_inside(const Place& less_half) {
  const DF d;
  const DI di;
  const VF rounder = hn::Set(d, 12582912.f), half = hn::Set(d, 0.5f);
  const VI bits = hn::Set(di, 0x4b400000);  // of that sum for 0
  const VF x = hn::Add(less_half.x, rounder), y = hn::Add(less_half.y, rounder);
  return {hn::Sub(hn::BitCast(di, x), bits), hn::Sub(hn::BitCast(di, y), bits),
          hn::Add(hn::Sub(less_half.x, hn::Sub(x, rounder)), half),
          hn::Add(hn::Sub(less_half.y, hn::Sub(y, rounder)), half)};
}

/// A place outside stands for the border; the last pixel itself is read by a hair before it.
HWY_INLINE Corner corner_of(const Place& p, int width, int height) {
  constexpr float kHair = 1 - 1e-7f;
  const VF half = hn::Set(DF(), 0.5f);
  return corner_inside({hn::Sub(clamped(p.x, static_cast<float>(width - 1) * kHair), half),
                        hn::Sub(clamped(p.y, static_cast<float>(height - 1) * kHair), half)});
}

/// Four bytes from each place.
HWY_INLINE VI four_bytes(const void* base, VI offset) {
  return hn::GatherOffset(DI(), static_cast<const std::int32_t*>(base), offset);
}

HWY_INLINE VF blend(VF a, VF b, VF f) { return hn::MulAdd(f, hn::Sub(b, a), a); }

/// Bilinear grey values.
HWY_INLINE VF sample_at(image::ImageView p, const Corner& c) {
  const DI di;
  const DF d;
  const VI offset = hn::Add(hn::Mul(c.y, hn::Set(di, static_cast<std::int32_t>(p.stride()))), c.x);
  const VI byte = hn::Set(di, 255);
  const VI up = four_bytes(p.row(0), offset);
  const VI down = four_bytes(p.row(1), offset);
  const auto first = [&](VI v) HWY_ATTR { return hn::ConvertTo(d, hn::And(v, byte)); };
  const auto second = [&](VI v) HWY_ATTR { return hn::ConvertTo(d, hn::And(hn::ShiftRight<8>(v), byte)); };
  return blend(blend(first(up), second(up), c.fx), blend(first(down), second(down), c.fx), c.fy);
}

HWY_INLINE VF sample(image::ImageView p, const Place& place) {
  return sample_at(p, corner_of(place, p.width(), p.height()));
}

/// As corner_inside wants its places.
HWY_INLINE VF sample_inside(image::ImageView p, const Place& less_half) {
  return sample_at(p, corner_inside(less_half));
}

}  // namespace pickcell::matches::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
