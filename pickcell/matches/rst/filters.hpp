#pragma once
/// Steps 1 to 3 of rst and erst at the coarse level: circular, radial and template filter.

#include <cstdint>
#include <optional>
#include <vector>

#include "pickcell/matches/engine.hpp"
#include "pickcell/matches/rst/model.hpp"
#include "pickcell/matches/rst/settings.hpp"
#include "pickcell/matches/work.hpp"

namespace pickcell::matches {

/// A place of the coarse level that is still in question.
struct RstCandidate {
  int x = 0, y = 0;   ///< of the anchor, pixels of level NP
  int scale = 0;      ///< place in RstModel::scales
  int shift = 0;      ///< turned by shift * alpha
  double score = 0;   ///< NCC of the step that looked at it last
  double inside = 1;  ///< share of its window inside the picture, from step 3 on
};

/// What a step did with its candidates.
struct RstStep {
  std::vector<RstCandidate> kept;
  std::vector<RstCandidate> dropped;  ///< with SearchOptions::explain
  StageReport report;
};

/// One search: a model in a picture.
struct RstTask {
  const RstModel& model;
  const RstSettings& settings;
  RstVariant variant;
  image::ImageView coarse;  ///< the picture at level NP
  const SearchOptions& options;
  AllowedShifts shifts;           ///< empty: all
  std::vector<bool> allowed_deg;  ///< 360 whole degrees
  WorkBudget& budget;
  int threads = 1;

  /// Pose of the reference point for a candidate.
  [[nodiscard]] Pose2d pose(const RstCandidate& c) const;
};

/// Positions of the coarse level, both ends included; empty when x_hi < x_lo or y_hi < y_lo.
struct RstPositions {
  int x_lo, y_lo, x_hi, y_hi;
};
/// Where the largest circle lies in the picture and the reference point may lie in the region.
[[nodiscard]] RstPositions positions(const RstTask& task);

/// Step 1: at every position the circular features against those of every scale. dropped: the position about each
/// watched place with the best score, or the best of all when nothing is watched.
[[nodiscard]] RstStep circular_filter(const RstTask& task);
/// Step 2: the best turn of the radial features.
[[nodiscard]] RstStep radial_filter(const RstTask& task, std::vector<RstCandidate> candidates);
/// Step 3: the turned and scaled template itself.
[[nodiscard]] RstStep template_filter(const RstTask& task, std::vector<RstCandidate> candidates);

/// Keeps the best of candidates nearer than the radius (pixels of the coarse level); best first. Radius 0 keeps all.
[[nodiscard]] std::vector<RstCandidate> suppressed(std::vector<RstCandidate> candidates, double radius_px);

}  // namespace pickcell::matches
