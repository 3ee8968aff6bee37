// Reading pictures at scattered places, for files that are compiled once per SIMD target (hence the guard of Highway).

#if defined(PICKCELL_MATCHES_GATHER_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef PICKCELL_MATCHES_GATHER_INL_HPP
#undef PICKCELL_MATCHES_GATHER_INL_HPP
#else
#define PICKCELL_MATCHES_GATHER_INL_HPP
#endif

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

/// Bilinear grey values; a place outside reads the border.
HWY_INLINE VF sample(image::ImageView p, const Place& place) {
  const DI di;
  const DF d;
  const Corner c = corner_of(place, p.width(), p.height());
  const VI offset = hn::Add(hn::Mul(c.y, hn::Set(di, static_cast<std::int32_t>(p.stride()))), c.x);
  const VI byte = hn::Set(di, 255);
  const VI up = four_bytes(p.row(0), offset);
  const VI down = four_bytes(p.row(1), offset);
  const auto first = [&](VI v) HWY_ATTR { return hn::ConvertTo(d, hn::And(v, byte)); };
  const auto second = [&](VI v) HWY_ATTR { return hn::ConvertTo(d, hn::And(hn::ShiftRight<8>(v), byte)); };
  return blend(blend(first(up), second(up), c.fx), blend(first(down), second(down), c.fx), c.fy);
}

}  // namespace pickcell::matches::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
