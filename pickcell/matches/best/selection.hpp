#pragma once
/// The last decisions: what becomes a match, what is turned down and why.

#include <memory_resource>
#include <optional>
#include <vector>

#include "pickcell/matches/best/follow.hpp"
#include "pickcell/matches/best/model.hpp"
#include "pickcell/matches/best/scene.hpp"
#include "pickcell/matches/engine.hpp"

namespace pickcell::matches {

/// Collects the finds of all models, then chooses. Parts exclude each other where their rectangles overlap, whatever
/// the model; each model has its own score limit.
class Selection {
 public:
  /// memory: for all that is kept until the result is written.
  Selection(BestScene& scene, const SearchOptions& options, const BestSettings& settings, RefineScratch& scratch,
            WorkBudget& budget, std::pmr::memory_resource* memory);
  void add(const BestModel& model, int model_index, Followed followed);
  /// Replaces the matches; adds its stage.
  void finish(FindResult& result);
  /// After finish(): of finds where no match is looked for, those that would be matches further inside are turned down
  /// because of the border.
  void add_at_border(const BestModel& model, int model_index, const Followed& followed);
  /// Replaces rejected: with options.explain all that was turned down, the most interesting first.
  void tell_rejected(FindResult& result);

 private:
  struct Entry {
    const BestModel* model;
    int model_index;
    Hypothesis h;
    double score;  ///< match_score of h
    RotatedRect outline;
    std::pmr::vector<double> ambiguous_deg;
    std::optional<Eigen::Matrix4d> covariance = {};  ///< of h.place, where a last look told it
  };
  struct Turned {
    Entry entry;
    RejectReason reason;
    Stage stage;
  };
  [[nodiscard]] Entry entry(const BestModel& model, int model_index, const Hypothesis& h, double score);
  [[nodiscard]] double score_of(const BestModel& model, const Hypothesis& h);
  [[nodiscard]] bool contender(const Entry& e) const;
  [[nodiscard]] double limit_of(const Entry& e) const;
  [[nodiscard]] Range angles_of(const Entry& e) const;
  void resolve_angle(Entry& e);
  void look_last(Entry& e);
  void hold_in_ranges(Entry& e);
  void note_ambiguity(Entry& e, double offset_deg, double score);
  /// The best score of anything of the same model elsewhere in the picture.
  [[nodiscard]] double rival_of(const Entry& e) const;
  void judge_leads();
  [[nodiscard]] bool cut_off(const Entry& e) const;
  [[nodiscard]] const RejectReason* fault(const Entry& e) const;
  /// Best first.
  [[nodiscard]] static bool before(const Entry& a, const Entry& b);
  void turn_down(Entry&& e, RejectReason reason);
  void describe(const Entry& e, Match& out);

  BestScene& scene_;
  const SearchOptions& options_;
  const BestSettings& settings_;
  RefineScratch& scratch_;
  WorkBudget& budget_;
  std::pmr::memory_resource* memory_;
  std::pmr::vector<Entry> entries_;
  std::pmr::vector<std::pair<const BestModel*, std::pmr::vector<Dropped>>> dropped_;  ///< of a single search
  std::pmr::vector<Turned> turned_;                                                   ///< with options.explain
};

}  // namespace pickcell::matches
