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

/// distance[i]: from the point's place along its normal to the steepest change of grey within reach_px, sub-pixel;
/// kNoEdge where there is none of at least 5 grey values per pixel, or the search would leave the picture. Near places
/// are preferred: an edge at the far end counts half. smooth: each sample is averaged 1-2-1 along the tangent. Writes
/// whole blocks.
void find_edges(image::ImageView picture, const ContourColumns& points, const LevelMap& map, float reach_px,
                bool smooth, float* distance);

}  // namespace pickcell::matches
