#pragma once
/// The settings of the engines `rst` and `erst` (--set, --params). Defaults are the paper's (Le, Li, Guo, Lien); what
/// it does not have is off. Sources of the options: Kim & de Araujo, PSIVT 2007, with their errata.

#include <optional>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/matches/engine.hpp"

namespace pickcell::matches {

/// erst: the original RST as the paper embeds it; rst: the paper's fast method. Only steps 2 and 4 differ.
enum class RstVariant { erst, rst };

enum class RadialLength { largest, matched };  ///< lines of the largest scale, or of the candidate's
enum class WindowMask { rect, disc };          ///< pixels of the template that steps 3 and 4 compare
enum class PyramidFilter { box, binomial };    ///< 2 x 2 means, or [1 3 3 1] / 8 in both directions
/// Step 4 of rst: by halves of the block (as many places as the paper counts, and each can be the last one), from the
/// block's corner (as many; ties and overshoots cannot be taken back), or all around.
enum class LocationSearch { halving, quadrant, symmetric };

struct RstSettings {
  std::optional<int> pyramid_level;                 ///< NP; unset: by the template's size
  std::optional<std::vector<double>> scales;        ///< unset: by the asked-for range
  std::optional<int> scale_count;                   ///< NS: so many in geometric progression over the range
  PyramidFilter pyramid = PyramidFilter::binomial;  ///< the paper does not name it
  int smooth = 1;                                   ///< passes of [1 2 1] / 4 over template and picture at level NP
  int circles = 10;                                 ///< NC
  int angle_step_deg = 10;                          ///< alpha, a divisor of 360
  double t1 = 0.84;                                 ///< circular filter
  double t2 = 0.70;                                 ///< radial filter
  double t3 = 0.70;                                 ///< template filter
  std::optional<double> t4;                         ///< robust filter; unset: SearchOptions::min_score, or t3
  RadialLength radial_length = RadialLength::largest;
  int step3_tolerance = 0;      ///< 1: also the neighbouring scales and angles, the best is kept
  double suppress_px = 0;       ///< pixels of level NP between candidates of step 4; 0: keep all
  double t_contrast = 0;        ///< step 1: contrast ratio within (t, 1/t); 0: off
  double t_brightness = 1;      ///< step 1: brightness change at most this part of the range; 1: off
  bool match_negative = false;  ///< also find the negative of the template
  WindowMask mask = WindowMask::rect;
  LocationSearch location = LocationSearch::halving;
  double min_inside = 0.8;       ///< share of the window that must lie inside the picture
  bool refine_subpixel = false;  ///< refinement of engine `best` on what was found; negatives keep their place
};

/// engine: "rst" or "erst", for the errors. Unknown keys and malformed values are usage errors that name the known
/// keys.
[[nodiscard]] core::Result<RstSettings> parse_rst_settings(const Settings& settings, std::string_view engine);

/// NP by the paper's size classes: 1 for small templates (40..100 px), 2 for medium ones (100..200), 3 above. The class
/// of one that is not square is that of the square of its area, as data sets count it: 250 x 64 is medium.
[[nodiscard]] int pyramid_level_for(int width, int height);

/// Scales for a range: {lo} when it is a point; {0.9, 1, 1.1} for exactly that range; else 1 + ceil(ln(hi/lo)/ln 1.12)
/// in geometric progression, or `count` when given. Ascending.
[[nodiscard]] std::vector<double> scales_for(Range range, std::optional<int> count);

}  // namespace pickcell::matches
