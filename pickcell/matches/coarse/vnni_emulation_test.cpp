/// Machines with AVX-512 VNNI are common, those with AVX-VNNI are not: where it is missing, its one instruction is
/// executed here by the handler of the illegal-instruction signal, so that the kernel's own code runs everywhere.

#include <gtest/gtest.h>

#include "pickcell/matches/coarse/kernel.hpp"

#if defined(__x86_64__)

#include <cpuid.h>
#include <signal.h>
#include <ucontext.h>

#include <array>
#include <cstring>
#include <string_view>

#include "pickcell/matches/fit/kernels_test.hpp"

namespace pickcell::matches {
namespace {

using Ymm = std::array<std::uint8_t, 32>;

/// The registers of the interrupted code. The 256-bit ones lie in two parts of the XSAVE area.
class Registers {
 public:
  explicit Registers(void* context) : machine_(static_cast<ucontext_t*>(context)->uc_mcontext) {
    unsigned a = 0, c = 0, d = 0;
    __get_cpuid_count(0xd, 2, &a, &high_halves_, &c, &d);
  }

  greg_t& rip() { return machine_.gregs[REG_RIP]; }
  greg_t general(unsigned number) const {
    constexpr int kOrder[16] = {REG_RAX, REG_RCX, REG_RDX, REG_RBX, REG_RSP, REG_RBP, REG_RSI, REG_RDI,
                                REG_R8,  REG_R9,  REG_R10, REG_R11, REG_R12, REG_R13, REG_R14, REG_R15};
    return machine_.gregs[kOrder[number]];
  }
  Ymm ymm(unsigned number) const {
    Ymm out{};
    std::memcpy(out.data(), low(number), 16);
    if ((*in_use() & kAvx) != 0) std::memcpy(out.data() + 16, high(number), 16);
    return out;
  }
  void set_ymm(unsigned number, const Ymm& value) {
    if ((*in_use() & kAvx) == 0) std::memset(high(0), 0, 256);
    *in_use() |= kAvx;
    std::memcpy(low(number), value.data(), 16);
    std::memcpy(high(number), value.data() + 16, 16);
  }

 private:
  static constexpr std::uint64_t kAvx = 4;
  std::uint8_t* area() const { return reinterpret_cast<std::uint8_t*>(machine_.fpregs); }
  std::uint64_t* in_use() const { return reinterpret_cast<std::uint64_t*>(area() + 512); }
  std::uint8_t* low(unsigned number) const { return area() + 160 + 16 * number; }
  std::uint8_t* high(unsigned number) const { return area() + high_halves_ + 16 * number; }

  mcontext_t& machine_;
  unsigned high_halves_ = 0;
};

/// VEX.256.66.0F38.W0 50 /r: the sum's register, that of the unsigned bytes, the signed ones in a register or memory.
struct Instruction {
  unsigned sum = 0, unsigned_bytes = 0;
  Ymm signed_bytes{};
  int length = 0;  ///< 0: another instruction
};

struct Place {
  const void* address;
  int bytes;  ///< of the instruction, from the ModRM byte on
};

Place memory_operand(const Registers& at, const std::uint8_t* modrm, unsigned base_bit, unsigned index_bit) {
  const unsigned mod = *modrm >> 6, rm = *modrm & 7;
  greg_t address = 0;
  int bytes = 1;
  unsigned base = rm;
  if (rm == 4) {
    const std::uint8_t sib = modrm[1];
    base = sib & 7;
    bytes = 2;
    const unsigned index = (sib >> 3 & 7) | index_bit << 3;
    if (index != 4) address += at.general(index) << (sib >> 6);
  }
  std::int32_t far = 0;
  if (mod == 1) {
    address += static_cast<std::int8_t>(modrm[bytes++]);
  } else if (mod == 2 || base == 5) {
    std::memcpy(&far, modrm + bytes, 4);
    bytes += 4;
    address += far;
  }
  const bool no_base = mod == 0 && base == 5;
  if (!no_base) address += at.general(base | base_bit << 3);
  if (no_base && rm != 4) address += reinterpret_cast<greg_t>(modrm) + bytes;  // from the next instruction
  return {reinterpret_cast<const void*>(address), bytes};
}

Instruction decode(const Registers& at, const std::uint8_t* code) {
  if (code[0] != 0xc4 || (code[1] & 0x1f) != 2 || (code[2] & 0x87) != 5 || code[3] != 0x50) return {};
  const unsigned r = ~code[1] >> 7 & 1U, x = ~code[1] >> 6 & 1U, b = ~code[1] >> 5 & 1U;
  Instruction out;
  out.sum = (code[4] >> 3 & 7U) | r << 3;
  out.unsigned_bytes = ~code[2] >> 3 & 15U;
  if (code[4] >> 6 == 3) {
    out.signed_bytes = at.ymm((code[4] & 7U) | b << 3);
    out.length = 5;
    return out;
  }
  const Place place = memory_operand(at, code + 4, b, x);
  std::memcpy(out.signed_bytes.data(), place.address, out.signed_bytes.size());
  out.length = 4 + place.bytes;
  return out;
}

volatile int emulated = 0;

void execute(int signal_number, siginfo_t*, void* context) {
  Registers at(context);
  const Instruction i = decode(at, reinterpret_cast<const std::uint8_t*>(at.rip()));
  if (i.length == 0) {  // something else is wrong: die of it
    signal(signal_number, SIG_DFL);
    return;
  }
  Ymm sum = at.ymm(i.sum);
  const Ymm u8 = at.ymm(i.unsigned_bytes);
  for (std::size_t lane = 0; lane < 8; ++lane) {
    std::int32_t value;
    std::memcpy(&value, sum.data() + 4 * lane, 4);
    for (std::size_t k = 4 * lane; k < 4 * lane + 4; ++k) value += u8[k] * static_cast<std::int8_t>(i.signed_bytes[k]);
    std::memcpy(sum.data() + 4 * lane, &value, 4);
  }
  at.set_ymm(i.sum, sum);
  at.rip() += i.length;
  emulated = emulated + 1;
}

TEST(CoarseKernel, AvxVnniEqualsThePlainLoop) {
  if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this machine has no registers of 256 bits";
  for (const NamedKernel& kernel : dot_product_kernels()) {
    if (kernel.name != std::string_view("avxvnni")) continue;
    struct sigaction ours{}, before{};
    ours.sa_sigaction = execute;
    ours.sa_flags = SA_SIGINFO;
    ASSERT_EQ(sigaction(SIGILL, &ours, &before), 0);
    emulated = 0;
    testing::KernelJudge().check(kernel.run, kernel.able ? "avxvnni" : "avxvnni, emulated", kernel.able ? 1 : 17);
    sigaction(SIGILL, &before, nullptr);
    EXPECT_EQ(emulated > 0, !kernel.able);
    return;
  }
  FAIL() << "the kernel is missing from this build";
}

}  // namespace
}  // namespace pickcell::matches

#endif
