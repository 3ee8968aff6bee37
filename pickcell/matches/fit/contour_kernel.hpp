#pragma once
/// The inner loop of the contour fit: where, along each point's normal, the picture is steepest.

#include "pickcell/image/image.hpp"
#include "pickcell/matches/similarity.hpp"

namespace pickcell::matches {

/// Contour points relative to the anchor, with unit normals; every array has room up to a multiple of kPointBlock.
struct ContourColumns {
  const float* x;
  const float* y;
  const float* nx;
  const float* ny;
  int count;
};

/// Spacing of the samples along the normal, pixels.
constexpr float kNormalStep_px = 0.5f;
/// Value of a distance where no edge was found.
constexpr float kNoEdge = 1e9f;

/// How the grey values along a normal are looked at.
enum class EdgeReading {
  plain,
  smooth,  ///< each sample averaged 1-2-1 along the tangent
  exact  ///< slopes taken over four pixels, weighed as a Gaussian's derivative: hardly any error that depends on where
         ///< in its pixel the edge lies, and less noise; half as dear again
};

/// distance[i]: from the point's place along its normal to the steepest change of grey within reach_px, sub-pixel;
/// kNoEdge where there is none of at least 5 grey values per pixel, or the search would leave the picture. Near places
/// are preferred: an edge at the far end counts half. Writes whole blocks.
void find_edges(image::ImageView picture, const ContourColumns& points, const LevelMap& map, float reach_px,
                EdgeReading reading, float* distance);

/// What was seen along the normals, as columns of one linear fit: distance ~ nx dx + ny dy + turn da + growth ds. Every
/// array has room up to a multiple of kPointBlock; weight 0 where there is nothing.
struct LineColumns {
  const float* nx;
  const float* ny;
  const float* turn;
  const float* growth;
  const float* distance;
  const float* weight;
  int count;
};

/// The columns of the points at a place, in the scene; found 1 where an edge was seen (then distance stays), else found
/// and distance 0. Writes whole blocks. Returns how many were found.
struct LineOutput {
  float* nx;
  float* ny;
  float* turn;
  float* growth;
  float* distance;  ///< in: of find_edges
  float* found;
};
[[nodiscard]] int make_lines(const ContourColumns& points, const LevelMap& map, const LineOutput& out);

/// sums[0..9]: weighted products of (nx, ny, turn, growth), a <= b in row order; sums[10..13]: with the distance.
void sum_lines(const LineColumns& lines, float (&sums)[14]);

/// residual[i] = |distance - fit of the movement (dx, dy, turn, growth)|. Writes whole blocks.
void line_residuals(const LineColumns& lines, const float (&movement)[4], float* residual);

/// weight[i] = found[i] (1 - (residual[i] / cut)^2)^2, 0 beyond the cut. Writes whole blocks.
void weigh_lines(const float* residual, const float* found, float cut, int count, float* weight);

}  // namespace pickcell::matches
