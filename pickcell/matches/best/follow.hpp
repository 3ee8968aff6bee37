#pragma once
/// Follows the candidates of the coarse search down the pyramid, dropping the hopeless level by level.

#include <memory_resource>
#include <span>
#include <vector>

#include "pickcell/matches/best/model.hpp"
#include "pickcell/matches/best/scene.hpp"
#include "pickcell/matches/coarse/search.hpp"
#include "pickcell/matches/engine.hpp"
#include "pickcell/matches/work.hpp"

namespace pickcell::matches {

/// A hypothesis that was dropped on the way.
struct Dropped {
  Hypothesis hypothesis;
  RejectReason reason = RejectReason::score;
  Stage stage = Stage::fine;
};

/// When a single search need not look further: a result good in both measures, or one that stands out.
struct Acceptance {
  double ncc = 2, edge = 2;        ///< both reached ...
  double score = 2, margin = 0.1;  ///< ... or this score, and every rival lower by the margin
  [[nodiscard]] bool accepts(const Hypothesis& best, double rival_score) const {
    return (best.ncc >= ncc && best.edge >= edge) || (best.score >= score && best.score - rival_score >= margin);
  }
};

struct FollowRequest {
  int keep_top = 12;
  int keep_mid = 4;
  double window = 0.3;   ///< single: below the best of all; several: below the best at the same location
  double floor = -1;     ///< a result below this is of no use: dropped early, with some slack
  bool several = false;  ///< no location may push another out
  int threads = 1;
  Range angle_deg;  ///< single: what lies beyond is no rival, and ends no search
  Acceptance sure;  ///< single: ends the search
};

struct Followed {
  std::pmr::vector<Hypothesis> found;  ///< at level 0, best first, no two the same
  std::pmr::vector<Dropped> dropped;
  std::pmr::vector<StageReport> stages;
  explicit Followed(std::pmr::memory_resource* memory) : found(memory), dropped(memory), stages(memory) {}

  /// The best score of anything but the first find, at the level where it was last looked at. The first find itself
  /// under another name (same place and angle) does not count.
  [[nodiscard]] double rival_score(double side_px) const;
};

/// scratch: one per thread. memory: for the result and what is needed on the way.
[[nodiscard]] Followed follow(std::span<const CoarseCandidate> candidates, const BestModel& model, int from_level,
                              BestScene& scene, const FollowRequest& request, WorkBudget& budget,
                              std::vector<RefineScratch>& scratch, std::pmr::memory_resource* memory);

/// Best first; ties by place, so that the order never depends on the way it was found.
void sort_best_first(std::pmr::vector<Hypothesis>& list);

/// Whether two hypotheses mean the same place and angle.
[[nodiscard]] bool same_place(const Similarity& a, const Similarity& b, double side_px);

}  // namespace pickcell::matches
