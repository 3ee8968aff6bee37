#pragma once
/// The default engine. A picture goes through these rooms:
///   coarse_scene    the orientation field of the picture, averaged over cells of any real size
///   coarse_search   every position, angle and scale of the template's field (coarse_template) by one kernel; local
///   maxima follow          candidates down the pyramid; refine: Gauss-Newton on grey values and a contour fit, the
///   better is kept selection       threshold, border, overlap, limit; covariance, visible share, ambiguous angles
/// Three passes for a single part, each only where the one before is not sure: quick; wide, with more candidates of the
/// same coarse search; thorough, with a finer top level. Several parts: one pass, wide, with a top level between the
/// two.
///
/// Guided by: 0.4 NCC + 0.6 edge score. NCC is taken on the grey values inside the part; the edge score is the
/// agreement of edge directions, outline included, 1 for the template itself. Reported: match_score of the reported
/// pose, clamped to 0..1. Sources: Baker & Matthews (inverse compositional Gauss-Newton), Steger (edge directions as a
/// measure of similarity), Besl & McKay (iterated closest points); gradient directions of the doubled angle as in the
/// structure tensor.

#include <map>
#include <memory>
#include <vector>

#include "pickcell/matches/best/arena.hpp"
#include "pickcell/matches/best/follow.hpp"
#include "pickcell/matches/best/model.hpp"
#include "pickcell/matches/best/scene.hpp"
#include "pickcell/matches/coarse/kernel.hpp"
#include "pickcell/matches/coarse/search.hpp"
#include "pickcell/matches/engine.hpp"
#include "pickcell/matches/work.hpp"

namespace pickcell::matches {

class BestEngine final : public Engine {
 public:
  /// cpu_ms: the clock of SearchOptions::budget_ms, replaced in tests.
  explicit BestEngine(BestSettings settings = {}, WorkBudget::CpuClock cpu_ms = thread_cpu_ms);

  /// Errors (usage): options out of range, a template larger than the picture. Throws std::invalid_argument for a null
  /// model or an empty list.
  [[nodiscard]] core::Result<FindResult> find(const image::Pyramid& scene, std::span<const Model* const> models,
                                              const SearchOptions& options) override;
  [[nodiscard]] core::Status find_into(const image::Pyramid& scene, std::span<const Model* const> models,
                                       const SearchOptions& options, FindResult& result) override;
  void prepare(std::span<const Model* const> models, const SearchOptions& options) override;
  [[nodiscard]] std::string name() const override { return "best"; }
  [[nodiscard]] std::string isa() const override { return kernel_target(); }

 private:
  /// Whether one of the best finds reaches the model's own threshold.
  [[nodiscard]] bool promising(const Followed& f, const BestModel& model);
  void prepare_wide(BestModel& model) const;
  void prepare_thorough(BestModel& model) const;
  [[nodiscard]] BestModel& prepared(const Model& model, Range scale);
  /// What the coarse search found in one band of the scale range.
  struct Found {
    const CoarseTemplates* templates;
    std::pmr::vector<CoarseCandidate> list;
  };
  /// Bands of the best candidates first. border: of parts that show too little for a match.
  [[nodiscard]] std::pmr::vector<Found> candidates(const BestModel& model, const std::vector<CoarseTemplates>& bands,
                                                   const CoarseRequest& how, const SearchOptions& options,
                                                   WorkBudget& budget, FindResult& result);
  [[nodiscard]] Followed search_several(BestModel& model, const SearchOptions& options, WorkBudget& budget,
                                        FindResult& result);
  /// Of several parts: looks once more, finely, where good candidates came to nothing. best: coarse score.
  void look_again(BestModel& model, const SearchOptions& options, float best, WorkBudget& budget, Followed& all,
                  FindResult& result);
  /// lower: levels below the one that belongs to the templates, to start from.
  [[nodiscard]] Followed descend(std::span<const CoarseCandidate> candidates, const BestModel& model,
                                 const CoarseTemplates& templates, const PassSettings& pass,
                                 const SearchOptions& options, WorkBudget& budget, FindResult& result, int lower = 0);
  [[nodiscard]] std::optional<double> searching_ms(const SearchOptions& options) const;
  void note_finishing(const SearchOptions& options, double used_ms);
  [[nodiscard]] Acceptance acceptance() const;
  [[nodiscard]] bool sure(const Followed& followed, const BestModel& model, const SearchOptions& options) const;
  [[nodiscard]] Followed search(BestModel& model, const SearchOptions& options, WorkBudget& budget, FindResult& result);
  /// Parts too far outside to be found, for --explain: the search for matches does not look there.
  [[nodiscard]] Followed search_border(BestModel& model, const SearchOptions& options, WorkBudget& budget,
                                       FindResult& result);

  BestSettings settings_;
  WorkBudget::CpuClock cpu_ms_;
  std::map<const Model*, std::vector<std::unique_ptr<BestModel>>> models_;  ///< one per scale range
  BestScene scene_;
  CoarseSearch coarse_;
  std::vector<RefineScratch> scratch_;
  Arena arena_;  ///< of one search
  /// What a search still costs after it has been told to stop (the best candidate is followed to its end): taken off
  /// the budget in advance. The worst of the calls so far, slowly forgotten.
  double finishing_ms_ = kFirstFinishing_ms;
  static constexpr double kFirstFinishing_ms = 1.2;
};

}  // namespace pickcell::matches
