#pragma once
/// Step 4: the exact place, angle and scale of a candidate at full resolution.

#include <functional>
#include <vector>

#include "pickcell/matches/rst/settings.hpp"
#include "pickcell/matches/rst/window.hpp"

namespace pickcell::matches {

/// A window's place in the full picture.
struct RobustPlace {
  int x = 0, y = 0;   ///< of the anchor
  int angle_deg = 0;  ///< 0..359
  int scale = 0;      ///< place in the list of scales
};

struct RobustResult {
  RobustPlace place;
  double ncc = -2;
  double inside = 1;
  int ncc_count = 0;
};

struct RobustSearch {
  RstVariant variant = RstVariant::rst;
  int level = 2;  ///< NP: a pixel of the candidate's level is a block of 2^NP by 2^NP pixels
  int alpha_deg = 10;
  int scales = 3;
  LocationSearch location = LocationSearch::halving;
  const std::vector<bool>* allowed_deg = nullptr;  ///< 360 entries; null: all angles
};

/// NCC (by size when negatives are looked for) of the template at a place.
using PlaceScore = std::function<WindowScore(const RobustPlace&)>;

/// start: top-left pixel of the candidate's block, its angle and scale.
/// erst: every pixel of the block, every whole degree of [-alpha/2, alpha/2), every scale: 4^NP * alpha * NS.
/// rst: the place by halving steps (1 + 3 NP), then the angle by +-3, +-2, +-1 (7), then every scale (NS), each from
/// the winner of the one before: 17 for NP = 2, NS = 3, alpha = 10. The paper's text could also be read as trying all
/// scales with each place; only the sequence gives its number of 17.
[[nodiscard]] RobustResult search_robustly(const RobustSearch& how, const RobustPlace& start, const PlaceScore& score);

/// The angle offsets of rst: K, K-1, .., 1 with the smallest K that reaches alpha / 2.
[[nodiscard]] int first_angle_offset_deg(int alpha_deg);

}  // namespace pickcell::matches
