// vpdpbusd on 256 bits without AVX-512 (Intel: Alder Lake and later, also the small cores; AMD: Zen 5). Highway 1.0.3
// does not know it.
#include "pickcell/matches/coarse_kernel.hpp"

#include <hwy/base.h>

#include <cstring>

#if HWY_ARCH_X86_64

#include <cpuid.h>
#include <immintrin.h>

namespace pickcell::matches {
namespace {

HWY_PUSH_ATTRIBUTES("avx,avx2,avxvnni")

#include "pickcell/matches/coarse_kernel-inl.hpp"

struct AvxVnni {
  static constexpr int kLanes = 8;
  static constexpr int kVectors = 3;  // 12 sums, 3 cells, one weight: 16 registers
  using Cells = __m256i;
  using Sum = __m256i;
  using Weights = const std::int8_t*;
  static HWY_INLINE Cells load(const std::uint32_t* cells) {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(cells));
  }
  static HWY_INLINE Sum start(std::int32_t bias) { return _mm256_set1_epi32(bias); }
  static HWY_INLINE Weights weights(const std::int8_t* w) { return w; }
  template <int a>
  static HWY_INLINE Sum add(Sum s, Cells v, Weights w) {
    std::int32_t four;
    std::memcpy(&four, w + 4 * a, sizeof four);
    return _mm256_dpbusd_avx_epi32(s, v, _mm256_set1_epi32(four));
  }
  static HWY_INLINE __m256 scaled(Sum s, float norm) {
    return _mm256_mul_ps(_mm256_cvtepi32_ps(s), _mm256_set1_ps(norm));
  }
  static HWY_INLINE void store_best(const Sum (&four)[4], const float* norm, float* score) {
    const __m256 low = _mm256_max_ps(scaled(four[0], norm[0]), scaled(four[1], norm[1]));
    const __m256 high = _mm256_max_ps(scaled(four[2], norm[2]), scaled(four[3], norm[3]));
    _mm256_storeu_ps(score, _mm256_max_ps(low, high));
  }
};

void run(const CellBlock& c, const FourTemplates& t, float* score, std::ptrdiff_t score_stride) {
  score_block<AvxVnni>(c, t, score, score_stride);
}

HWY_POP_ATTRIBUTES

/// CPUID leaf 7, subleaf 1, EAX bit 4; whether the system saves the wide registers is what "avx2" answers.
bool able() {
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("avx2")) return false;
  unsigned a = 0, b = 0, c = 0, d = 0;
  if (!__get_cpuid_count(7, 0, &a, &b, &c, &d) || a < 1) return false;
  return __get_cpuid_count(7, 1, &a, &b, &c, &d) != 0 && (a >> 4 & 1U) != 0;
}

}  // namespace

CoarseKernel detail::avxvnni_kernel() { return able() ? run : nullptr; }

}  // namespace pickcell::matches

#else

pickcell::matches::CoarseKernel pickcell::matches::detail::avxvnni_kernel() { return nullptr; }

#endif
