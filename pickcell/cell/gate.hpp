#pragma once
/// Which matches go on to the planner, and with which open questions. The planner (picks) judges certainty, grasps,
/// space and places; here stands what only the match and its model can tell. Pure functions.

#include <optional>
#include <string>
#include <vector>

#include "pickcell/matches/match.hpp"
#include "pickcell/matches/model.hpp"

namespace pickcell::cell {

/// Why a detection is not picked. code is counted ("score", "uncertain", ...); why is for people.
struct Rejection {
  std::string code;
  std::string why;
};

/// Below the model's threshold, or a match that does not say how certain it is.
[[nodiscard]] std::optional<Rejection> judge(const matches::Match& match, const matches::Model& model);

/// The match's ambiguous angles without those at which the part itself is the same (its symmetry): picked at any of
/// them it is picked right.
[[nodiscard]] std::vector<double> open_ambiguities_deg(const matches::Match& match, const matches::Model& model);

}  // namespace pickcell::cell
