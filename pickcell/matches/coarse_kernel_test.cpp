#include "pickcell/matches/coarse_kernel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include <hwy/highway.h>

namespace pickcell::matches {
namespace {

/// Random scenes, weights and shapes; every score must have the plain loop's bits.
class Judge {
 public:
  Judge() : cells_(kSide * kSide) {
    for (auto& c : cells_) c = static_cast<std::uint32_t>(rng_());
  }

  void check(CoarseKernel kernel, const std::string& name) {
    for (int width = 1; width <= 70; ++width) {
      const int height = 1 + width % 7;
      make_templates(width % 9 == 0 ? 0 : 1 + 3 * width);
      const CellBlock block{cells_.data() + 20 * kSide + 20 + width % 5, kSide, width, height};
      const std::ptrdiff_t stride = width + kKernelBlock;
      std::vector<float> score(static_cast<std::size_t>(stride * height), -7.f);
      kernel(block, four_, score.data(), stride);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          float each[4];
          each_of_four(block.origin + y * kSide + x, four_, each);
          ASSERT_EQ(score[static_cast<std::size_t>(y * stride + x)], *std::max_element(each, each + 4))
              << name << ", width " << width << " at " << x << ", " << y;
        }
    }
  }

 private:
  static constexpr int kSide = 160;

  void make_templates(int taps) {
    std::uniform_int_distribution<int> value(-127, 127);
    std::uniform_int_distribution<int> place(-15, 15);
    offsets_.clear();
    weights_.clear();
    four_ = {{}, {}, {}, {0.001f, 0.0013f, 0.0007f, 0.002f}};
    for (int k = 0; k < taps; ++k) {
      offsets_.push_back(place(rng_) * kSide + place(rng_));
      for (int i = 0; i < 16; ++i) {
        weights_.push_back(static_cast<std::int8_t>(value(rng_)));
        four_.bias[i / 4] -= 128 * weights_.back();
      }
    }
    four_.offsets = offsets_;
    four_.weights = weights_;
  }

  std::mt19937 rng_{7};
  std::vector<std::uint32_t> cells_;
  std::vector<std::int32_t> offsets_;
  std::vector<std::int8_t> weights_;
  FourTemplates four_{};
};

TEST(CoarseKernel, EveryHighwayTargetEqualsThePlainLoop) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    Judge().check(highway_kernel(), hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(0);
  }
}

TEST(CoarseKernel, EveryDotProductOfThisMachineEqualsThePlainLoop) {
  int tried = 0;
  for (const NamedKernel& kernel : dot_product_kernels()) {
    if (!kernel.run) continue;
    Judge().check(kernel.run, kernel.name);
    ++tried;
  }
  if (tried == 0) GTEST_SKIP() << "this machine has no dot product of bytes";
}

TEST(CoarseKernel, TheTargetInUseIsTheFirstThatCanRun) {
  for (const NamedKernel& kernel : dot_product_kernels())
    if (kernel.run) {
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
