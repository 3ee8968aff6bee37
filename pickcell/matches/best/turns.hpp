#pragma once
/// Other angles at a place that was found. A round part with few features by which its angle can be told scores nearly
/// as well at wrong angles as at the right one, and the right one may have been dropped on the way down.

#include <memory_resource>
#include <vector>

#include "pickcell/matches/best/model.hpp"
#include "pickcell/matches/best/scene.hpp"
#include "pickcell/matches/fit/refine.hpp"
#include "pickcell/matches/work.hpp"

namespace pickcell::matches {

/// The hypothesis itself and the best other angles, each settled at level 0, best first. Sweeps the circle about the
/// anchor and, where the turns it finds have another centre in common, about that; as far as it is allowed (a little
/// beyond), at a middle level, one pixel at the rim per step, and follows the highest local maxima. Stops when the
/// budget is spent.
[[nodiscard]] std::pmr::vector<Hypothesis> settled_turns(const Hypothesis& found, const BestModel& model,
                                                         Range allowed_deg, BestScene& scene, RefineScratch& scratch,
                                                         WorkBudget& budget, std::pmr::memory_resource* memory);

}  // namespace pickcell::matches
