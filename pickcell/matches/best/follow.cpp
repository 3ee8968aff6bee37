#include "pickcell/matches/best/follow.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "pickcell/matches/limits.hpp"

namespace pickcell::matches {
namespace {

constexpr double kSamePlace = 0.12;  // of the part's side
constexpr double kSameAngle_rad = 0.2;
constexpr double kLocation = 0.25;  // of the part's side: candidates here compete for one place
constexpr int kPerLocation = 4;
constexpr double kTopSlack = 0.3;  // of the score: what the levels below may still add
constexpr double kMidSlack = 0.2;
constexpr double kContender = 0.1;  // of the score: what the last polish may change
constexpr int kMostContenders = 6;  // of a single search

constexpr int kTopSteps = 4;  // Gauss-Newton steps at the level where a candidate is first refined ...
constexpr int kMidSteps = 2;  // ... and at those below, where it is nearly there

class Follower {
 public:
  Follower(const BestModel& model, BestScene& scene, const FollowRequest& request, WorkBudget& budget,
           std::vector<RefineScratch>& scratch, std::pmr::memory_resource* memory)
      : model_(model),
        scene_(scene),
        request_(request),
        budget_(budget),
        scratch_(scratch),
        memory_(memory),
        out_(memory) {}

  Followed run(std::span<const CoarseCandidate> candidates, int from_level) {
    std::pmr::vector<Hypothesis> list(memory_);
    list.reserve(candidates.size());
    for (const CoarseCandidate& c : candidates) {
      Hypothesis h;
      h.place = c.place;
      h.score = static_cast<double>(c.score);
      h.coarse = c.score;
      list.push_back(h);
    }
    for (int l = from_level; l >= 1; --l) {
      refine_all(list, l, l == from_level, 0, list.size());
      const bool top = l == from_level;
      prune(list, top ? request_.keep_top : request_.keep_mid, request_.window,
            request_.floor - (top ? kTopSlack : kMidSlack));
    }
    last_level(list, from_level == 0);
    out_.found = std::move(list);
    return std::move(out_);
  }

