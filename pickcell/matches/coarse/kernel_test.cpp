#include "pickcell/matches/coarse/kernel.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "pickcell/matches/fit/kernels_test.hpp"

namespace pickcell::matches {
namespace {

TEST(CoarseKernel, EveryHighwayTargetEqualsThePlainLoop) {
  testing::on_every_target([] { testing::KernelJudge().check(highway_kernel(), "Highway"); });
}

/// One number for all machines: amd64 and arm64 compute the same bits.
TEST(CoarseKernel, SameBitsOnEveryMachine) {
  static constexpr std::uint64_t kBits = 16344033895986844421U;
  testing::on_every_target([] { EXPECT_EQ(testing::KernelJudge().fingerprint(highway_kernel()), kBits); });
  EXPECT_EQ(testing::KernelJudge().fingerprint(best_of_four), kBits) << kernel_target();
}

TEST(CoarseKernel, EveryDotProductOfThisMachineEqualsThePlainLoop) {
  int tried = 0;
  for (const NamedKernel& kernel : dot_product_kernels()) {
    if (!kernel.able) continue;
    testing::KernelJudge().check(kernel.run, kernel.name);
    ++tried;
  }
  if (tried == 0) GTEST_SKIP() << "this machine has no dot product of bytes";
}

TEST(CoarseKernel, TheTargetInUseIsTheFirstThatCanRun) {
  for (const NamedKernel& kernel : dot_product_kernels())
    if (kernel.able) {
      EXPECT_EQ(kernel_target(), kernel.name);
      return;
    }
  EXPECT_FALSE(kernel_target().empty());
}

TEST(CoarseKernel, ThePlainLoopIsTheFormula) {
  const std::uint32_t cell = 0xff'00'80'81;  // bytes 0x81, 0x80, 0x00, 0xff: values 1, 0, -128, 127
  const std::vector<std::int32_t> offsets{0};
  std::vector<std::int8_t> weights(16, 0);
  weights[0] = 10, weights[2] = -1, weights[7] = 2;
  FourTemplates t{offsets, weights, {-128 * 9, -128 * 2, 0, 0}, {1, 0.5f, 1, 1}};
  float each[4];
  each_of_four(&cell, t, each);
  EXPECT_EQ(each[0], 10 + 128);
  EXPECT_EQ(each[1], 127);
  EXPECT_EQ(each[2], 0);
}

}  // namespace
}  // namespace pickcell::matches
