#pragma once
/// Where a search lost a pose that is known to be there.

#include <string>

#include "pickcell/cli/bench/dataset.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/image/pyramid.hpp"
#include "pickcell/matches/engine.hpp"

namespace pickcell::cli {

/// Where a search turned the true pose down.
struct Loss {
  std::string stage;  ///< the furthest stage that a candidate near the true pose reached; "none": there was none
  std::string why;    ///< reason and score
};

/// Searches once more, watching the true pose. how: the search that did not find it; symmetry_deg: of the template.
[[nodiscard]] core::Result<Loss> explain_loss(matches::Engine& engine, const image::Pyramid& picture,
                                              const matches::Model& model, const TruthPose& truth, double symmetry_deg,
                                              matches::SearchOptions how);

}  // namespace pickcell::cli
