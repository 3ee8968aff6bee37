#include "pickcell/matches/coarse_kernel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include <hwy/highway.h>

namespace pickcell::matches {
namespace {

/// Every SIMD target of this machine gives the plain loop's bits, for runs of any length and any alignment.
TEST(CoarseKernel, EveryTargetEqualsThePlainLoop) {
  std::mt19937 rng(7);
  std::uniform_int_distribution<int> value(-127, 127);
  std::uniform_int_distribution<int> place(-300, 300);
  std::vector<std::int16_t> pairs(4096);
  for (auto& v : pairs) v = static_cast<std::int16_t>(value(rng));
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    for (int n = 1; n <= 70; ++n) {
      const int taps = n % 7 == 0 ? 0 : 1 + n * 3;
      std::vector<std::int32_t> offsets;
      std::vector<std::int16_t> weights;
      for (int k = 0; k < taps; ++k) {
        offsets.push_back(place(rng));
        for (int i = 0; i < 8; ++i) weights.push_back(static_cast<std::int16_t>(value(rng)));
      }
      const FourTemplates t{offsets, weights, {0.001f, 0.0013f, 0.0007f, 0.002f}};
      const std::int16_t* origin = pairs.data() + 2 * (400 + n % 5);
      std::vector<float> score(static_cast<std::size_t>(n + kKernelBlock), -7.f);
      best_of_four(origin, t, n, score.data());
      for (int i = 0; i < n; ++i) {
        float each[4];
        each_of_four(origin + 2 * i, t, each);
        EXPECT_EQ(score[static_cast<std::size_t>(i)], *std::max_element(each, each + 4))
            << hwy::TargetName(target) << " n " << n << " at " << i;
      }
    }
    hwy::SetSupportedTargetsForTest(0);
  }
}

}  // namespace
}  // namespace pickcell::matches
