#include "pickcell/matches/fit/refine.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace pickcell::matches {
namespace {

constexpr double kScaleSlack = 0.05;
constexpr double kFixedScaleSlack = 0.02;  // the scale is known: what is left is tilt and the lens
constexpr double kStepLimit_px = 2.0;      // of the rim, pixels of the level
constexpr double kRunAway_px = 4.0;        // pixels of the level
constexpr int kFinalSteps = 8;
constexpr double kClimbStop_px = 0.05;   // rim movement, pixels of the level, that the next level down does as well
constexpr double kFinalStop_px = 0.01;   // rim movement at which Gauss-Newton has arrived
constexpr double kNear_px = 0.1;         // the same, with few points
constexpr double kSureNcc = 0.95;        // below it few points are too few: an occluder pulls them further than many
constexpr double kClearlyBetter = 0.02;  // of the score
constexpr double kRobustBelowNcc = 0.92;
constexpr double kSureEdge = 0.8;  // with kSureNcc: on the way down contours need not be asked
constexpr double kGoodNcc = 0.9;   // with kGoodEdge: contours cannot say more than the grey values did
constexpr double kGoodEdge = 0.7;
constexpr ContourSearch kClimbContour{2, 2.5f};
constexpr double kDip = 0.05;               // of the score: what the first steps towards a better place may cost
constexpr double kContoursAgree_px = 0.15;  // with where the grey values led
constexpr ContourSearch kFirstContour{2, 3.f, 2, kContoursAgree_px};
constexpr ContourSearch kFinalContour{4, 3.f, 2};

Hypothesis judged(const SceneLevel& scene, const LevelModel& model, const Similarity& place, const GreyFit& fit) {
  Hypothesis h;
  h.place = place;
  h.edge = edge_score(*scene.field, model.edges, at_level(place, scene.level));
  h.ncc = model.grey.flat() ? std::min(h.edge, 1.0) : fit.ncc;
  h.inside = fit.inside;
  h.contrast = fit.contrast;
  h.gain = fit.gain;
  h.score = combined_score(h.ncc, h.edge);
  return h;
}

/// The steps of a chain grow shorter by about the same factor each time: what the last two show of it, in all
/// directions at once, tells where they lead to (Anderson's acceleration, of depth 1).
class LongerSteps {
 public:
  explicit LongerSteps(float radius) : rim_(0.7 * static_cast<double>(radius)) {}

  /// What to go instead of this step, given what was gone last.
  [[nodiscard]] Increment of(const Increment& step) const {
    if (!known_ || size2(step) >= size2(step_)) return step;
    const Increment change = sum(step, step_, -1);
    const double share = -dot(step, change) / size2(change);
    const Increment longer = sum(step, sum(gone_, change, 1), share);
    return size2(longer) <= kLongest * kLongest * size2(step) ? longer : step;
  }
  void note(const Increment& step, const Increment& gone) {
    step_ = step;
    gone_ = gone;
    known_ = true;
  }

 private:
  static constexpr double kLongest = 3;
  static Increment sum(const Increment& a, const Increment& b, double k) {
    return {a.dx + k * b.dx, a.dy + k * b.dy, a.turn_rad + k * b.turn_rad, a.growth + k * b.growth};
  }
  [[nodiscard]] double dot(const Increment& a, const Increment& b) const {
    return a.dx * b.dx + a.dy * b.dy + rim_ * rim_ * (a.turn_rad * b.turn_rad + a.growth * b.growth);
  }
  [[nodiscard]] double size2(const Increment& a) const { return dot(a, a); }

  double rim_;
  bool known_ = false;
  Increment step_, gone_;
};

/// Gauss-Newton at one level.
class Descent {
 public:
  Descent(const SceneLevel& scene, const LevelModel& model, Range scale, RefineScratch& scratch)
      : scene_(scene), model_(model), scale_(scale), scratch_(scratch) {}

