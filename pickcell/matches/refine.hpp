#pragma once
/// From a rough place to an exact one: at each pyramid level two ways to move, and the better of all places tried is
/// kept, so that no place gets worse by refinement.

#include <vector>

#include "pickcell/image/pyramid.hpp"
#include "pickcell/matches/edge_fit.hpp"
#include "pickcell/matches/edge_points.hpp"
#include "pickcell/matches/grey_fit.hpp"
#include "pickcell/matches/grey_points.hpp"
#include "pickcell/matches/model.hpp"
#include "pickcell/matches/similarity.hpp"

namespace pickcell::matches {

/// What is known of the template at one level.
struct LevelModel {
  GreyPoints grey;
  EdgePoints edges;
  std::vector<ContourPoint> contours;
};

/// A place and what speaks for it, both measured there.
struct Hypothesis {
  Similarity place;
  double ncc = -1;
  double edge = 0;
  double inside = 1;    ///< share of the part inside the picture
  double contrast = 0;  ///< standard deviation of the scene under the part, grey values
  double gain = 0;      ///< scene contrast over template contrast
  double score = -1;
};

/// 0.4 NCC + 0.6 edge score: the inside alone can match the edge of something else, and edges alone match clutter.
/// Below 0 only for ranking; a Match reports it clamped to 0..1.
[[nodiscard]] double combined_score(double ncc, double edge);

/// One level of the picture.
struct SceneLevel {
  image::ImageView grey;
  const OrientationField* field = nullptr;
  int level = 0;
};

struct RefineScratch {
  GreyScratch grey;
  ContourScratch contour;
};

struct RefineEffort {
  int grey_steps = 4;
  double stop_px = 0;  ///< rim movement below which Gauss-Newton stops, pixels of level 0
  ContourSearch contour;
  /// How much better the contour fit must score to be preferred: at a good place grey values are the more exact
  /// measure.
  double contour_margin = 0;
  bool contour_from_best = false;  ///< else from the start: a second, independent try
  bool robust = false;             ///< also try a fit without outliers where the correlation is poor
};

/// NCC, edge score and their combination at a place.
[[nodiscard]] Hypothesis evaluate(const SceneLevel& scene, const LevelModel& model, const Similarity& place,
                                  RefineScratch& scratch);

/// The best place on the way from start, start included. The scale stays within the range widened by 5 %.
[[nodiscard]] Hypothesis refine(const SceneLevel& scene, const LevelModel& model, const Similarity& start, Range scale,
                                const RefineEffort& effort, RefineScratch& scratch);

}  // namespace pickcell::matches
