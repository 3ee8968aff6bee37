#pragma once
/// For tests of the kernels: each on every SIMD target of this machine; the coarse ones against the plain loop.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>
#include <string>
#include <vector>

#include <hwy/highway.h>

#include "pickcell/matches/coarse/kernel.hpp"

namespace pickcell::matches::testing {

template <class Body>
void on_every_target(const Body& body) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    SCOPED_TRACE(hwy::TargetName(target));
    body();
  }
  hwy::SetSupportedTargetsForTest(0);
}

/// Random scenes, weights and shapes; every score must have the plain loop's bits.
class KernelJudge {
 public:
  KernelJudge() : cells_(kSide * kSide) {
    for (auto& c : cells_) c = static_cast<std::uint32_t>(rng_());
  }

  /// Every width_step-th width from 1 to 70, up to 7 rows and 211 taps.
  void check(CoarseKernel kernel, const std::string& name, int width_step = 1) {
    for (int width = 1; width <= 70; width += width_step) {
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

  /// FNV-1a of the scores' bits for 40 widths.
  std::uint64_t fingerprint(CoarseKernel kernel) {
    std::uint64_t hash = 0xcbf29ce484222325;
    for (int width = 1; width <= 40; ++width) {
      make_templates(3 * width);
      std::vector<float> score(static_cast<std::size_t>(width + kKernelBlock));
      kernel({cells_.data() + 20 * kSide + 20, kSide, width, 1}, four_, score.data(), width + kKernelBlock);
      for (int x = 0; x < width; ++x)
        hash = (hash ^ std::bit_cast<std::uint32_t>(score[static_cast<std::size_t>(x)])) * 0x100000001b3;
    }
    return hash;
  }

 private:
  static constexpr int kSide = 160;

  void make_templates(int taps) {
    // By hand: the library's distributions may differ between machines, and fingerprint() must not.
    const auto value = [this] { return static_cast<int>(rng_() % 255) - 127; };
    const auto place = [this] { return static_cast<int>(rng_() % 31) - 15; };
    offsets_.clear();
    weights_.clear();
    four_ = {{}, {}, {}, {0.001f, 0.0013f, 0.0007f, 0.002f}};
    for (int k = 0; k < taps; ++k) {
      offsets_.push_back(place() * kSide + place());
      for (int i = 0; i < 16; ++i) {
        weights_.push_back(static_cast<std::int8_t>(value()));
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

}  // namespace pickcell::matches::testing
