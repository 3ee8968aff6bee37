// sdot of Armv8.2 (Cortex-A55/A75 and later: Orin's A78AE, Raspberry Pi 5). Highway 1.0.3 has no target for it; a
// Cortex-A57 or A72 has none and runs Highway's kernel.
#include "pickcell/matches/coarse/kernel.hpp"

#include <hwy/base.h>

#include <cstring>

#if HWY_ARCH_ARM_A64

#include <arm_neon.h>
#include <sys/auxv.h>

namespace pickcell::matches {
namespace {

#if HWY_COMPILER_CLANG
HWY_PUSH_ATTRIBUTES("dotprod")
#else
HWY_PUSH_ATTRIBUTES("arch=armv8.2-a+dotprod")
#endif

#include "pickcell/matches/coarse/kernel-inl.hpp"

struct NeonDot {
  static constexpr int kLanes = 4;
  static constexpr int kVectors = 6;  // 24 sums, 6 cells, one weight: 31 of 32 registers
  using Cells = int8x16_t;
  using Sum = int32x4_t;
  using Weights = int8x16_t;
  /// The bias of 128 taken off: flipping the top bit makes the unsigned byte signed.
  static HWY_INLINE Cells load(const std::uint32_t* cells) {
    return vreinterpretq_s8_u8(veorq_u8(vreinterpretq_u8_u32(vld1q_u32(cells)), vdupq_n_u8(0x80)));
  }
  static HWY_INLINE Sum start(std::int32_t) { return vdupq_n_s32(0); }
  static HWY_INLINE Weights weights(const std::int8_t* w) { return vld1q_s8(w); }
  template <int a>
  static HWY_INLINE Sum add(Sum s, Cells v, Weights w) {
    return vdotq_laneq_s32(s, v, w, a);
  }
  static HWY_INLINE float32x4_t scaled(Sum s, float norm) { return vmulq_n_f32(vcvtq_f32_s32(s), norm); }
  static HWY_INLINE void store_best(const Sum (&four)[4], const FourTemplates& t, float* score) {
    const float32x4_t low = vmaxq_f32(scaled(four[0], t.norm[0]), scaled(four[1], t.norm[1]));
    const float32x4_t high = vmaxq_f32(scaled(four[2], t.norm[2]), scaled(four[3], t.norm[3]));
    vst1q_f32(score, vmaxq_f32(low, high));
  }
};

void run(const CellBlock& c, const FourTemplates& t, float* score, std::ptrdiff_t score_stride) {
  score_block<NeonDot>(c, t, score, score_stride);
}

HWY_POP_ATTRIBUTES

constexpr unsigned long kHwcapAsimdDp = 1UL << 20;  // <asm/hwcap.h>: HWCAP_ASIMDDP

}  // namespace

std::vector<NamedKernel> detail::neon_dot_kernels() {
  return {{"neon-dotprod", run, (getauxval(AT_HWCAP) & kHwcapAsimdDp) != 0}};
}

}  // namespace pickcell::matches

#else

std::vector<pickcell::matches::NamedKernel> pickcell::matches::detail::neon_dot_kernels() { return {}; }

#endif
