#pragma once
/// What a part and the mean of its turns by one angle differ in, once light and a centre that is a little off are
/// accounted for.

#include <vector>

#include "pickcell/matches/learn/rings.hpp"

namespace pickcell::matches {

struct TurnedRest {
  /// Of the part's variance, what its turn does not have; noise taken off. 0..1, as 1 - NCC of the part and its turn.
  double unlike = 1;
  double uncovered = 1;   ///< share of the part that its turn does not lie on
  double compared = 0;    ///< share of the picture's inside that has turns to be compared with
  double mark_px = 0;     ///< the largest area in one place that differs clearly
  double dx = 0, dy = 0;  ///< the centre lies there from where it was taken, pixels
  /// Differences as the samples of the rings; 0 where they say nothing. Of period 0 only: all of them.
  std::vector<Rings::Sample> rest;
};

/// period 0: turned by any angle.
[[nodiscard]] TurnedRest compare_turns(const Rings& rings, const PartPicture& part, int period);

}  // namespace pickcell::matches
