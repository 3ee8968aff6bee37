#pragma once
/// The inner loops of refinement: pictures read at scattered places, eight points at a time where the machine can.
/// Pictures and fields must be Planes' (a few bytes past a row may be read). Answers of SIMD targets differ in the last
/// bits.

#include <cstddef>
#include <cstdint>

#include "pickcell/image/image.hpp"
#include "pickcell/matches/similarity.hpp"

namespace pickcell::matches {

/// Columns over the points; every array has room for padded_to_blocks values, filled with zeros.
constexpr int kPointBlock = 16;
/// Whole blocks, and one more for kernels that begin anywhere.
[[nodiscard]] constexpr std::size_t padded_to_blocks(std::size_t points) {
  return (points / kPointBlock + 2) * kPointBlock;
}

struct PointColumns {
  const float* qx;
  const float* qy;
  const float* t;
  const float* j[4];
  int count;
};

/// Sums over the points of s (less 128), its square, and its products with t and j, where s is the picture at W q.
/// Every point must lie inside the picture, by at least kInsideMargin_px.
constexpr float kInsideMargin_px = 0.02f;
struct PointSums {
  double s = 0;
  double ss = 0;
  double st = 0;
  double sj[4] = {};
};
[[nodiscard]] PointSums sum_points(image::ImageView picture, const PointColumns& points, const LevelMap& map);

/// s of every point, and weight 1 inside the picture, 0 outside (s is then that of the border). Writes whole blocks,
/// weight 0 beyond the points. Returns how many are inside.
int sample_points(image::ImageView picture, const PointColumns& points, const LevelMap& map, float* s, float* weight);

/// Weighted sums of products of the columns c = (1, t, j0, j1, j2, j3) and the scene: sums[0..20] = sum w c_a c_b for a
/// <= b in row order, sums[21..26] = sum w c_a (s - 128). Weights of the padding must be 0.
void sum_weighted(const PointColumns& points, const float* s, const float* weight, float* sums);

/// size[i] = |s[i] - offset - gain t[i]|. Writes whole blocks.
void residual_sizes(const PointColumns& points, const float* s, float offset, float gain, float* size);

/// Weight 1 where it is not 0 and |s[i] - offset - gain t[i]| <= limit, else 0. Writes whole blocks.
struct Agreement {
  int points = 0;     ///< of weight 1
  double square = 0;  ///< sum of their residuals' squares
};
[[nodiscard]] Agreement keep_agreeing(const PointColumns& points, const float* s, float offset, float gain, float limit,
                                      float* weight);

/// weight[i] = max(trace, (1 - (size[i] / cut)^2)^2), where it is not 0 already. Writes whole blocks.
void weigh_points(const float* size, float cut, float trace, int count, float* weight);

/// Columns of edge points: place and field.
struct EdgeColumns {
  const float* x;
  const float* y;
  const float* c2;
  const float* s2;
  int count;
};
/// Sum over the points inside the picture of the dot product of the scene's field (bytes, +-127) and the point's,
/// turned by the map's angle.
[[nodiscard]] float sum_edges(image::View<std::int8_t> field, const EdgeColumns& points, const LevelMap& map);

}  // namespace pickcell::matches
