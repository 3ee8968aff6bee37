#include "pickcell/matches/rst/radial_kernels.hpp"

#include "pickcell/matches/rst/kernels.hpp"

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pickcell/matches/rst/radial_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace pickcell::matches::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

void dots_impl(const std::int16_t* a, const std::int16_t* b, int count, std::span<const int> starts,
               std::int32_t* out) {
  plain::dots(a, b, count, starts, out);
}
void stepped_dots_impl(const std::int16_t* a, const std::int16_t* b, int pairs, int count, std::int32_t* out) {
  plain::stepped_dots(a, b, pairs, count, out);
}

#else

// At most 32 lanes of 16 bits: the promise of kRstBlock and kStepBlock.
using D16 = hn::CappedTag<std::int16_t, kRstBlock>;
using D32 = hn::Repartition<std::int32_t, D16>;

void dots_impl(const std::int16_t* a, const std::int16_t* b, int count, std::span<const int> starts,
               std::int32_t* out) {
  const D16 d;
  const D32 d32;
  for (std::size_t s = 0; s < starts.size(); ++s) {
    auto even = hn::Zero(d32), odd = hn::Zero(d32);
    for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(d)))
      even = hn::ReorderWidenMulAccumulate(d32, hn::LoadU(d, a + i), hn::LoadU(d, b + starts[s] + i), even, odd);
    out[s] = hn::GetLane(hn::SumOfLanes(d32, hn::Add(even, odd)));
  }
}

/// sum + a[0] * b[0] + a[1] * b[1] for each pair of neighbours.
template <class V32>
HWY_INLINE V32 add_pairs(V32 sum, V32 a, V32 b) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_EMU128
  const D16 d;
  auto unused = hn::Zero(D32());
  return hn::ReorderWidenMulAccumulate(D32(), hn::BitCast(d, a), hn::BitCast(d, b), sum, unused);
#else
  const auto first = [](V32 v) HWY_ATTR { return hn::ShiftRight<16>(hn::ShiftLeft<16>(v)); };
  const auto products = hn::Mul(hn::ShiftRight<16>(a), hn::ShiftRight<16>(b));
  return hn::Add(hn::Add(sum, products), hn::Mul(first(a), first(b)));
#endif
}

void stepped_dots_impl(const std::int16_t* a, const std::int16_t* b, int pairs, int count, std::int32_t* out) {
  const D32 d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto pair_at = [](const std::int16_t* p) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::uint16_t>(p[1])) << 16 |
                                     static_cast<std::uint16_t>(p[0]));
  };
  for (int t = 0; t < count; t += lanes) {
    auto even = hn::Zero(d), odd = hn::Zero(d);
    const std::int16_t* from = b + 2 * t;
    const auto turn = [&](int p) HWY_ATTR { return hn::BitCast(d, hn::LoadU(D16(), from + 2 * p)); };
    int p = 0;
    for (; p + 2 <= pairs; p += 2) {
      even = add_pairs(even, hn::Set(d, pair_at(a + 2 * p)), turn(p));
      odd = add_pairs(odd, hn::Set(d, pair_at(a + 2 * p + 2)), turn(p + 1));
    }
    if (p < pairs) even = add_pairs(even, hn::Set(d, pair_at(a + 2 * p)), turn(p));
    hn::StoreU(hn::Add(even, odd), d, out + t);
  }
}

#endif

}  // namespace pickcell::matches::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pickcell::matches {

HWY_EXPORT(dots_impl);
HWY_EXPORT(stepped_dots_impl);

void dots(const std::int16_t* a, const std::int16_t* b, int count, std::span<const int> starts, std::int32_t* out) {
  HWY_DYNAMIC_DISPATCH(dots_impl)(a, b, count, starts, out);
}

void stepped_dots(const std::int16_t* a, const std::int16_t* b, int pairs, int count, std::int32_t* out) {
  HWY_DYNAMIC_DISPATCH(stepped_dots_impl)(a, b, pairs, count, out);
}

namespace plain {

void dots(const std::int16_t* a, const std::int16_t* b, int count, std::span<const int> starts, std::int32_t* out) {
  for (std::size_t s = 0; s < starts.size(); ++s) {
    out[s] = 0;
    for (int i = 0; i < count; ++i) out[s] += a[i] * b[starts[s] + i];
  }
}

void stepped_dots(const std::int16_t* a, const std::int16_t* b, int pairs, int count, std::int32_t* out) {
  for (int t = 0; t < count; ++t) {
    out[t] = 0;
    for (int j = 0; j < 2 * pairs; ++j) out[t] += a[j] * b[2 * t + j];
  }
}

}  // namespace plain
}  // namespace pickcell::matches
#endif
