// vpdpbusd on 512 bits: four byte products added to each 32-bit sum in one instruction (Intel: Ice Lake server and
// later; AMD: Zen 4 and later). Highway 1.0.3 has no operation for it.
#include "pickcell/matches/coarse_kernel.hpp"

#include <hwy/base.h>

#include <cstring>

#if HWY_ARCH_X86_64

#include <immintrin.h>

#if HWY_COMPILER_GCC_ACTUAL
// GCC 12's own intrinsics start from an undefined register on purpose and are then warned about.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

namespace pickcell::matches {
namespace {

HWY_PUSH_ATTRIBUTES("avx512f,avx512bw,avx512vl,avx512vnni")

#include "pickcell/matches/coarse_kernel-inl.hpp"

struct Avx512Vnni {
  static constexpr int kLanes = 16;
  static constexpr int kVectors = 6;
  using Cells = __m512i;
  using Sum = __m512i;
  using Weights = const std::int8_t*;
  static HWY_INLINE Cells load(const std::uint32_t* cells) { return _mm512_loadu_si512(cells); }
  static HWY_INLINE Sum start(std::int32_t bias) { return _mm512_set1_epi32(bias); }
  static HWY_INLINE Weights weights(const std::int8_t* w) { return w; }
  template <int a>
  static HWY_INLINE Sum add(Sum s, Cells v, Weights w) {
    std::int32_t four;
    std::memcpy(&four, w + 4 * a, sizeof four);
    return _mm512_dpbusd_epi32(s, v, _mm512_set1_epi32(four));
  }
  static HWY_INLINE __m512 scaled(Sum s, float norm) {
    return _mm512_mul_ps(_mm512_cvtepi32_ps(s), _mm512_set1_ps(norm));
  }
  static HWY_INLINE void store_best(const Sum (&four)[4], const float* norm, float* score) {
    const __m512 low = _mm512_max_ps(scaled(four[0], norm[0]), scaled(four[1], norm[1]));
    const __m512 high = _mm512_max_ps(scaled(four[2], norm[2]), scaled(four[3], norm[3]));
    _mm512_storeu_ps(score, _mm512_max_ps(low, high));
  }
};

void run(const CellBlock& c, const FourTemplates& t, float* score, std::ptrdiff_t score_stride) {
  score_block<Avx512Vnni>(c, t, score, score_stride);
}

HWY_POP_ATTRIBUTES

}  // namespace

CoarseKernel detail::avx512vnni_kernel() {
  __builtin_cpu_init();
  const bool able = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                    __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512vnni");
  return able ? run : nullptr;
}

}  // namespace pickcell::matches

#else

pickcell::matches::CoarseKernel pickcell::matches::detail::avx512vnni_kernel() { return nullptr; }

#endif
