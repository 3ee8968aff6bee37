#pragma once
/// The inner loop of the coarse search: four templates at once over a block of positions. One source for every SIMD
/// target of Highway, and a small file for each dot-product instruction that Highway 1.0.3 cannot express
/// (kernel_vnni.cpp, kernel_neon.cpp); the best is chosen at run time. All give the same bits.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace pickcell::matches {

/// Four templates (neighbouring angles) as a list of taps. A tap covers two cells side by side: four bytes of the scene
/// (c2, s2 of the cell and of its right neighbour, each biased by 128) and four weights for each template.
struct FourTemplates {
  std::span<const std::int32_t> offsets;  ///< one per tap, in cells from the position's own cell
  std::span<const std::int8_t> weights;   ///< 16 per tap: four for each of the four templates
  std::int32_t bias[4];                   ///< -128 times the sum of each template's weights
  float norm[4];                          ///< factor of each template's sum
};

/// Positions to score: width x height cells, rows stride cells apart.
struct CellBlock {
  const std::uint32_t* origin;
  std::ptrdiff_t stride;
  int width;
  int height;
};

/// Rows are rounded up to this many positions: cells must be readable and scores writable so far.
constexpr int kKernelBlock = 16;

/// score[y * score_stride + x] = max over the four templates of norm * (bias + sum over taps of the dot product of the
/// four bytes at the offset and the four weights). 60,000 taps cannot overflow.
using CoarseKernel = void (*)(const CellBlock& cells, const FourTemplates& templates, float* score,
                              std::ptrdiff_t score_stride);

void best_of_four(const CellBlock& cells, const FourTemplates& templates, float* score, std::ptrdiff_t score_stride);

/// The target that best_of_four runs with on this machine, in lower case: "avx512vnni", "avx2", "neon", ...
[[nodiscard]] std::string kernel_target();

/// The same for one position, each template by itself, in plain C++.
void each_of_four(const std::uint32_t* cell, const FourTemplates& templates, float (&score)[4]);

/// A kernel by name, for tests and micro-benchmarks.
struct NamedKernel {
  const char* name;
  CoarseKernel run;
  bool able;  ///< whether this machine has its instructions
};
/// The dot-product kernels of this build, best first: those with a file of their own.
[[nodiscard]] std::vector<NamedKernel> dot_product_kernels();
/// Highway's, with the target that it chooses (tests restrict it).
[[nodiscard]] CoarseKernel highway_kernel();

namespace detail {
[[nodiscard]] std::vector<NamedKernel> vnni_kernels();
[[nodiscard]] std::vector<NamedKernel> neon_dot_kernels();
}  // namespace detail

}  // namespace pickcell::matches
