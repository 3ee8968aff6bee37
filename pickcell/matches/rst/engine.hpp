#pragma once
/// The paper's matcher as two engines. Le, Li, Guo, Lien, "Embedded-Based Object Matching and Robot Arm Control", after
/// Kim & de Araujo, "Grayscale Template-Matching Invariant to Rotation, Scale, Translation, Brightness and Contrast"
/// (PSIVT 2007). docs/experiments.md says how it is read where the paper is silent.
///   rst_model    training: scales, circles, radial lines, turned templates
///   rst_filters  step 1 circles, step 2 radial lines, step 3 the template, at pyramid level NP
///   rst_robust   step 4 at full resolution; then overlapping finds are merged
/// erst and rst share everything but the comparison of step 2 and the search of step 4, so that the ratio of their
/// times is the method's. Score: NCC of the reported pose.

#include <map>
#include <memory>
#include <vector>

#include "pickcell/matches/coarse/kernel.hpp"
#include "pickcell/matches/engine.hpp"
#include "pickcell/matches/rst/filters.hpp"
#include "pickcell/matches/rst/model.hpp"
#include "pickcell/matches/rst/refine.hpp"
#include "pickcell/matches/rst/robust.hpp"
#include "pickcell/matches/rst/smooth.hpp"
#include "pickcell/matches/work.hpp"

namespace pickcell::matches {

class RstEngine final : public Engine {
 public:
  /// cpu_ms: the clock of SearchOptions::budget_ms, replaced in tests.
  explicit RstEngine(RstVariant variant, RstSettings settings = {}, WorkBudget::CpuClock cpu_ms = thread_cpu_ms);

  /// Errors (usage): options out of range, a model that cannot be prepared, a picture in which its largest circle does
  /// not fit. Throws std::invalid_argument for a null model or an empty list.
  [[nodiscard]] core::Result<FindResult> find(const image::Pyramid& scene, std::span<const Model* const> models,
                                              const SearchOptions& options) override;
  void prepare(std::span<const Model* const> models, const SearchOptions& options) override;
  [[nodiscard]] std::string name() const override { return variant_ == RstVariant::erst ? "erst" : "rst"; }
  [[nodiscard]] std::string isa() const override { return kernel_target(); }

 private:
  struct Find {
    const RstModel* model;
    Match match;
    RotatedRect outline;
  };
  [[nodiscard]] core::Result<RstModel*> prepared(const Model& model, Range scale);
  [[nodiscard]] core::Status search(const image::Pyramid& scene, RstModel& model, int model_index,
                                    const SearchOptions& options, WorkBudget& budget, std::vector<Find>& finds,
                                    FindResult& result);
  void robust_filter(const RstTask& task, image::ImageView picture, int model_index,
                     const std::vector<RstCandidate>& candidates, std::vector<Find>& finds, FindResult& result);
  void note(const RstTask& task, int model_index, const std::vector<RstCandidate>& dropped, Stage stage,
            FindResult& result) const;
  void merge(std::vector<Find> finds, const SearchOptions& options, FindResult& result);
  void limit_cache();

  RstVariant variant_;
  RstSettings settings_;
  WorkBudget::CpuClock cpu_ms_;
  std::map<const Model*, std::vector<std::unique_ptr<RstModel>>> models_;  ///< one per scale range
  RstRefine refine_;
  CoarsePicture coarse_;
};

}  // namespace pickcell::matches
