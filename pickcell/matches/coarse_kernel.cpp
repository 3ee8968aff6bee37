#include "pickcell/matches/coarse_kernel.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pickcell/matches/coarse_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace pickcell::matches::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

// One lane holds no pair: the plain loop.
void best_of_four_impl(const std::int16_t* pairs, const FourTemplates& t, int n, float* score) {
  for (int i = 0; i < n; ++i) {
    float each[4];
    each_of_four(pairs + 2 * i, t, each);
    score[i] = std::max(std::max(each[0], each[1]), std::max(each[2], each[3]));
  }
}

#else

// At most 16 lanes: the promise of kKernelBlock.
using D32 = hn::CappedTag<std::int32_t, 16>;
using D16 = hn::Repartition<std::int16_t, D32>;
using DF = hn::Repartition<float, D32>;
using V32 = hn::Vec<D32>;

/// Sum of products of neighbouring 16-bit lanes, added up in 32 bits. ReorderWidenMulAccumulate splits the products
/// over two sums in a target's own way; RearrangeToOddPlusEven puts lane i = products 2i and 2i+1 whatever that was.
struct PairSum {
  V32 a, b;
  HWY_INLINE void clear() { a = b = hn::Zero(D32()); }
  template <class V16>
  HWY_INLINE void add(V16 values, V16 weights) {
    a = hn::ReorderWidenMulAccumulate(D32(), values, weights, a, b);
  }
  HWY_INLINE hn::Vec<DF> scaled(float norm) const {
    return hn::Mul(hn::ConvertTo(DF(), hn::RearrangeToOddPlusEven(a, b)), hn::Set(DF(), norm));
  }
};

template <class V16>
HWY_INLINE V16 weight_pair(const std::int16_t* w) {
  std::int32_t both;
  std::memcpy(&both, w, sizeof both);
  return hn::BitCast(D16(), hn::Set(D32(), both));
}

/// kVectors vectors of positions times four templates: eight or four accumulators stay in registers.
template <int kVectors>
HWY_INLINE void block(const std::int16_t* pairs, const FourTemplates& t, float* score) {
  const D16 d16;
  const DF df;
  using V16 = hn::Vec<D16>;
  const std::size_t lanes = hn::Lanes(df);
  PairSum sum[kVectors][4];
  for (auto& of_vector : sum)
    for (PairSum& s : of_vector) s.clear();
  const std::size_t taps = t.offsets.size();
  const std::int16_t* w = t.weights.data();
  for (std::size_t k = 0; k < taps; ++k, w += 8) {
    const std::int16_t* p = pairs + 2 * t.offsets[k];
    V16 v[kVectors];
    for (int i = 0; i < kVectors; ++i) v[i] = hn::LoadU(d16, p + 2 * static_cast<std::size_t>(i) * lanes);
    for (int a = 0; a < 4; ++a) {
      const V16 wa = weight_pair<V16>(w + 2 * a);
      for (int i = 0; i < kVectors; ++i) sum[i][a].add(v[i], wa);
    }
  }
  for (int i = 0; i < kVectors; ++i) {
    auto best = sum[i][0].scaled(t.norm[0]);
    for (int a = 1; a < 4; ++a) best = hn::Max(best, sum[i][a].scaled(t.norm[a]));
    hn::StoreU(best, df, score + static_cast<std::size_t>(i) * lanes);
  }
}

void best_of_four_impl(const std::int16_t* pairs, const FourTemplates& t, int n, float* score) {
  const int lanes = static_cast<int>(hn::Lanes(DF()));
  int i = 0;
  for (; i + lanes < n; i += 2 * lanes) block<2>(pairs + 2 * i, t, score + i);
  if (i < n) block<1>(pairs + 2 * i, t, score + i);
}

#endif

std::int64_t target_impl() { return HWY_TARGET; }

}  // namespace pickcell::matches::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pickcell::matches {

HWY_EXPORT(best_of_four_impl);
HWY_EXPORT(target_impl);

std::string kernel_target() {
  std::string name = hwy::TargetName(HWY_DYNAMIC_DISPATCH(target_impl)());
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

void best_of_four(const std::int16_t* pairs, const FourTemplates& templates, int n, float* score) {
  HWY_DYNAMIC_DISPATCH(best_of_four_impl)(pairs, templates, n, score);
}

void each_of_four(const std::int16_t* pairs, const FourTemplates& t, float (&score)[4]) {
  std::int32_t sum[4] = {};
  for (std::size_t k = 0; k < t.offsets.size(); ++k) {
    const std::int16_t* v = pairs + 2 * t.offsets[k];
    const std::int16_t* w = t.weights.data() + 8 * k;
    for (int a = 0; a < 4; ++a) sum[a] += v[0] * w[2 * a] + v[1] * w[2 * a + 1];
  }
  for (int a = 0; a < 4; ++a) score[a] = static_cast<float>(sum[a]) * t.norm[a];
}

}  // namespace pickcell::matches
#endif
