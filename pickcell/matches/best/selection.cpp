#include "pickcell/matches/best/selection.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "pickcell/matches/best/turns.hpp"
#include "pickcell/matches/fit/final_fit.hpp"
#include "pickcell/matches/fit/fit_quality.hpp"
#include "pickcell/matches/fit/match_score.hpp"
#include "pickcell/matches/limits.hpp"

namespace pickcell::matches {
namespace {

constexpr double kLeastContrast = 2;  // grey values
constexpr double kLeastGain = 0.05;
constexpr std::size_t kMostRejected = 100;
constexpr double kSameTurn_deg = 4;
constexpr double kAboutAsGood = 0.05;     // of the score, between turns about one spot
constexpr double kMayRise = 0.15;         // of the score, by another angle
constexpr double kMayRiseSeveral = 0.05;  // many finds: only those that nearly pass
constexpr std::size_t kContenders = 3;    // of a single search
constexpr double kElsewhere = 0.25;       // of the part's side
constexpr double kMostLead = 0.3;         // of the score: more says no more
constexpr double kUsualLead = 0.1;        // neither for nor against
constexpr double kLeadCounts = 0.3;
constexpr double kVague_px = 0.1;  // a place known worse than this by its grey values may be known better by contours
constexpr double kAlike = 0.8;     // of the self-match at another turn
constexpr std::size_t kSettledTurns = 16;  // known to teaching: more cost more than they tell
constexpr double kExact_deg = 0.1;         // of the turns of a symmetry
constexpr double kWhole = 0.99;            // of the part in the picture
constexpr double kHeld = 0.01;     // of the score: less lost by moving a place into its ranges says it may lie there
constexpr double kDoubtful = 0.4;  // below 1: the score from which the lead counts fully

/// From (x, y, turn, growth) of the scene about the anchor to (x_px, y_px, angle_deg, scale) of the reference point.
Eigen::Matrix4d moved_covariance(const Eigen::Matrix4d& C, const Similarity& s, double ref_dx, double ref_dy) {
  const double a = s.scale * std::cos(s.angle_rad);
  const double b = s.scale * std::sin(s.angle_rad);
  const double rx = a * ref_dx + b * ref_dy;
  const double ry = -b * ref_dx + a * ref_dy;
  Eigen::Matrix4d J;
  J << 1, 0, ry, rx,        //
      0, 1, -rx, ry,        //
      0, 0, kDegPerRad, 0,  //
      0, 0, 0, s.scale;
  return J * C * J.transpose();
}

/// The same from (dx, dy, turn, growth) of the template about the anchor.
Eigen::Matrix4d pose_covariance(const Eigen::Matrix4d& C, const Similarity& s, double ref_dx, double ref_dy) {
  const Eigen::Matrix4d K = scene_from_template(s);
  return moved_covariance(K * C * K.transpose(), s, ref_dx, ref_dy);
}

bool same_spot(const Similarity& a, const Similarity& b, double side_px) {
  return std::hypot(a.x_px - b.x_px, a.y_px - b.y_px) < 0.12 * side_px;
}

/// The best-scored, or of the turns about one spot that score about as well the one whose inside agrees best: the
/// outline of a round part says nothing about its angle, and fine teeth say only where within a tooth.
const Hypothesis* best_turn(const std::pmr::vector<Hypothesis>& tries, const Similarity& spot, double side_px) {
  const Hypothesis* best =
      &*std::max_element(tries.begin(), tries.end(), [](const auto& a, const auto& b) { return a.score < b.score; });
  const double least = best->score - kAboutAsGood;
  if (!same_spot(best->place, spot, side_px)) return best;
  for (const Hypothesis& t : tries)
    if (t.score >= least && t.ncc > best->ncc && same_spot(t.place, best->place, side_px)) best = &t;
  return best;
}

}  // namespace

Selection::Selection(BestScene& scene, const SearchOptions& options, const BestSettings& settings,
                     RefineScratch& scratch, WorkBudget& budget, std::pmr::memory_resource* memory)
    : scene_(scene),
      options_(options),
      settings_(settings),
      scratch_(scratch),
      budget_(budget),
      memory_(memory),
      entries_(memory),
      dropped_(memory),
      turned_(memory) {}

double Selection::score_of(const BestModel& model, const Hypothesis& h) {
  return match_score(scene_.level(0), model.levels[0], h, scratch_);
}

Selection::Entry Selection::entry(const BestModel& model, int model_index, const Hypothesis& h, double score) {
  return {&model, model_index, h, score, model.outline(h.place), std::pmr::vector<double>(memory_)};
}

void Selection::add(const BestModel& model, int model_index, Followed followed) {
  std::size_t scored = 0;
  for (const Hypothesis& h : followed.found) {
    if (scored++ < kContenders || !budget_.spent())
      entries_.push_back(entry(model, model_index, h, score_of(model, h)));
    else
      followed.dropped.push_back({h, RejectReason::budget, Stage::final});
  }
  if (options_.explain)
    for (const Dropped& d : followed.dropped)  // with the score for which it was dropped, of a coarser level
      turned_.push_back({entry(model, model_index, d.hypothesis, d.hypothesis.score), d.reason, d.stage});
  if (options_.max_matches == 1) dropped_.emplace_back(&model, std::move(followed.dropped));
}

void Selection::add_at_border(const BestModel& model, int model_index, const Followed& followed) {
  for (const Hypothesis& h : followed.found) {
    const bool known = std::any_of(entries_.begin(), entries_.end(), [&](const Entry& o) {
      return o.model == &model && same_place(o.h.place, h.place, model.side_px);
    });
    if (known || h.inside >= kWhole) continue;
    Entry e = entry(model, model_index, h, score_of(model, h));
    const RejectReason* const reason = fault(e);
    if (e.score < limit_of(e) && !cut_off(e)) continue;
    if (!reason || *reason == RejectReason::border) turn_down(std::move(e), RejectReason::border);
  }
}

void Selection::note_ambiguity(Entry& e, double offset_deg, double score) {
  if (score < e.h.score - settings_.ambiguous_margin) return;
  const auto known = std::any_of(e.ambiguous_deg.begin(), e.ambiguous_deg.end(),
                                 [&](double d) { return std::abs(wrap_deg(d - offset_deg)) < 5; });
  if (!known) e.ambiguous_deg.push_back(wrap_deg(offset_deg));
}

/// Tries the angles at which teaching saw the same part again and, unless the result is sure, all others; takes the
/// best and notes the ones as good.
void Selection::resolve_angle(Entry& e) {
  const Range allowed = angles_of(e);
  std::pmr::vector<Hypothesis> tries({e.h}, memory_);
  const Learnt& learnt = e.model->model->learnt;
  // Of a gear of many teeth each turn of its symmetry is as good as the next, and the sweep knows the others.
  const bool many = learnt.ambiguous_deg.size() > kSettledTurns;
  const std::span<const double> offsets = learnt.ambiguous_deg;
  for (const double offset : many ? offsets.first(0) : offsets) {
    Similarity s = e.h.place;
    s.angle_rad = wrap_rad(s.angle_rad + offset / kDegPerRad);
    if (angle_answers(s.angle_rad * kDegPerRad, allowed) && !budget_.spent())
      tries.push_back(settle(scene_.level(0), e.model->levels[0], s, e.model->scale, scratch_));
  }
  const bool allowed_here = angle_answers(e.h.place.angle_rad * kDegPerRad, allowed);
  // A wrong turn of a part that looks much like itself when turned may agree as well as a sure result.
  const bool alike = learnt.second_best_self_match >= kAlike;
  if (!allowed_here || alike || e.h.ncc < settings_.accept_ncc || e.h.edge < settings_.accept_edge)
    for (const Hypothesis& h : settled_turns(e.h, *e.model, allowed, scene_, scratch_, budget_, memory_))
      if (angle_answers(h.place.angle_rad * kDegPerRad, allowed)) tries.push_back(h);
  // A near-symmetric part that was found at a turn beyond the range is taken at one within it, if any fits.
  if (!allowed_here && tries.size() > 1) tries.erase(tries.begin());
  const Hypothesis* best = best_turn(tries, e.h.place, e.model->side_px);
  if (best != &tries.front() || !allowed_here) {
    const double score = score_of(*e.model, *best);
    if (!allowed_here && score < limit_of(e)) return;  // what was found lies beyond the range
    e.h = *best;
    e.score = score;
  }
  e.outline = e.model->outline(e.h.place);
  for (const Hypothesis& t : tries)
    if (std::abs(wrap_rad(t.place.angle_rad - e.h.place.angle_rad)) * kDegPerRad > kSameTurn_deg &&
        same_spot(t.place, e.h.place, e.model->side_px))
      note_ambiguity(e, (t.place.angle_rad - e.h.place.angle_rad) * kDegPerRad, t.score);
  if (!many || learnt.symmetry_order < 2) return;
  for (const double offset : offsets) {
    const double angle_deg = e.h.place.angle_rad * kDegPerRad + offset;
    if (std::abs(std::remainder(offset, 360.0 / learnt.symmetry_order)) < kExact_deg &&
        angle_answers(wrap_deg(angle_deg), allowed))
      note_ambiguity(e, offset, e.h.score);
  }
}

Range Selection::angles_of(const Entry& e) const { return options_.angle_deg.value_or(e.model->model->angle_deg); }

/// The exact place of a masked part, before it is judged by its ranges; its score is that of this place. A place that
/// scores clearly worse is not taken.
void Selection::look_last(Entry& e) {
  if (e.score + kLeadCounts * kMostLead < limit_of(e)) return;
  const SceneLevel scene = scene_.level(0);
  const auto last = fit_finally(scene.grey, e.model->final_points, e.h.place, scratch_.grey, scratch_.contour);
  if (!last) return;
  Hypothesis exact = evaluate(scene, e.model->levels[0], last->place, scratch_);
  if (exact.score < e.h.score - kHeld) return;
  exact.coarse = e.h.coarse;
  e.h = exact;
  e.score = score_of(*e.model, e.h);
  e.outline = e.model->outline(e.h.place);
  e.covariance = last->covariance;
}

/// What noise and covering carried a little beyond the asked-for ranges goes back to their end, if it agrees as well
/// there.
void Selection::hold_in_ranges(Entry& e) {
  if (e.score < limit_of(e)) return;
  Similarity s = e.h.place;
  s.scale = nearest_scale(s.scale, e.model->scale);
  s.angle_rad = wrap_rad(nearest_angle(s.angle_rad * kDegPerRad, angles_of(e)) / kDegPerRad);
  const double turn_deg = std::abs(wrap_rad(s.angle_rad - e.h.place.angle_rad)) * kDegPerRad;
  const double growth = std::abs(e.h.place.scale / s.scale - 1);
  if ((turn_deg == 0 && growth == 0) || turn_deg > kAngleTolerance_deg || growth > kMostGrowthHeld) return;
  Hypothesis held = evaluate(scene_.level(0), e.model->levels[0], s, scratch_);
  if (held.score < e.h.score - kHeld) return;
  held.coarse = e.h.coarse;
  e.h = held;
  e.score = score_of(*e.model, e.h);
  e.outline = e.model->outline(e.h.place);
}

/// Whether the entry may still become a match: what is far below is not worth another look.
bool Selection::contender(const Entry& e) const {
  if (e.score + (options_.max_matches > 1 ? kMayRiseSeveral : kMayRise) < limit_of(e)) return false;
  if (options_.max_matches > 1) return true;
  const double best = std::accumulate(entries_.begin(), entries_.end(), -1.0, [&](double b, const Entry& o) {
    return o.model == e.model ? std::max(b, o.score) : b;
  });
  if (e.score < best - kMayRise) return false;
  const auto better_ones = std::count_if(entries_.begin(), entries_.end(),
                                         [&](const Entry& o) { return o.model == e.model && o.score > e.score; });
  return better_ones < static_cast<std::ptrdiff_t>(kContenders);
}

double Selection::rival_of(const Entry& e) const {
  double best = -1;
  const auto see = [&](const Similarity& place, double score) {
    const double off_px = std::hypot(place.x_px - e.h.place.x_px, place.y_px - e.h.place.y_px);
    if (off_px > kElsewhere * e.model->side_px) best = std::max(best, score);
  };
  for (const Entry& o : entries_)
    if (o.model == e.model) see(o.h.place, o.score);
  if (best >= 0) return best;
  for (const auto& [model, list] : dropped_)
    if (model == e.model)
      for (const Dropped& d : list) see(d.hypothesis.place, d.hypothesis.score);
  return std::max(0.0, best);
}

/// Of a single search: whether the picture holds other places that look about as much like the part. Those that agree
/// by chance come in numbers; a part that is covered or blurred still stands out. Says little where the score is high.
void Selection::judge_leads() {
  std::pmr::vector<double> judged(memory_);
  judged.reserve(entries_.size());
  for (const Entry& e : entries_) {
    const double lead = std::clamp(e.score - rival_of(e), 0.0, kMostLead);
    const double doubt = std::clamp((1 - e.score) / kDoubtful, 0.0, 1.0);
    judged.push_back(e.score + kLeadCounts * doubt * (lead - kUsualLead));
  }
  for (std::size_t i = 0; i < entries_.size(); ++i) entries_[i].score = judged[i];
}

double Selection::limit_of(const Entry& e) const {
  return options_.min_score.value_or(e.model->model->learnt.suggested_min_score);
}

/// Whether it is what lies outside the picture that the score lacks: there no edge agrees.
bool Selection::cut_off(const Entry& e) const {
  return e.h.inside < kWhole && e.score + kEdgesInScore * (1 - e.h.inside) >= limit_of(e);
}

const RejectReason* Selection::fault(const Entry& e) const {
  static constexpr RejectReason kScore = RejectReason::score, kBorder = RejectReason::border,
                                kScale = RejectReason::scale, kContrast = RejectReason::contrast,
                                kLimit = RejectReason::limit;
  const bool flat = e.model->levels.front().grey.flat();
  if (!flat && (e.h.contrast < kLeastContrast || e.h.gain < kLeastGain)) return &kContrast;
  if (e.h.inside < settings_.min_visible) return &kBorder;
  if (!scale_answers(e.h.place.scale, e.model->scale)) return &kScale;
  if (!angle_answers(e.h.place.angle_rad * kDegPerRad, angles_of(e))) return &kLimit;
  if (options_.roi) {
    const Pose2d p = pose_of(e.h.place, e.model->ref_dx, e.model->ref_dy);
    const auto& r = *options_.roi;
    if (p.x_px < r.x - 0.5 || p.y_px < r.y - 0.5 || p.x_px > r.x + r.w - 0.5 || p.y_px > r.y + r.h - 0.5)
      return &kLimit;
  }
  if (e.score >= limit_of(e)) return nullptr;
  return cut_off(e) ? &kBorder : &kScore;
}

bool Selection::before(const Entry& a, const Entry& b) {
  if (a.score != b.score) return a.score > b.score;
  return std::tie(a.model_index, a.h.place.y_px, a.h.place.x_px) <
         std::tie(b.model_index, b.h.place.y_px, b.h.place.x_px);
}

void Selection::turn_down(Entry&& e, RejectReason reason) {
  if (options_.explain) turned_.push_back({std::move(e), reason, Stage::final});
}

void Selection::finish(FindResult& result) {
  const double start_ms = thread_cpu_ms();
  std::pmr::vector<Entry*> contenders(memory_);
  for (Entry& e : entries_)
    if (contender(e)) contenders.push_back(&e);
  for (Entry* e : contenders)
    if (!budget_.spent()) resolve_angle(*e);
  for (Entry& e : entries_) {
    if (!budget_.spent()) look_last(e);
    hold_in_ranges(e);
  }
  if (options_.max_matches == 1) judge_leads();
  std::pmr::vector<Entry> passed(memory_), kept(memory_);
  for (Entry& e : entries_) {
    if (const RejectReason* reason = fault(e))
      turn_down(std::move(e), *reason);
    else
      passed.push_back(std::move(e));
  }
  std::sort(passed.begin(), passed.end(), before);
  for (Entry& e : passed) {
    const auto rival = std::find_if(
        kept.begin(), kept.end(), [&](const Entry& k) { return overlap(k.outline, e.outline) > options_.max_overlap; });
    if (rival != kept.end()) {
      const double turn_deg = wrap_deg((e.h.place.angle_rad - rival->h.place.angle_rad) * kDegPerRad);
      if (rival->model == e.model && same_spot(rival->h.place, e.h.place, e.model->side_px) &&
          std::abs(turn_deg) > kSameTurn_deg)
        note_ambiguity(*rival, turn_deg, e.h.score);
      turn_down(std::move(e), RejectReason::overlap);
    } else if (static_cast<int>(kept.size()) >= options_.max_matches) {
      turn_down(std::move(e), RejectReason::limit);
    } else {
      kept.push_back(std::move(e));
    }
  }
  result.matches.resize(kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) describe(kept[i], result.matches[i]);
  StageReport report;
  report.stage = "selection";
  report.population = static_cast<std::int64_t>(entries_.size());
  report.survivors = static_cast<std::int64_t>(kept.size());
  report.ms = thread_cpu_ms() - start_ms;
  result.stages.push_back(report);
}

void Selection::tell_rejected(FindResult& result) {
  std::sort(turned_.begin(), turned_.end(), [](const Turned& a, const Turned& b) {
    if (a.stage != b.stage) return a.stage > b.stage;
    if (before(a.entry, b.entry) || before(b.entry, a.entry)) return before(a.entry, b.entry);
    return std::tie(a.entry.h.place.angle_rad, a.entry.h.place.scale, a.reason) <
           std::tie(b.entry.h.place.angle_rad, b.entry.h.place.scale, b.reason);
  });
  result.rejected.resize(std::min(turned_.size(), kMostRejected));
  for (std::size_t i = 0; i < result.rejected.size(); ++i) {
    describe(turned_[i].entry, result.rejected[i].match);
    result.rejected[i].reason = turned_[i].reason;
    result.rejected[i].stage = turned_[i].stage;
  }
}

void Selection::describe(const Entry& e, Match& m) {
  m.model = e.model->model->name;
  m.model_index = e.model_index;
  m.pose = pose_of(e.h.place, e.model->ref_dx, e.model->ref_dy);
  m.score = std::clamp(e.score, 0.0, 1.0);
  const SceneLevel scene = scene_.level(0);
  const LevelModel& level = e.model->levels[0];
  const FitQuality q = judge_fit(scene.grey, level.grey, level.few, at_level(e.h.place, 0), scratch_.grey);
  m.visible = q.visible;
  m.covariance = pose_covariance(q.covariance, e.h.place, e.model->ref_dx, e.model->ref_dy);
  // Parts that are flat inside, or nearly: their contours decide the pose.
  const double grey_px_sq = m.covariance.topLeftCorner<2, 2>().trace();
  if (grey_px_sq == 0 || grey_px_sq > kVague_px * kVague_px)
    if (const auto c = contour_covariance(scene.grey, level.contours, e.h.place, scratch_.contour)) {
      const Eigen::Matrix4d by_contours = moved_covariance(*c, e.h.place, e.model->ref_dx, e.model->ref_dy);
      if (grey_px_sq == 0 || by_contours.topLeftCorner<2, 2>().trace() < grey_px_sq) m.covariance = by_contours;
    }
  if (e.covariance) m.covariance = moved_covariance(*e.covariance, e.h.place, e.model->ref_dx, e.model->ref_dy);
  m.ambiguous_deg.assign(e.ambiguous_deg.begin(), e.ambiguous_deg.end());
}

Eigen::Matrix4d covariance_at_reference(const FitQuality& quality, const Similarity& place, double ref_dx,
                                        double ref_dy) {
  return pose_covariance(quality.covariance, place, ref_dx, ref_dy);
}

}  // namespace pickcell::matches
