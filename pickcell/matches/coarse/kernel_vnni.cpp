// vpdpbusd: four byte products added to each 32-bit sum in one instruction. Highway 1.0.3 has no operation for it. It
// comes in two encodings: AVX-512 VNNI (Intel: Ice Lake and later servers; AMD: Zen 4 and later), and AVX-VNNI without
// AVX-512 (Intel: Alder Lake and later, also the small cores; AMD: Zen 5).
#include "pickcell/matches/coarse/kernel.hpp"

#include <hwy/base.h>

#include <cstring>

#if HWY_ARCH_X86_64

#include <cpuid.h>
#include <immintrin.h>

namespace pickcell::matches {
namespace {

HWY_PUSH_ATTRIBUTES("avx512f,avx512bw,avx512vl,avx512vnni")
namespace avx512vnni {
#include "pickcell/matches/coarse/kernel-inl.hpp"
struct Dot {
  static constexpr int kBytes = 64;
  static constexpr int kVectors = 6;  // 24 sums, 6 cells, one weight: 31 of 32 registers
  typedef std::int32_t Words __attribute__((vector_size(kBytes)));
  static HWY_INLINE Words dot(Words sum, Words u8, Words s8) {
    return reinterpret_cast<Words>(_mm512_dpbusd_epi32(reinterpret_cast<__m512i>(sum), reinterpret_cast<__m512i>(u8),
                                                       reinterpret_cast<__m512i>(s8)));
  }
};
#include "pickcell/matches/coarse/vnni_kernel-inl.hpp"
}  // namespace avx512vnni
HWY_POP_ATTRIBUTES

HWY_PUSH_ATTRIBUTES("avx,avx2,avxvnni")
namespace avxvnni {
#include "pickcell/matches/coarse/kernel-inl.hpp"
struct Dot {
  static constexpr int kBytes = 32;
  static constexpr int kVectors = 3;  // 12 sums, 3 cells, one weight: 16 registers
  typedef std::int32_t Words __attribute__((vector_size(kBytes)));
  static HWY_INLINE Words dot(Words sum, Words u8, Words s8) {
    return reinterpret_cast<Words>(_mm256_dpbusd_avx_epi32(
        reinterpret_cast<__m256i>(sum), reinterpret_cast<__m256i>(u8), reinterpret_cast<__m256i>(s8)));
  }
};
#include "pickcell/matches/coarse/vnni_kernel-inl.hpp"
}  // namespace avxvnni
HWY_POP_ATTRIBUTES

bool has_avx512vnni() {
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512vnni");
}

/// CPUID leaf 7, subleaf 1, EAX bit 4; whether the system saves the wide registers is what "avx2" answers.
bool has_avxvnni() {
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("avx2")) return false;
  unsigned a = 0, b = 0, c = 0, d = 0;
  if (!__get_cpuid_count(7, 0, &a, &b, &c, &d) || a < 1) return false;
  return __get_cpuid_count(7, 1, &a, &b, &c, &d) != 0 && (a >> 4 & 1U) != 0;
}

}  // namespace

std::vector<NamedKernel> detail::vnni_kernels() {
  return {{"avx512vnni", avx512vnni::run, has_avx512vnni()}, {"avxvnni", avxvnni::run, has_avxvnni()}};
}

}  // namespace pickcell::matches

#else

std::vector<pickcell::matches::NamedKernel> pickcell::matches::detail::vnni_kernels() { return {}; }

#endif
