#pragma once
/// From a rough place to an exact one: at each pyramid level two ways to move, and the better of all places tried is
/// kept, so that no place gets worse by refinement.

#include <vector>

#include "pickcell/image/pyramid.hpp"
#include "pickcell/matches/fit/edge_fit.hpp"
#include "pickcell/matches/fit/edge_points.hpp"
#include "pickcell/matches/fit/grey_fit.hpp"
#include "pickcell/matches/fit/grey_points.hpp"
#include "pickcell/matches/model.hpp"
#include "pickcell/matches/similarity.hpp"

namespace pickcell::matches {

/// What is known of the template at one level.
struct LevelModel {
  GreyPoints grey;
  GreyPoints few;  ///< far fewer of them, to come near with; empty where that saves nothing
  EdgePoints edges;
  ContourPoints contours;
};

/// A place and what speaks for it, both measured there.
struct Hypothesis {
  Similarity place;
  double ncc = -1;  ///< of a part that is flat inside: the edge score
  double edge = 0;
  double inside = 1;    ///< share of the part inside the picture
  double contrast = 0;  ///< standard deviation of the scene under the part, grey values
  double gain = 0;      ///< scene contrast over template contrast
  double score = -1;
  float coarse = 0;  ///< score of the candidate that it came from
};

/// 0.4 NCC + 0.6 edge score: the inside alone can match the edge of something else, and edges alone match clutter.
/// Below 0 only for ranking; a Match reports it clamped to 0..1.
[[nodiscard]] double combined_score(double ncc, double edge);

/// One level of the picture.
struct SceneLevel {
  image::ImageView grey;
  LazyField* field = nullptr;
  int level = 0;
};

struct RefineScratch {
  WeightedSamples grey;
  ContourScratch contour;
};

/// NCC, edge score and their combination at a place.
[[nodiscard]] Hypothesis evaluate(const SceneLevel& scene, const LevelModel& model, const Similarity& place,
                                  RefineScratch& scratch);

/// On the way down: some Gauss-Newton steps and, independently, a contour fit from the same start; the best-scored
/// place of all, start included. The scale stays within the range widened by 5 %, here and in settle().
[[nodiscard]] Hypothesis climb(const SceneLevel& scene, const LevelModel& model, const Similarity& start, Range scale,
                               int grey_steps, RefineScratch& scratch);

/// At level 0: Gauss-Newton to its end; a contour fit where that scores clearly better; a fit without outliers where
/// the correlation is poor (occlusion). Among places of about the same score the more exact estimate is kept; never one
/// whose score and correlation are both lower than the start's.
[[nodiscard]] Hypothesis settle(const SceneLevel& scene, const LevelModel& model, const Similarity& start, Range scale,
                                RefineScratch& scratch);

/// At level 0, from where settle() ended: where the correlation is poor (occlusion, highlights) a fit without outliers,
/// kept unless its score is clearly lower.
[[nodiscard]] Hypothesis polish(const SceneLevel& scene, const LevelModel& model, const Hypothesis& settled,
                                Range scale, RefineScratch& scratch);

}  // namespace pickcell::matches
