#include "pickcell/matches/coarse_kernel.hpp"

#include <gtest/gtest.h>

#include <vector>

#include <hwy/highway.h>

#include "pickcell/matches/test_kernels.hpp"

namespace pickcell::matches {
namespace {

TEST(CoarseKernel, EveryHighwayTargetEqualsThePlainLoop) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    testing::KernelJudge().check(highway_kernel(), hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(0);
  }
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
