#include "pickcell/matches/rst/refine.hpp"

#include <algorithm>

#include "pickcell/matches/fit/fit_quality.hpp"

namespace pickcell::matches {
namespace {

// As engine best has them at level 0.
constexpr int kGreyPoints = 4096;
constexpr int kEdgePoints = 600;
constexpr int kContourPoints = 500;

/// The refined scale may leave the list of scales by half a step of theirs.
constexpr double kScaleSlack = 0.05;

}  // namespace

const LevelModel& RstRefine::level(const RstModel& model) {
  auto& own = levels_[&model];
  if (!own)
    own = std::make_unique<LevelModel>(LevelModel{choose_grey_points(model.pyramid, 0, kGreyPoints), GreyPoints{},
                                                  choose_edge_points(model.pyramid, 0, kEdgePoints),
                                                  choose_contour_points(model.pyramid, 0, kContourPoints)});
  return *own;
}

void RstRefine::prepare(const RstModel& model) { static_cast<void>(level(model)); }

void RstRefine::run(const RstModel& model, Match& match) {
  const LevelModel& points = level(model);
  const double dx = model.model->ref_x_px - model.pyramid.anchor_x_px;
  const double dy = model.model->ref_y_px - model.pyramid.anchor_y_px;
  const Range scale{model.scales.front() * (1 - kScaleSlack), model.scales.back() * (1 + kScaleSlack)};
  const SceneLevel scene = scene_.level(0);
  const Hypothesis h = settle(scene, points, similarity_of(match.pose, dx, dy), scale, scratch_);
  if (h.ncc <= 0) return;  // a negative, found by match_negative: the fit knows none, its place on the grids stays
  match.pose = pose_of(h.place, dx, dy);
  match.score = std::clamp(h.ncc, 0.0, 1.0);
  const FitQuality quality = judge_fit(scene.grey, points.grey, points.few, at_level(h.place, 0), scratch_.grey);
  match.visible = quality.visible;
  if (quality.covariance.trace() > 0) match.covariance = covariance_at_reference(quality, h.place, dx, dy);
}

}  // namespace pickcell::matches
