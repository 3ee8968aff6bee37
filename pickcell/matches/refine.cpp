#include "pickcell/matches/refine.hpp"

#include <algorithm>
#include <cmath>

namespace pickcell::matches {
namespace {

constexpr double kScaleSlack = 0.05;
constexpr double kStepLimit_px = 2.0;  // of the rim, pixels of the level
constexpr double kRunAway_px = 4.0;    // pixels of the level
constexpr double kRobustBelowNcc = 0.92;
constexpr int kRobustSteps = 6;
constexpr double kEdgeTolerance = 0.02;  // of the score

Hypothesis judged(const SceneLevel& scene, const LevelModel& model, const Similarity& place, const GreyFit& fit) {
  Hypothesis h;
  h.place = place;
  h.ncc = fit.ncc;
  h.edge = edge_score(*scene.field, model.edges, at_level(place, scene.level));
  h.inside = fit.inside;
  h.contrast = fit.contrast;
  h.gain = fit.gain;
  h.score = combined_score(h.ncc, h.edge);
  return h;
}

/// One chain of Gauss-Newton steps; keeps the best place in `best`.
class Descent {
 public:
  Descent(const SceneLevel& scene, const LevelModel& model, Range scale, RefineScratch& scratch)
      : scene_(scene), model_(model), scale_(scale), by_ncc_(scene.level == 0), scratch_(scratch) {}

  void run(const Similarity& start, int steps, double stop_px, bool robust, Hypothesis& best) {
    Similarity s = start;
    for (int i = 0; i <= steps; ++i) {
      const LevelMap map = at_level(s, scene_.level);
      const GreyFit fit = robust && i < steps ? fit_grey_robust(scene_.grey, model_.grey, map, scratch_.grey)
                                              : fit_grey(scene_.grey, model_.grey, map, scratch_.grey);
      const Hypothesis h = judged(scene_, model_, s, fit);
      keep_better(h, best);
      if (i == steps || !fit.can_step || arrived_) return;
      s = stepped(s, fit.step, stop_px);
      const double moved = std::ldexp(std::hypot(s.x_px - start.x_px, s.y_px - start.y_px), -scene_.level);
      if (moved > kRunAway_px) return;
    }
  }

 private:
  void keep_better(const Hypothesis& h, Hypothesis& best) const {
    const bool exacter = by_ncc_ && best.score > -2 && h.ncc > best.ncc && h.score > best.score - kEdgeTolerance;
    const bool preferred = by_ncc_ ? h.score > best.score + kEdgeTolerance : h.score > best.score;
    if (exacter || preferred) best = h;
  }

  Similarity stepped(const Similarity& s, const Increment& full, double stop_px) {
    Increment d = limited(full, model_.grey.radius, kStepLimit_px);
    arrived_ = std::ldexp(rim_movement(d, model_.grey.radius), scene_.level) < stop_px;
    d.dx = std::ldexp(d.dx, scene_.level);
    d.dy = std::ldexp(d.dy, scene_.level);
    Similarity r = compose_inverse(s, d);
    r.scale = std::clamp(r.scale, scale_.lo * (1 - kScaleSlack), scale_.hi * (1 + kScaleSlack));
    return r;
  }

  const SceneLevel& scene_;
  const LevelModel& model_;
  Range scale_;
  /// At level 0 the correlation decides between places of about the same score: it has the sharper peak.
  bool by_ncc_;
  RefineScratch& scratch_;
  bool arrived_ = false;
};

}  // namespace

double combined_score(double ncc, double edge) { return 0.4 * ncc + 0.6 * std::min(edge, 1.0); }

Hypothesis evaluate(const SceneLevel& scene, const LevelModel& model, const Similarity& place, RefineScratch& scratch) {
  return judged(scene, model, place, fit_grey(scene.grey, model.grey, at_level(place, scene.level), scratch.grey));
}

Hypothesis refine(const SceneLevel& scene, const LevelModel& model, const Similarity& start, Range scale,
                  const RefineEffort& effort, RefineScratch& scratch) {
  Hypothesis best;
  best.score = -2;
  Descent(scene, model, scale, scratch).run(start, effort.grey_steps, effort.stop_px, false, best);
  const Similarity from = effort.contour_from_best ? best.place : start;
  if (const auto moved = fit_contours(scene.grey, scene.level, model.contours, from, effort.contour, scratch.contour)) {
    Similarity s = *moved;
    s.scale = std::clamp(s.scale, scale.lo * (1 - kScaleSlack), scale.hi * (1 + kScaleSlack));
    const Hypothesis h = evaluate(scene, model, s, scratch);
    if (h.score > best.score + effort.contour_margin) best = h;
  }
  if (effort.robust && best.ncc < kRobustBelowNcc)
    Descent(scene, model, scale, scratch).run(best.place, kRobustSteps, effort.stop_px, true, best);
  return best;
}

}  // namespace pickcell::matches
