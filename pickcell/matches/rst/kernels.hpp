#pragma once
/// The inner loops of rst and erst: one source for every SIMD target of Highway, chosen at run time. Every target and
/// the plain forms give the same bits: sums are whole numbers, the few floating-point steps are done in the same order.
/// Pictures must be image::Planes' (up to 64 bytes past a row may be read).

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pickcell/matches/rst/lut.hpp"
#include "pickcell/matches/rst/window.hpp"

namespace pickcell::matches {

/// Positions are done in blocks of so many: outputs must have room for whole blocks.
constexpr int kRstBlock = 32;

/// means[k * stride + i] = mean over list k of the pixels about position first + i, for i in [0, n).
void mean_lists(const std::uint8_t* first, const OffsetLists& lists, int n, float* means, std::ptrdiff_t stride);

/// Circular features of the template at one scale: centred, unit norm; circles beyond q.size() do not fit the scale and
/// are left out on both sides. Ascending scales, so q grows.
struct RingQuery {
  std::vector<std::vector<float>> q;
  bool negative = false;  ///< by |NCC|
};

/// best[i] = the largest NCC over the scales of the features (as from mean_lists, circle k at means + k * stride), and
/// scale[i] which; -2 where the picture is flat.
void score_rings(const float* means, std::ptrdiff_t stride, int n, const RingQuery& query, float* best,
                 std::int32_t* scale);

/// Sums of picture, window and products; pixels outside the picture are left out.
[[nodiscard]] WindowSums sum_window(image::ImageView picture, const Window& window, int x, int y);

/// The same in plain C++.
namespace plain {
void mean_lists(const std::uint8_t* first, const OffsetLists& lists, int n, float* means, std::ptrdiff_t stride);
void score_rings(const float* means, std::ptrdiff_t stride, int n, const RingQuery& query, float* best,
                 std::int32_t* scale);
[[nodiscard]] WindowSums sum_window(image::ImageView picture, const Window& window, int x, int y);
}  // namespace plain

}  // namespace pickcell::matches
