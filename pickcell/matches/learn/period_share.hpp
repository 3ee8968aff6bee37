#pragma once
/// Of what changes as a part turns, how much has a period: a gear's teeth all of it, a mark no more than chance.

#include <vector>

#include "pickcell/matches/learn/rings.hpp"

namespace pickcell::matches {

/// By period, 0 to most_period: the share, 0..1, of the energy of `rest` (laid out as the rings' samples) that changes
/// with it; 0 where the period is too weak to be told from noise and the pixel grid.
[[nodiscard]] std::vector<double> period_shares(const Rings& rings, const PartPicture& part,
                                                const std::vector<Rings::Sample>& rest, int most_period);

}  // namespace pickcell::matches
