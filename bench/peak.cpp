#include "peak.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <map>

// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "peak.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

// Loops over sums are unrolled so that these stay in registers. The compiler must not know what a register holds, or it
// would take the work out of the loop.
#ifndef PICKCELL_HIDE
#if HWY_ARCH_ARM
#define PICKCELL_HIDE(v) asm volatile("" : "+w"(v))
#else
#define PICKCELL_HIDE(v) asm volatile("" : "+v"(v))
#endif
#endif

HWY_BEFORE_NAMESPACE();
namespace pickcell::bench::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<DF>;
constexpr int kChains = 8;  // independent sums: more than an instruction's latency

// Each returns how many of its items `rounds` rounds made.

double steps_impl(int rounds) {
  const DF d;
  auto x = hn::Set(d, 1.f), y = hn::Set(d, 0.5f);
  hn::Vec<DF> sum[kChains];
#pragma GCC unroll 16
  for (auto& s : sum) s = hn::Zero(d);
  for (int i = 0; i < rounds; ++i)
#pragma GCC unroll 16
    for (auto& s : sum) {
      s = hn::MulAdd(x, y, s);
      PICKCELL_HIDE(s.raw);
    }
  return static_cast<double>(rounds) * kChains * static_cast<double>(hn::Lanes(d));
}

double reads_impl(int rounds) {
  alignas(64) static std::array<std::int32_t, 256> table{};
  const DI d;
  auto at = hn::And(hn::Mul(hn::Iota(d, 1), hn::Set(d, 36)), hn::Set(d, 1020));
  hn::Vec<DI> sum[4];
#pragma GCC unroll 16
  for (auto& s : sum) s = hn::Zero(d);
  for (int i = 0; i < rounds; ++i)
#pragma GCC unroll 16
    for (auto& s : sum) {
      PICKCELL_HIDE(at.raw);
      s = hn::Add(s, hn::GatherOffset(d, table.data(), at));
      PICKCELL_HIDE(s.raw);
    }
  return static_cast<double>(rounds) * 4 * static_cast<double>(hn::Lanes(d));
}

#if HWY_TARGET == HWY_SCALAR

double products_impl(int rounds) {
  int x = 3;
  int sum[kChains] = {};
  for (int i = 0; i < rounds; ++i)
#pragma GCC unroll 16
    for (int& s : sum) {
      asm volatile("" : "+r"(x));
      s += x * 5;
      asm volatile("" : "+r"(s));
    }
  return static_cast<double>(rounds) * kChains;
}

#else

double products_impl(int rounds) {
  const hn::Repartition<std::int16_t, DI> d16;
  auto x = hn::Set(d16, std::int16_t{100});
  const auto y = hn::Set(d16, std::int16_t{3});
  hn::Vec<DI> sum[kChains], other[kChains];
#pragma GCC unroll 16
  for (int k = 0; k < kChains; ++k) sum[k] = other[k] = hn::Zero(DI());
  for (int i = 0; i < rounds; ++i)
#pragma GCC unroll 16
    for (int k = 0; k < kChains; ++k) {
      PICKCELL_HIDE(x.raw);
      sum[k] = hn::ReorderWidenMulAccumulate(DI(), x, y, sum[k], other[k]);
      PICKCELL_HIDE(sum[k].raw);
    }
#pragma GCC unroll 16
  for (auto& s : other) PICKCELL_HIDE(s.raw);
  return static_cast<double>(rounds) * kChains * static_cast<double>(hn::Lanes(d16));
}

#endif

}  // namespace pickcell::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#if HWY_ARCH_X86_64
#include <immintrin.h>
#elif HWY_ARCH_ARM_A64
#include <arm_neon.h>
#endif

namespace pickcell::bench {

HWY_EXPORT(steps_impl);
HWY_EXPORT(reads_impl);
HWY_EXPORT(products_impl);

namespace {

constexpr int kDots = 16;

#if HWY_ARCH_X86_64

HWY_PUSH_ATTRIBUTES("avx512f,avx512bw,avx512vl,avx512vnni")
double dots_of_512(int rounds) {
  const __m512i x = _mm512_set1_epi8(3);
  __m512i sum[kDots];
#pragma GCC unroll 16
  for (auto& s : sum) s = _mm512_setzero_si512();
  for (int i = 0; i < rounds; ++i)
#pragma GCC unroll 16
    for (auto& s : sum) {
      s = _mm512_dpbusd_epi32(s, x, x);
      asm volatile("" : "+v"(s));
    }
  return 64.0 * kDots * rounds;
}
HWY_POP_ATTRIBUTES

HWY_PUSH_ATTRIBUTES("avx2,avxvnni")
double dots_of_256(int rounds) {
  const __m256i x = _mm256_set1_epi8(3);
  __m256i sum[kDots];
#pragma GCC unroll 16
  for (auto& s : sum) s = _mm256_setzero_si256();
  for (int i = 0; i < rounds; ++i)
#pragma GCC unroll 16
    for (auto& s : sum) {
      s = _mm256_dpbusd_avx_epi32(s, x, x);
      asm volatile("" : "+v"(s));
    }
  return 32.0 * kDots * rounds;
}
HWY_POP_ATTRIBUTES

#elif HWY_ARCH_ARM_A64

HWY_PUSH_ATTRIBUTES("arch=armv8.2-a+dotprod")
double dots_of_neon(int rounds) {
  const int8x16_t x = vdupq_n_s8(3);
  int32x4_t sum[kDots];
#pragma GCC unroll 16
  for (auto& s : sum) s = vdupq_n_s32(0);
  for (int i = 0; i < rounds; ++i)
#pragma GCC unroll 16
    for (auto& s : sum) {
      s = vdotq_s32(s, x, x);
      asm volatile("" : "+w"(s));
    }
  return 16.0 * kDots * rounds;
}
HWY_POP_ATTRIBUTES

#endif

double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Best of several tries: what else runs on the machine makes it slower, never faster.
template <class Loop>
double rate(const Loop& loop) {
  constexpr int kRounds = 200'000;
  double best = 0;
  for (int i = 0; i < 7; ++i) {
    const double start = thread_cpu_s();
    const double items = loop(kRounds);
    best = std::max(best, items / (thread_cpu_s() - start));
  }
  return best;
}

}  // namespace

const Peak& peak_of(std::int64_t highway_target) {
  static std::map<std::int64_t, Peak> known;
  const auto found = known.find(highway_target);
  if (found != known.end()) return found->second;
  hwy::SetSupportedTargetsForTest(highway_target);
  const Peak peak{rate([](int n) { return HWY_DYNAMIC_DISPATCH(products_impl)(n); }),
                  rate([](int n) { return HWY_DYNAMIC_DISPATCH(steps_impl)(n); }),
                  rate([](int n) { return HWY_DYNAMIC_DISPATCH(reads_impl)(n); })};
  hwy::SetSupportedTargetsForTest(0);
  return known[highway_target] = peak;
}

double dot_product_peak(const std::string& kernel) {
#if HWY_ARCH_X86_64
  if (kernel == "avx512vnni") return rate(dots_of_512);
  if (kernel == "avxvnni") return rate(dots_of_256);
#elif HWY_ARCH_ARM_A64
  if (kernel == "neon-dotprod") return rate(dots_of_neon);
#endif
  return 0;
}

}  // namespace pickcell::bench
#endif
