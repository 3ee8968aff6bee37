#pragma once
/// Scores a place by its edges, and moves it so that the template's contours fall on the scene's.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "pickcell/image/image.hpp"
#include "pickcell/matches/fields/lazy_field.hpp"
#include "pickcell/matches/fit/edge_points.hpp"
#include "pickcell/matches/similarity.hpp"

namespace pickcell::matches {

/// Has the field computed at the pixels under the points, and at their right and lower neighbours.
void need_under(LazyField& scene, const EdgePoints& points, const LevelMap& map);

/// How well the scene's edge directions agree with the template's, weighed by the template's field: 1 for the template
/// itself, about 0 where directions are random, negative where they are across. Points outside the picture count 0.
[[nodiscard]] double edge_score(LazyField& scene, const EdgePoints& points, const LevelMap& map);

/// Columns over the contour points, see LineColumns.
struct ContourScratch {
  std::vector<float> distance;
  std::vector<float> found, weight;
  std::vector<float> nx, ny, turn, growth;
  std::vector<float> residual;
};

struct ContourSearch {
  int iterations = 2;      ///< at most
  float radius_px = 2.5f;  ///< of the first iteration, pixels of the level; shrinks by 0.7 to 1.5
  int sharp = 9;           ///< iterations before it averages along the tangent (level 0, where noise is)
  double least_px = 0;     ///< a first step smaller than this, at the rim, is not worth taking: none
};

/// Iterated: from each contour point look along the normal for the strongest edge, then fit a similarity to the
/// distances (Tukey's biweight). None when too few points find an edge, the place runs
/// away or hardly moves.
[[nodiscard]] std::optional<Similarity> fit_contours(image::ImageView scene_level, int level,
                                                     const ContourPoints& points, const Similarity& start,
                                                     const ContourSearch& search, ContourScratch& scratch);

/// How certain a place is by its contours: covariance of (x, y, turn, growth) about the anchor, pixels of level 0 and
/// radians, from the scatter of what is seen along the normals. None when too few points find an edge or the contours
/// leave something open.
[[nodiscard]] std::optional<Eigen::Matrix4d> contour_covariance(image::ImageView picture, const ContourPoints& points,
                                                                const Similarity& place, ContourScratch& scratch);

/// What one kind of observation says of a place.
struct Evidence {
  Eigen::Vector4d movement =
      Eigen::Vector4d::Zero();  ///< to where it is rather: x, y (pixels of level 0), turn, growth
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();  ///< inverse of its covariance; may leave something open
};

/// What the contours at a part's rim say. Their scatter is taken cluster by cluster: what lies beside the part pulls at
/// neighbours alike. Source: M-estimators with the sandwich covariance of clusters (Huber; Liang & Zeger).
[[nodiscard]] std::optional<Evidence> contour_evidence(image::ImageView picture, const RimPoints& rim,
                                                       const Similarity& place, ContourScratch& scratch);

}  // namespace pickcell::matches