  using Fit = GreyFit (*)(image::ImageView, const GreyPoints&, const LevelMap&, WeightedSamples&);
  struct Chain {
    const GreyPoints& points;
    int steps;       ///< at most
    double stop_px;  ///< of the rim: fewer when they become smaller
    Fit fit = fit_grey;
    Fit fit_at_end = fit_grey;  ///< null: the end is not looked at
  };

  /// Calls seen(place, fit) before each step and at the end, which it returns.
  template <class Seen>
  Similarity run(const Similarity& start, const Chain& chain, Seen seen) {
    Similarity s = start;
    LongerSteps longer(chain.points.radius);
    bool arrived = false;
    for (int i = 0;; ++i) {
      const bool last = i == chain.steps || arrived;
      if (last && !chain.fit_at_end) return s;
      const GreyFit fit =
          (last ? chain.fit_at_end : chain.fit)(scene_.grey, chain.points, at_level(s, scene_.level), scratch_.grey);
      seen(s, fit);
      if (last || !fit.can_step || chain.points.flat()) return s;
      const Increment step = limited(fit.step, chain.points.radius, kStepLimit_px);
      Increment go = longer.of(step);
      const double scale_before = s.scale;
      s = stepped(s, go);
      go.growth = scale_before / s.scale - 1;  // the scale may have met its limit
      longer.note(step, go);
      arrived = std::ldexp(rim_movement(go, chain.points.radius), scene_.level) < chain.stop_px;
      const double moved = std::ldexp(std::hypot(s.x_px - start.x_px, s.y_px - start.y_px), -scene_.level);
      if (moved > kRunAway_px) return s;
    }
  }

  /// The last place of the chain, judged.
  Hypothesis end_of(const Similarity& start, Fit fit_once) {
    std::pair<Similarity, GreyFit> last;
    Similarity near = start;
    if (fit_once == fit_grey_robust && model_.few.size() > 0)
      near =
          run(start, {model_.few, kFinalSteps, kNear_px, fit_once, nullptr}, [](const Similarity&, const GreyFit&) {});
    run(near, {model_.grey, kFinalSteps, kFinalStop_px, fit_once},
        [&](const Similarity& s, const GreyFit& f) { last = {s, f}; });
    const bool measured = fit_once == fit_grey || last.second.ncc > -1;
    return measured ? judged(scene_, model_, last.first, last.second) : evaluate(scene_, model_, last.first, scratch_);
  }

  /// The first place of a chain of grey fits and its last, judged; the first by few points only, where they suffice to
  /// come near.
  std::pair<Hypothesis, Hypothesis> ends_of(const Similarity& start) {
    std::optional<std::pair<Similarity, GreyFit>> first, last;
    const auto see = [&](const Similarity& s, const GreyFit& f) {
      last.emplace(s, f);
      if (!first) first = last;
    };
    Similarity near = start;
    if (model_.few.size() > 0) {
      near = run(start, {model_.few, kFinalSteps, kNear_px, fit_grey, nullptr}, see);
      if (last->second.ncc < kSureNcc) near = start;
    }
    run(near, {model_.grey, kFinalSteps, kFinalStop_px}, see);
    return {judged(scene_, model_, first->first, first->second), judged(scene_, model_, last->first, last->second)};
  }

  [[nodiscard]] Similarity in_range(Similarity s) const {
    const double slack = scale_.lo == scale_.hi ? kFixedScaleSlack : kScaleSlack;
    s.scale = std::clamp(s.scale, scale_.lo * (1 - slack), scale_.hi * (1 + slack));
    return s;
  }

 private:
  [[nodiscard]] Similarity stepped(const Similarity& s, Increment d) const {
    d.dx = std::ldexp(d.dx, scene_.level);
    d.dy = std::ldexp(d.dy, scene_.level);
    return in_range(compose_inverse(s, d));
  }

