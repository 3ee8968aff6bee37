/// The passes of engine best over one model: which candidates are followed, and when it is enough.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "pickcell/matches/best/engine.hpp"
#include "pickcell/matches/fit/match_score.hpp"
#include "pickcell/matches/limits.hpp"

namespace pickcell::matches {
namespace {

constexpr int kManyMore = 3;            // of several parts: as many candidates as for one, times this
constexpr int kPerLocation = 5;         // of several parts: candidates for one of them
constexpr float kRelativeLimit = 0.4f;  // and how far below the best they are looked at; where a part was found so
constexpr float kNearLimit = 1.2f;      // near to that limit, others may lie below it: then the limit goes down to
constexpr float kLower = 0.75f;         // this times the weakest candidate that became a part
constexpr int kMostRounds = 4;
/// Of several parts: places of candidates above this part of the best that came to nothing are looked at once more.
constexpr float kLostLimit = 0.6f;
constexpr std::size_t kMostLost = 6;
constexpr double kLostReach = 0.35;  // about the place, of the part's side
constexpr float kLastLimit = 0.38f;  // of one part that is found badly: how far below the best candidates are tried
/// Of its candidates those that are followed from a level lower: seen coarsely, an occluder pulls at them.
constexpr std::size_t kBestCoarse = 12;
constexpr int kMostLower = 8;        // of these to level 0
constexpr std::size_t kFewBest = 3;  // of the finds, by which it is judged whether one part was found badly
constexpr int kMostAtBorder = 8;     // parts that are told to be too far outside

/// Where the anchor may lie so that the reference point lies in the region.
CoarseRequest::Box anchor_box(const SearchOptions::Roi& r, const BestModel& m) {
  const double slack = std::hypot(m.ref_dx, m.ref_dy) * m.scale.hi;
  return {r.x - slack, r.y - slack, r.x + r.w - 1 + slack, r.y + r.h - 1 + slack};
}

/// The lowest coarse score from which a part was found; 1 if there is none.
float weakest_candidate(const Followed& all, double least_score) {
  float weakest = 1;
  for (const Hypothesis& h : all.found)
    if (h.score >= least_score) weakest = std::min(weakest, h.coarse);
  return weakest;
}

/// Where candidates looked like parts and none was found, best first: places of the anchor.
std::pmr::vector<Hypothesis> lost_places(const Followed& all, const BestModel& model, double least_score, float best,
                                         double min_visible, std::pmr::memory_resource* memory) {
  std::pmr::vector<Hypothesis> lost(memory);
  const auto apart = [&](const Hypothesis& a, const Hypothesis& b) {
    return std::hypot(a.place.x_px - b.place.x_px, a.place.y_px - b.place.y_px) > kLostReach * model.side_px;
  };
  for (const Dropped& d : all.dropped) {
    if (d.reason != RejectReason::score || d.hypothesis.coarse < kLostLimit * best) continue;
    if (d.hypothesis.inside < min_visible) continue;  // no match in any case
    const bool known = std::any_of(all.found.begin(), all.found.end(), [&](const Hypothesis& h) {
      return h.score >= least_score && !apart(h, d.hypothesis);
    });
    if (!known) lost.push_back(d.hypothesis);
  }
  std::sort(lost.begin(), lost.end(), [](const Hypothesis& a, const Hypothesis& b) {
    return a.coarse != b.coarse ? a.coarse > b.coarse : a.place.x_px < b.place.x_px;
  });
  std::pmr::vector<Hypothesis> places(memory);
  for (const Hypothesis& h : lost)
    if (places.size() < kMostLost &&
        std::all_of(places.begin(), places.end(), [&](const Hypothesis& p) { return apart(p, h); }))
      places.push_back(h);
  return places;
}

/// Adds what another pass found; of two finds of one place the better stays.
void merge(Followed more, const BestModel& model, Followed& all) {
  for (const Hypothesis& h : more.found) {
    const auto same = std::find_if(all.found.begin(), all.found.end(),
                                   [&](const Hypothesis& q) { return same_place(q.place, h.place, model.side_px); });
    if (same == all.found.end())
      all.found.push_back(h);
    else if (h.score > same->score)
      *same = h;
  }
  std::move(more.dropped.begin(), more.dropped.end(), std::back_inserter(all.dropped));
  sort_best_first(all.found);
}

}  // namespace

std::pmr::vector<BestEngine::Found> BestEngine::candidates(const BestModel& model,
                                                           const std::vector<CoarseTemplates>& bands,
                                                           const CoarseRequest& how, const SearchOptions& options,
                                                           WorkBudget& budget, FindResult& result) {
  CoarseRequest request = how;
  request.angle_deg = options.angle_deg.value_or(model.model->angle_deg);
  if (options.roi && !request.box) request.box = anchor_box(*options.roi, model);
  request.threads = static_cast<int>(scratch_.size());
  std::pmr::vector<Found> all(&arena_);
  all.reserve(bands.size());
  for (const CoarseTemplates& templates : bands) {
    if (!all.empty() && budget.spent()) break;
    const double start_ms = thread_cpu_ms();
    const CoarseScene* const top = scene_.coarse(templates.factor, templates.reach, budget);
    if (!top) break;
    all.push_back({&templates, std::pmr::vector<CoarseCandidate>(&arena_)});
    coarse_.run(*top, templates, request, budget, all.back().list);
    StageReport report;
    report.stage = request.border ? "border" : "coarse";
    report.population = coarse_.peaks();
    report.survivors = static_cast<std::int64_t>(all.back().list.size());
    report.ms = thread_cpu_ms() - start_ms;
    result.stages.push_back(report);
  }
  const auto best = [](const Found& f) { return f.list.empty() ? -1.f : f.list.front().score; };
  std::sort(all.begin(), all.end(), [&](const Found& a, const Found& b) {
    return best(a) != best(b) ? best(a) > best(b) : a.templates < b.templates;
  });
  return all;
}

Followed BestEngine::descend(std::span<const CoarseCandidate> candidates, const BestModel& model,
                             const CoarseTemplates& templates, const PassSettings& pass, const SearchOptions& options,
                             WorkBudget& budget, FindResult& result, int lower) {
  FollowRequest down;
  down.several = options.max_matches > 1;
  down.keep_top = pass.keep_top + (down.several ? 4 * options.max_matches : 0);
  down.keep_mid = pass.keep_mid + (down.several ? 2 * options.max_matches : 0);
  down.window = pass.window;
  down.floor = options.min_score.value_or(model.model->learnt.suggested_min_score);
  down.threads = static_cast<int>(scratch_.size());
  down.sure = acceptance();
  down.angle_deg = options.angle_deg.value_or(model.model->angle_deg);
  const int top = std::min({start_level(templates), static_cast<int>(model.levels.size()) - 1, scene_.levels() - 1});
  const int from = std::max(0, top - lower);
  Followed out = follow(candidates, model, from, scene_, down, budget, scratch_, &arena_);
  std::move(out.stages.begin(), out.stages.end(), std::back_inserter(result.stages));
  return out;
}

Acceptance BestEngine::acceptance() const {
  return {settings_.accept_ncc, settings_.accept_edge, settings_.accept_score, settings_.accept_margin};
}

bool BestEngine::sure(const Followed& f, const BestModel& model, const SearchOptions& options) const {
  if (options.max_matches > 1 || f.found.empty()) return false;
  const Similarity& place = f.found.front().place;
  return may_answer(place.angle_rad * kDegPerRad, options.angle_deg.value_or(model.model->angle_deg), place.scale,
                    model.scale) &&
         acceptance().accepts(f.found.front(), f.rival_score(model.side_px));
}

bool BestEngine::promising(const Followed& f, const BestModel& model) {
  const std::size_t few = std::min(f.found.size(), kFewBest);
  return std::any_of(f.found.begin(), f.found.begin() + static_cast<std::ptrdiff_t>(few), [&](const Hypothesis& h) {
    return match_score(scene_.level(0), model.levels[0], h, scratch_[0]) >= model.model->learnt.suggested_min_score;
  });
}

Followed BestEngine::search(BestModel& model, const SearchOptions& options, WorkBudget& budget, FindResult& result) {
  Followed all(&arena_);
  const auto enough = [&] { return budget.spent() || sure(all, model, options); };
  const auto add = [&](const Found& f, std::size_t first, std::size_t count, const PassSettings& pass,
                       int levels_lower = 0) {
    const auto list = std::span(f.list).subspan(std::min(first, f.list.size()));
    const auto part = list.first(std::min(count, list.size()));
    merge(descend(part, model, *f.templates, pass, options, budget, result, levels_lower), model, all);
  };
  CoarseRequest how;
  if (settings_.effort != Effort::thorough) {
    how.candidates = std::max(settings_.quick.candidates, settings_.wide.candidates);
    const auto few = static_cast<std::size_t>(settings_.quick.candidates);
    const std::pmr::vector<Found> bands = candidates(model, model.quick, how, options, budget, result);
    for (const Found& f : bands) {
      add(f, 0, few, settings_.quick);
      if (enough()) return all;
    }
    if (settings_.effort == Effort::quick) return all;
    for (const Found& f : bands) {
      add(f, few, f.list.size(), settings_.wide);
      if (enough()) return all;
    }
  }
  if (budget.spent()) return all;
  prepare_thorough(model);
  const auto first = static_cast<std::size_t>(settings_.thorough.candidates);
  how.candidates = settings_.thorough.candidates + settings_.last.candidates;
  how.relative_limit = kLastLimit;
  const std::pmr::vector<Found> bands = candidates(model, model.thorough, how, options, budget, result);
  for (const Found& f : bands) {
    add(f, 0, first, settings_.thorough);
    if (enough()) return all;
  }
  PassSettings lower = settings_.last;
  lower.keep_top = lower.keep_mid = kMostLower;
  for (const Found& f : bands) {
    if (promising(all, model)) return all;
    add(f, 0, kBestCoarse, lower, 1);
    if (enough() || promising(all, model)) return all;
    add(f, first, f.list.size(), settings_.last);
    if (enough()) return all;
  }
  return all;
}

Followed BestEngine::search_border(BestModel& model, const SearchOptions& options, WorkBudget& budget,
                                   FindResult& result) {
  SearchOptions several = options;
  several.max_matches = kMostAtBorder;
  const bool fine = settings_.effort == Effort::thorough;
  const std::vector<CoarseTemplates>& bands = fine                      ? model.thorough
                                              : options.max_matches > 1 ? model.wide
                                                                        : model.quick;
  Followed all(&arena_);
  CoarseRequest how;
  how.candidates = kPerLocation * kMostAtBorder;
  how.per_location = kPerLocation;
  how.relative_limit = kRelativeLimit / 2;  // about half of the part is there
  how.border = true;
  for (const Found& f : candidates(model, bands, how, several, budget, result))
    if (!budget.spent())
      merge(descend(f.list, model, *f.templates, settings_.quick, several, budget, result), model, all);
  return all;
}

Followed BestEngine::search_several(BestModel& model, const SearchOptions& options, WorkBudget& budget,
                                    FindResult& result) {
  const bool thorough = settings_.effort == Effort::thorough;
  thorough ? prepare_thorough(model) : prepare_wide(model);
  const std::vector<CoarseTemplates>& top = thorough ? model.thorough : model.wide;
  const PassSettings& pass = thorough ? settings_.thorough : settings_.wide;
  CoarseRequest how;
  // No part pushes out another; and none stands out so much that a rich ground may not come before it.
  how.candidates =
      kManyMore * std::max(settings_.quick.candidates, pass.candidates) + kPerLocation * options.max_matches;
  how.per_location = kPerLocation;
  how.relative_limit = kRelativeLimit;
  Followed all(&arena_);
  std::pmr::vector<std::size_t> done(top.size(), 0, &arena_);  // candidates of each band: a lower limit only adds some
  float highest = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    float best = 0;
    for (const Found& f : candidates(model, top, how, options, budget, result)) {
      if (f.list.empty()) continue;
      best = std::max(best, f.list.front().score);
      highest = std::max(highest, best);
      std::size_t& from = done[static_cast<std::size_t>(f.templates - top.data())];
      const auto more = std::span(f.list).subspan(std::min(from, f.list.size()));
      from = f.list.size();
      if (!more.empty()) merge(descend(more, model, *f.templates, pass, options, budget, result), model, all);
      if (budget.spent()) return all;
    }
    if (budget.spent()) return all;
    const float weakest = weakest_candidate(all, options.min_score.value_or(model.model->learnt.suggested_min_score));
    if (weakest >= kNearLimit * how.relative_limit * best) break;
    how.relative_limit = kLower * weakest / best;
  }
  if (settings_.effort == Effort::automatic) look_again(model, options, highest, budget, all, result);
  return all;
}

/// A part that lies badly on the coarse grid of places, angles and scales is seen by a finer one.
void BestEngine::look_again(BestModel& model, const SearchOptions& options, float best, WorkBudget& budget,
                            Followed& all, FindResult& result) {
  prepare_thorough(model);
  const double least = options.min_score.value_or(model.model->learnt.suggested_min_score);
  for (const Hypothesis& h : lost_places(all, model, least, best, settings_.min_visible, &arena_)) {
    CoarseRequest how;
    how.candidates = settings_.thorough.candidates;
    how.per_location = how.candidates;
    const double reach = kLostReach * model.side_px;
    how.box = {h.place.x_px - reach, h.place.y_px - reach, h.place.x_px + reach, h.place.y_px + reach};
    for (const Found& f : candidates(model, model.thorough, how, options, budget, result)) {
      if (budget.spent()) return;
      merge(descend(f.list, model, *f.templates, settings_.thorough, options, budget, result), model, all);
    }
  }
}

}  // namespace pickcell::matches
