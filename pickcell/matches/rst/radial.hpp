#pragma once
/// Step 2: by how many lines the object is turned, from the radial features of template and picture.

#include <cstdint>
#include <span>
#include <vector>

#include "pickcell/matches/rst/settings.hpp"

namespace pickcell::matches {

/// Radial features in fixed point: whole numbers of 1/8 grey value, padded with zeros to whole kRstBlocks.
constexpr float kRadialUnit = 8;

/// Of the template: centred, twice in a row ("doubled Rq"), so that every turn of it is a run of the array.
struct RadialQuery {
  int lines = 0;
  std::vector<std::int16_t> doubled;
  std::int64_t sum = 0;     ///< over one turn; nearly 0
  std::int64_t sum_sq = 0;  ///< over one turn
};
[[nodiscard]] RadialQuery make_radial_query(std::span<const float> means);

/// Of the picture, about mid-grey.
struct RadialFeatures {
  std::vector<std::int16_t> values;
  std::int64_t sum = 0;
  std::int64_t sum_sq = 0;
};
/// means[j * stride], one per line.
void set_radial_features(const float* means, std::ptrdiff_t stride, int lines, RadialFeatures& out);

struct ShiftScore {
  int shift = 0;  ///< the object is turned by shift * alpha
  double ncc = -2;
  int compared = 0;  ///< turns that were looked at
};

/// Which turns may be found; empty: all.
using AllowedShifts = std::vector<int>;

/// e-RST: the query is turned line by line and the NCC is worked out anew for each turn, formula (1) of the paper.
[[nodiscard]] ShiftScore shift_by_ncc(const RadialQuery& query, const RadialFeatures& features,
                                      const AllowedShifts& allowed, bool negative);

/// rst: means and deviations do not change with the turn, so the dot product alone decides; one normalisation at the
/// end. Every second turn, then the two beside the best; every allowed turn when they are not all allowed. The constant
/// R * mean * mean that the paper's formula (3) leaves out is subtracted: without it t2 means nothing.
[[nodiscard]] ShiftScore shift_by_dot(const RadialQuery& query, const RadialFeatures& features,
                                      const AllowedShifts& allowed, bool negative);

/// The dot product of every turn looked at with stride 1: the same turn as shift_by_ncc (for tests).
[[nodiscard]] ShiftScore shift_by_every_dot(const RadialQuery& query, const RadialFeatures& features, bool negative);

}  // namespace pickcell::matches
