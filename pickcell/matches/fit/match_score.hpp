#pragma once
/// The score that is reported: how surely a place shows the part. What guides the refinement (combined_score) must fall
/// off evenly around the right place; this must tell a part that is blurred, dim or partly covered from one that is not
/// there.

#include "pickcell/matches/fit/refine.hpp"

namespace pickcell::matches {

constexpr double kEdgesInScore = 0.6;

/// 0.2 NCC + 0.6 edges + 0.2 grey. Edges and grey are means over a grid of 4 x 4 blocks on the part, weighed by what
/// the template holds there: of the correlation of the scene's edge directions with the template's (blur and low
/// contrast weaken all of a scene's edges, which this does not mind), and of the NCC within the block (a shadow or an
/// occluder spoils its blocks only); of a part that is flat inside only edges count. 1 for the template itself, about 0
/// or below elsewhere. place: where h was judged, at the scene's level.
[[nodiscard]] double match_score(const SceneLevel& scene, const LevelModel& model, const Hypothesis& h,
                                 RefineScratch& scratch);

}  // namespace pickcell::matches
