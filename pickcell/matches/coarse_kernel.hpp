#pragma once
/// The inner loop of the coarse search: four templates at once over a run of positions. One source, every SIMD target
/// of Highway, chosen at run time; all targets give the same bits.

#include <cstdint>
#include <span>
#include <string>

namespace pickcell::matches {

/// Four templates (neighbouring angles) as a list of taps. Offsets are counted in pairs from the position's own pair.
struct FourTemplates {
  std::span<const std::int32_t> offsets;  ///< one per tap
  std::span<const std::int16_t> weights;  ///< eight per tap: a pair for each of the four templates
  float norm[4];                          ///< factor of each template's sum
};

/// Positions per call are rounded up to this many: pairs must be readable and score writable so far.
constexpr int kKernelBlock = 16;

/// score[i] = max over the four templates of norm * sum over taps of the dot product of pairs[i + offset] and the
/// weight, for i in [0, n). pairs points at the pair of position 0. |values| <= 127, so that 100,000 taps cannot
/// overflow.
void best_of_four(const std::int16_t* pairs, const FourTemplates& templates, int n, float* score);

/// The target that best_of_four runs with on this machine, in lower case: "avx2", "neon", ...
[[nodiscard]] std::string kernel_target();

/// The same for one position, each template by itself, in plain C++.
void each_of_four(const std::int16_t* pairs, const FourTemplates& templates, float (&score)[4]);

}  // namespace pickcell::matches