  const SceneLevel& scene_;
  const LevelModel& model_;
  Range scale_;
  RefineScratch& scratch_;
};

void keep_better(const Hypothesis& h, Hypothesis& best) {
  if (h.score > best.score) best = h;
}

/// An estimate that is more exact by its nature replaces one of about the same score.
void prefer(const Hypothesis& exact, Hypothesis& best) {
  if (exact.score > best.score - kClearlyBetter) best = exact;
}

bool worse(const Hypothesis& a, const Hypothesis& b) { return a.score < b.score && a.ncc < b.ncc; }

/// Where the contours lead at level 0, if that scores clearly better than the place they start from; followed to the
/// end only when the first steps do not go clearly downhill.
std::optional<Hypothesis> by_contours(const SceneLevel& scene, const LevelModel& model, const Hypothesis& from,
                                      const Descent& descent, RefineScratch& scratch) {
  const auto led = [&](const Similarity& start, const ContourSearch& search) -> std::optional<Hypothesis> {
    const auto moved = fit_contours(scene.grey, 0, model.contours, start, search, scratch.contour);
    if (!moved) return {};
    return evaluate(scene, model, descent.in_range(*moved), scratch);
  };
  auto best = led(from.place, kFirstContour);
  // Where grey values agree well already, contours must go uphill at once; else they may lead over a dip.
  const double least = from.score + (from.ncc >= kGoodNcc ? kClearlyBetter / 2 : -kDip);
  if (!best || (best->score <= least && !model.grey.flat())) return {};
  if (const auto on = led(best->place, kFinalContour)) keep_better(*on, *best);
  if (best->score <= from.score + (model.grey.flat() ? -kClearlyBetter : kClearlyBetter)) return {};
  return best;
}

}  // namespace

double combined_score(double ncc, double edge) { return 0.4 * ncc + 0.6 * std::min(edge, 1.0); }

Hypothesis evaluate(const SceneLevel& scene, const LevelModel& model, const Similarity& place, RefineScratch& scratch) {
  return judged(scene, model, place, fit_grey(scene.grey, model.grey, at_level(place, scene.level), scratch.grey));
}

Hypothesis climb(const SceneLevel& scene, const LevelModel& model, const Similarity& start, Range scale, int grey_steps,
                 RefineScratch& scratch) {
  Descent descent(scene, model, scale, scratch);
  Hypothesis best;
  best.score = -2;
  descent.run(start, {model.grey, grey_steps, std::ldexp(kClimbStop_px, scene.level)},
              [&](const Similarity& s, const GreyFit& f) { keep_better(judged(scene, model, s, f), best); });
  if (best.ncc >= kSureNcc && best.edge >= kSureEdge && !model.grey.flat()) return best;
  if (const auto moved = fit_contours(scene.grey, scene.level, model.contours, start, kClimbContour, scratch.contour))
    keep_better(evaluate(scene, model, descent.in_range(*moved), scratch), best);
  return best;
}

Hypothesis settle(const SceneLevel& scene, const LevelModel& model, const Similarity& start, Range scale,
                  RefineScratch& scratch) {
  Descent descent(scene, model, scale, scratch);
  auto [first, last] = descent.ends_of(start);
  // What few points say of the start does for one that was left for a good end; else all must speak.
  if (model.few.size() > 0 && (last.ncc < kGoodNcc || last.score < first.score))
    first = evaluate(scene, model, start, scratch);
  Hypothesis best = first;
  prefer(last, best);
  if (best.ncc >= kGoodNcc && best.edge >= kGoodEdge && !model.grey.flat()) return best;
  if (const auto h = by_contours(scene, model, best, descent, scratch)) {
    best = *h;
    prefer(descent.end_of(best.place, fit_grey), best);
  }
  return worse(best, first) ? first : best;
}

Hypothesis polish(const SceneLevel& scene, const LevelModel& model, const Hypothesis& settled, Range scale,
                  RefineScratch& scratch) {
  if (settled.ncc >= kRobustBelowNcc || model.grey.flat()) return settled;
  Hypothesis best = settled;
  prefer(Descent(scene, model, scale, scratch).end_of(settled.place, fit_grey_robust), best);
  best.coarse = settled.coarse;
  return best;
}

}  // namespace pickcell::matches
