#include "pickcell/matches/follow.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace pickcell::matches {
namespace {

constexpr double kSamePlace = 0.12;  // of the part's side
constexpr double kSameAngle_rad = 0.2;
constexpr double kLocation = 0.25;  // of the part's side: candidates here compete for one place
constexpr int kPerLocation = 4;

RefineEffort effort_at(int level, bool first) {
  RefineEffort e;
  if (level > 0) {
    e.grey_steps = first ? 4 : 2;
    e.contour = {2, 2.5f, false};
  } else {
    e.grey_steps = 8;
    e.stop_px = 0.01;
    e.contour = {6, 3.f, true};
    e.contour_from_best = true;
    e.contour_margin = 0.02;
    e.robust = true;
  }
  return e;
}

class Follower {
 public:
  Follower(const BestModel& model, BestScene& scene, const FollowRequest& request, WorkBudget& budget,
           std::vector<RefineScratch>& scratch)
      : model_(model), scene_(scene), request_(request), budget_(budget), scratch_(scratch) {}

  Followed run(const std::vector<CoarseCandidate>& candidates, int from_level) {
    std::vector<Hypothesis> list;
    for (const CoarseCandidate& c : candidates) {
      Hypothesis h;
      h.place = c.place;
      h.score = static_cast<double>(c.score);
      list.push_back(h);
    }
    for (int l = from_level; l >= 1; --l) {
      refine_all(list, l, l == from_level, 0, list.size());
      prune(list, l == from_level ? request_.keep_top : request_.keep_mid, request_.window);
    }
    finish(list, from_level == 0);
    out_.found = std::move(list);
    return std::move(out_);
  }

 private:
  /// Replaces list[begin, end) by what refinement makes of it; when the budget is spent the rest is dropped.
  void refine_all(std::vector<Hypothesis>& list, int level, bool first, std::size_t begin, std::size_t end) {
    const SceneLevel scene = scene_.level(level);
    const LevelModel& model = model_.levels[static_cast<std::size_t>(level)];
    const RefineEffort effort = effort_at(level, first);
    std::vector<char> done(end - begin, 0);
    parallel_for(static_cast<int>(end - begin), request_.threads, [&](int i, int worker) {
      // The first one is always done: a spent budget still gives the best answer there is.
      if (i > 0 && budget_.spent()) return;
      Hypothesis& h = list[begin + static_cast<std::size_t>(i)];
      h = refine(scene, model, h.place, model_.scale, effort, scratch_[static_cast<std::size_t>(worker)]);
      done[static_cast<std::size_t>(i)] = 1;
    });
    report(level, list, begin, end);
    for (std::size_t i = end; i-- > begin;) {
      if (done[i - begin]) continue;
      out_.dropped.push_back({list[i], RejectReason::budget, level == 0 ? Stage::final : Stage::fine});
      list.erase(list.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }

  void report(int level, const std::vector<Hypothesis>& list, std::size_t begin, std::size_t end) {
    StageReport r;
    r.stage = "level " + std::to_string(level);
    r.population = static_cast<std::int64_t>(list.size());
    r.survivors = r.population;
    r.ncc_count = static_cast<std::int64_t>(end - begin);
    out_.stages.push_back(r);
  }

  /// Level 0. A single search stops at a sure result: the candidates come best first, and one batch is one decision, so
  /// that the answer does not depend on the threads.
  void finish(std::vector<Hypothesis>& list, bool first) {
    std::size_t done = 0;
    const std::size_t all = list.size();
    if (!request_.several && all > 1) {
      refine_all(list, 0, first, 0, 1);
      done = 1;
      if (list[0].ncc >= request_.sure_ncc && list[0].edge >= request_.sure_edge) {
        list.resize(1);
        return;
      }
    }
    refine_all(list, 0, first, done, list.size());
    prune(list, static_cast<int>(all), 10);
  }

  void drop(const Hypothesis& h, RejectReason reason) { out_.dropped.push_back({h, reason, Stage::fine}); }

  /// Keeps the best, without doubles; every location keeps its own best when several parts are searched for.
  void prune(std::vector<Hypothesis>& list, int keep, double window) {
    sort_best_first(list);
    std::vector<Hypothesis> kept;
    for (const Hypothesis& h : list) {
      const Hypothesis* rival = !request_.several && !kept.empty() ? &kept.front() : nullptr;
      int here = 0;
      bool same = false;
      for (const Hypothesis& k : kept) {
        same = same || same_place(k.place, h.place, model_.side_px);
        if (distance(k, h) > kLocation * model_.side_px) continue;
        ++here;
        if (!rival) rival = &k;
      }
      if (same)
        drop(h, RejectReason::overlap);
      else if (static_cast<int>(kept.size()) >= keep || here >= kPerLocation)
        drop(h, RejectReason::limit);
      else if (rival && h.score < rival->score - window)
        drop(h, RejectReason::score);
      else
        kept.push_back(h);
    }
    list = std::move(kept);
    if (!out_.stages.empty()) out_.stages.back().survivors = static_cast<std::int64_t>(list.size());
  }

  static double distance(const Hypothesis& a, const Hypothesis& b) {
    return std::hypot(a.place.x_px - b.place.x_px, a.place.y_px - b.place.y_px);
  }

  const BestModel& model_;
  BestScene& scene_;
  const FollowRequest& request_;
  WorkBudget& budget_;
  std::vector<RefineScratch>& scratch_;
  Followed out_;
};

}  // namespace

Followed follow(const std::vector<CoarseCandidate>& candidates, const BestModel& model, int from_level,
                BestScene& scene, const FollowRequest& request, WorkBudget& budget,
                std::vector<RefineScratch>& scratch) {
  if (candidates.empty()) return {};
  return Follower(model, scene, request, budget, scratch).run(candidates, from_level);
}

void sort_best_first(std::vector<Hypothesis>& list) {
  std::sort(list.begin(), list.end(), [](const Hypothesis& a, const Hypothesis& b) {
    if (a.score != b.score) return a.score > b.score;
    return std::tie(a.place.y_px, a.place.x_px, a.place.angle_rad, a.place.scale) <
           std::tie(b.place.y_px, b.place.x_px, b.place.angle_rad, b.place.scale);
  });
}

bool same_place(const Similarity& a, const Similarity& b, double side_px) {
  return std::hypot(a.x_px - b.x_px, a.y_px - b.y_px) < kSamePlace * side_px &&
         std::abs(wrap_rad(a.angle_rad - b.angle_rad)) < kSameAngle_rad;
}

}  // namespace pickcell::matches