 private:
  /// Replaces list[begin, end) by what refinement makes of it; when the budget is spent the rest is dropped.
  void refine_all(std::pmr::vector<Hypothesis>& list, int level, bool first, std::size_t begin, std::size_t end) {
    const double start_ms = thread_cpu_ms();
    const SceneLevel scene = scene_.level(level);
    const LevelModel& model = model_.levels[static_cast<std::size_t>(level)];
    std::pmr::vector<char> done(end - begin, 0, memory_);
    parallel_for(static_cast<int>(end - begin), request_.threads, [&](int i, int worker) {
      // The very first is done as long as there is any time: a spent budget still gives the best answer there is.
      if (begin + static_cast<std::size_t>(i) > 0 ? budget_.spent() : budget_.used_up()) return;
      Hypothesis& h = list[begin + static_cast<std::size_t>(i)];
      RefineScratch& scratch = scratch_[static_cast<std::size_t>(worker)];
      const float coarse = h.coarse;
      if (first)
        h = climb(scene, model, h.place, model_.scale, kTopSteps, scratch);
      else if (level > 0)
        h = climb(scene, model, h.place, model_.scale, kMidSteps, scratch);
      if (level == 0) h = settle(scene, model, h.place, model_.scale, scratch);
      h.coarse = coarse;
      done[static_cast<std::size_t>(i)] = 1;
    });
    report(level, list, begin, end, thread_cpu_ms() - start_ms);
    for (std::size_t i = end; i-- > begin;) {
      if (done[i - begin]) continue;
      out_.dropped.push_back({list[i], RejectReason::budget, level == 0 ? Stage::final : Stage::fine});
      list.erase(list.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }

  void report(int level, const std::pmr::vector<Hypothesis>& list, std::size_t begin, std::size_t end, double ms) {
    StageReport r;
    r.stage = "level " + std::to_string(level);
    r.population = static_cast<std::int64_t>(list.size());
    r.survivors = r.population;
    r.ms = ms;
    r.ncc_count = static_cast<std::int64_t>(end - begin);
    out_.stages.push_back(r);
  }

  /// Level 0. A single search stops at a sure result: the candidates come best first, and one batch is one decision, so
  /// that the answer does not depend on the threads.
  void last_level(std::pmr::vector<Hypothesis>& list, bool first) {
    std::size_t done = 0;
    const std::size_t all = list.size();
    if (!request_.several && all > 1) {
      refine_all(list, 0, first, 0, 1);
      if (list.size() < all) return refine_all(list, 0, first, 0, list.size());  // no time: all are dropped
      done = 1;
      double rival = -1;  // the others' scores are those of level 1
      for (std::size_t i = 1; i < all; ++i) rival = std::max(rival, list[i].score);
      if (answers(list[0]) && request_.sure.accepts(list[0], rival)) {
        for (std::size_t i = 1; i < all; ++i) drop(list[i], RejectReason::limit);
        list.resize(1);
        polish_best(list);
        return;
      }
    }
    refine_all(list, 0, first, done, list.size());
    prune(list, static_cast<int>(all), 10, -10);
    polish_best(list);
  }

  /// The contenders for a match, of a list with the best first; the order may change.
  void polish_best(std::pmr::vector<Hypothesis>& list) {
    if (list.empty()) return;
    const double least = (request_.several ? request_.floor : best_answer(list)) - kContender;
    const SceneLevel scene = scene_.level(0);
    const LevelModel& model = model_.levels[0];
    const int most = request_.several ? static_cast<int>(list.size()) : kMostContenders;
    parallel_for(std::min(most, static_cast<int>(list.size())), request_.threads, [&](int i, int worker) {
      Hypothesis& h = list[static_cast<std::size_t>(i)];
      if (h.score >= least && !budget_.spent())
        h = polish(scene, model, h, model_.scale, scratch_[static_cast<std::size_t>(worker)]);
    });
    sort_best_first(list);
  }

  /// Of a single search: what lies beyond the ranges may look more like the part than the part that is asked for.
  [[nodiscard]] bool answers(const Hypothesis& h) const {
    return may_answer(h.place.angle_rad * kDegPerRad, request_.angle_deg, h.place.scale, model_.scale);
  }
  /// The score of the best that may answer, of a list with the best first.
  [[nodiscard]] double best_answer(const std::pmr::vector<Hypothesis>& list) const {
    const auto best = std::find_if(list.begin(), list.end(), [&](const Hypothesis& h) { return answers(h); });
    return best == list.end() ? list.front().score : best->score;
  }

  void drop(const Hypothesis& h, RejectReason reason) { out_.dropped.push_back({h, reason, Stage::fine}); }

  /// Keeps the best, without doubles; every location keeps its own best when several parts are searched for.
  void prune(std::pmr::vector<Hypothesis>& list, int keep, double window, double floor) {
    sort_best_first(list);
    std::pmr::vector<Hypothesis> kept(memory_);
    kept.reserve(list.size());
    for (const Hypothesis& h : list) {
      const Hypothesis* rival = nullptr;
      if (!request_.several) {
        const auto best = std::find_if(kept.begin(), kept.end(), [&](const Hypothesis& k) { return answers(k); });
        if (best != kept.end()) rival = &*best;
      }
      int here = 0;
      bool same = false;
      for (const Hypothesis& k : kept) {
        same = same || same_place(k.place, h.place, model_.side_px);
        if (!nearer_than(k.place, h.place, kLocation * model_.side_px)) continue;
        ++here;
        if (!rival && request_.several) rival = &k;
      }
      if (same)
        drop(h, RejectReason::overlap);
      else if (static_cast<int>(kept.size()) >= keep || here >= kPerLocation)
        drop(h, RejectReason::limit);
      else if (h.score < floor || (rival && h.score < rival->score - window))
        drop(h, RejectReason::score);
      else
        kept.push_back(h);
    }
    list = std::move(kept);
    if (!out_.stages.empty()) out_.stages.back().survivors = static_cast<std::int64_t>(list.size());
  }

  const BestModel& model_;
  BestScene& scene_;
  const FollowRequest& request_;
  WorkBudget& budget_;
  std::vector<RefineScratch>& scratch_;
  std::pmr::memory_resource* memory_;
  Followed out_;
};

}  // namespace

Followed follow(std::span<const CoarseCandidate> candidates, const BestModel& model, int from_level, BestScene& scene,
                const FollowRequest& request, WorkBudget& budget, std::vector<RefineScratch>& scratch,
                std::pmr::memory_resource* memory) {
  if (candidates.empty()) return Followed(memory);
  return Follower(model, scene, request, budget, scratch, memory).run(candidates, from_level);
}

void sort_best_first(std::pmr::vector<Hypothesis>& list) {
  std::sort(list.begin(), list.end(), [](const Hypothesis& a, const Hypothesis& b) {
    if (a.score != b.score) return a.score > b.score;
    return std::tie(a.place.y_px, a.place.x_px, a.place.angle_rad, a.place.scale) <
           std::tie(b.place.y_px, b.place.x_px, b.place.angle_rad, b.place.scale);
  });
}

double Followed::rival_score(double side_px) const {
  double best = -1;
  const auto see = [&](const Hypothesis& h) {
    if (!same_place(h.place, found.front().place, side_px)) best = std::max(best, h.score);
  };
  if (found.empty()) return best;
  std::for_each(found.begin() + 1, found.end(), see);
  for (const Dropped& d : dropped) see(d.hypothesis);
  return best;
}

bool same_place(const Similarity& a, const Similarity& b, double side_px) {
  return nearer_than(a, b, kSamePlace * side_px) && std::abs(wrap_rad(a.angle_rad - b.angle_rad)) < kSameAngle_rad;
}

}  // namespace pickcell::matches
