#pragma once
/// The inner loops of the score: sums over the blocks of a part. Sources of the score itself: match_score.hpp.

#include <algorithm>
#include <array>
#include <cstddef>

#include "pickcell/matches/fit/point_kernels.hpp"

namespace pickcell::matches {

constexpr int kBlocksPerSide = 4;
constexpr std::size_t kBlocks = kBlocksPerSide * kBlocksPerSide;

/// Points are kept block by block: those of block b are begin[b] .. begin[b + 1].
using BlockBegins = std::array<int, kBlocks + 1>;

/// Lays the blocks over a box, rows first.
class BlockGrid {
 public:
  BlockGrid(float x_lo, float x_hi, float y_lo, float y_hi)
      : x_lo_(x_lo),
        y_lo_(y_lo),
        per_x_(kBlocksPerSide / (x_hi - x_lo + 1e-3f)),
        per_y_(kBlocksPerSide / (y_hi - y_lo + 1e-3f)) {}
  [[nodiscard]] std::size_t at(float x, float y) const {
    const int column = std::clamp(static_cast<int>((x - x_lo_) * per_x_), 0, kBlocksPerSide - 1);
    const int row = std::clamp(static_cast<int>((y - y_lo_) * per_y_), 0, kBlocksPerSide - 1);
    return static_cast<std::size_t>(row * kBlocksPerSide + column);
  }
  /// Sorts points (with members x, y) by their blocks; otherwise they stay in order.
  template <class Points>
  [[nodiscard]] BlockBegins sort(Points& points) const {
    std::stable_sort(points.begin(), points.end(),
                     [&](const auto& a, const auto& b) { return at(a.x, a.y) < at(b.x, b.y); });
    BlockBegins begin{};
    for (const auto& p : points) ++begin[at(p.x, p.y) + 1];
    for (std::size_t b = 0; b < kBlocks; ++b) begin[b + 1] += begin[b];
    return begin;
  }

 private:
  float x_lo_, y_lo_, per_x_, per_y_;
};

/// Weighted sums of 1, s - 128, its square, t, its square, and the product of both.
struct BlockMoments {
  float n, s, ss, t, tt, st;
};
void sum_block_moments(const PointColumns& points, const float* s, const float* weight, const BlockBegins& begin,
                       std::array<BlockMoments, kBlocks>& out);

/// Of the field at the pixel nearest to each point (none outside the picture) and the point's own, turned by the map's
/// angle: products, scene squares, own squares; fields of +-1.
struct BlockEdges {
  float both, scene, own;
};
void sum_block_edges(image::View<std::int8_t> field, const EdgeColumns& points, const LevelMap& map,
                     const BlockBegins& begin, std::array<BlockEdges, kBlocks>& out);

}  // namespace pickcell::matches
