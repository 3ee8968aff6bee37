#pragma once
/// refine=subpixel: what rst and erst found, refined by engine best. Not in the paper.

#include <map>
#include <memory>

#include "pickcell/image/pyramid.hpp"
#include "pickcell/matches/best/scene.hpp"
#include "pickcell/matches/fit/refine.hpp"
#include "pickcell/matches/match.hpp"
#include "pickcell/matches/rst/model.hpp"

namespace pickcell::matches {

/// Not thread-safe. Keeps what it derives from a model.
class RstRefine {
 public:
  void start(const image::Pyramid& pyramid) { scene_.start(pyramid); }
  void prepare(const RstModel& model);
  /// Moves the pose and sets its score (NCC), visible share and covariance. Where too little of the part agrees for a
  /// fit, the covariance stays as it is (that of the grids).
  void run(const RstModel& model, Match& match);

 private:
  [[nodiscard]] const LevelModel& level(const RstModel& model);
  std::map<const RstModel*, std::unique_ptr<LevelModel>> levels_;
  BestScene scene_;
  RefineScratch scratch_;
};

}  // namespace pickcell::matches
