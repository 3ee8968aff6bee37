#include "pickcell/matches/coarse/kernel.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pickcell/matches/coarse/kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace pickcell::matches::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

// One lane holds no four bytes: the plain loop.
void best_of_four_impl(const CellBlock& c, const FourTemplates& t, float* score, std::ptrdiff_t score_stride) {
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; ++x) {
      float each[4];
      each_of_four(c.origin + y * c.stride + x, t, each);
      score[y * score_stride + x] = std::max(std::max(each[0], each[1]), std::max(each[2], each[3]));
    }
}

#else

#include "pickcell/matches/coarse/kernel-inl.hpp"

// At most 16 lanes: the promise of kKernelBlock.
using D32 = hn::CappedTag<std::int32_t, 16>;
using D16 = hn::Repartition<std::int16_t, D32>;
using DF = hn::Repartition<float, D32>;
using V32 = hn::Vec<D32>;
using V16 = hn::Vec<D16>;

/// Without a dot product of bytes: even and odd bytes as 16-bit numbers, multiplied and added in pairs.
struct PairProducts {
  static constexpr int kLanes = static_cast<int>(hn::MaxLanes(D32()));
  static constexpr int kVectors = HWY_TARGET <= HWY_AVX3 || HWY_ARCH_ARM_A64 ? 4 : 2;
  struct Cells {
    V16 even, odd;
  };
  /// ReorderWidenMulAccumulate splits the products over two sums in a target's own way; RearrangeToOddPlusEven puts
  /// lane i = products 2i and 2i+1 whatever that was; only then is a lane one position's, and the bias may come in.
  struct Sum {
    V32 a, b;
  };
  struct Weights {
    const std::int8_t* four;
  };
  static HWY_INLINE Cells load(const std::uint32_t* cells) {
    const hn::RebindToUnsigned<D16> du;
    const auto v = hn::BitCast(du, hn::LoadU(hn::RebindToUnsigned<D32>(), cells));
    return {hn::BitCast(D16(), hn::And(v, hn::Set(du, 0xff))), hn::BitCast(D16(), hn::ShiftRight<8>(v))};
  }
  static HWY_INLINE Sum start(std::int32_t) { return {hn::Zero(D32()), hn::Zero(D32())}; }
  static HWY_INLINE Weights weights(const std::int8_t* w) { return {w}; }
  template <int a>
  static HWY_INLINE Sum add(Sum s, const Cells& v, const Weights& w) {
    std::int32_t four;
    std::memcpy(&four, w.four + 4 * a, sizeof four);
    const V16 both = hn::BitCast(D16(), hn::Set(D32(), four));
    const V16 odd = hn::ShiftRight<8>(both);
    const V16 even = hn::ShiftRight<8>(hn::ShiftLeft<8>(both));
    s.a = hn::ReorderWidenMulAccumulate(D32(), v.even, even, s.a, s.b);
    s.a = hn::ReorderWidenMulAccumulate(D32(), v.odd, odd, s.a, s.b);
    return s;
  }
  static HWY_INLINE void store_best(const Sum (&four)[4], const FourTemplates& t, float* score) {
    const DF d;
    const auto scaled = [&](int a) HWY_ATTR {
      const V32 whole = hn::RearrangeToOddPlusEven(four[a].a, four[a].b);
      return hn::Mul(hn::ConvertTo(d, hn::Add(whole, hn::Set(D32(), t.bias[a]))), hn::Set(d, t.norm[a]));
    };
    hn::StoreU(hn::Max(hn::Max(scaled(0), scaled(1)), hn::Max(scaled(2), scaled(3))), d, score);
  }
};

void best_of_four_impl(const CellBlock& c, const FourTemplates& t, float* score, std::ptrdiff_t score_stride) {
  score_block<PairProducts>(c, t, score, score_stride);
}

#endif

std::int64_t target_impl() { return HWY_TARGET; }

}  // namespace pickcell::matches::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pickcell::matches {

HWY_EXPORT(best_of_four_impl);
HWY_EXPORT(target_impl);

namespace {

void run_highway(const CellBlock& c, const FourTemplates& t, float* score, std::ptrdiff_t score_stride) {
  HWY_DYNAMIC_DISPATCH(best_of_four_impl)(c, t, score, score_stride);
}

NamedKernel choose() {
  for (const NamedKernel& k : dot_product_kernels())
    if (k.able) return k;
  return {nullptr, run_highway, true};
}

const NamedKernel& chosen() {
  static const NamedKernel kernel = choose();
  return kernel;
}

}  // namespace

CoarseKernel highway_kernel() { return run_highway; }

std::vector<NamedKernel> dot_product_kernels() {
  std::vector<NamedKernel> all = detail::vnni_kernels();
  for (const NamedKernel& k : detail::neon_dot_kernels()) all.push_back(k);
  return all;
}

std::string kernel_target() {
  std::string name = chosen().name ? chosen().name : hwy::TargetName(HWY_DYNAMIC_DISPATCH(target_impl)());
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

void best_of_four(const CellBlock& cells, const FourTemplates& templates, float* score, std::ptrdiff_t score_stride) {
  chosen().run(cells, templates, score, score_stride);
}

void each_of_four(const std::uint32_t* cell, const FourTemplates& t, float (&score)[4]) {
  std::int32_t sum[4];
  std::copy(t.bias, t.bias + 4, sum);
  for (std::size_t k = 0; k < t.offsets.size(); ++k) {
    std::uint8_t v[4];
    std::memcpy(v, cell + t.offsets[k], sizeof v);
    const std::int8_t* w = t.weights.data() + 16 * k;
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t i = 0; i < 4; ++i) sum[a] += v[i] * w[4 * a + i];
  }
  for (int a = 0; a < 4; ++a) score[a] = static_cast<float>(sum[a]) * t.norm[a];
}

}  // namespace pickcell::matches
#endif
