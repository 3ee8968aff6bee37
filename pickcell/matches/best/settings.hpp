#pragma once
/// The settings of engine `best` that --set and --params may change.

#include <string>

#include "pickcell/core/result.hpp"
#include "pickcell/matches/coarse/template.hpp"
#include "pickcell/matches/engine.hpp"

namespace pickcell::matches {

/// One way from the top level down.
struct PassSettings {
  CoarseDetail detail;
  int candidates = 48;  ///< local maxima of the coarse search that are followed
  int keep_top = 12;    ///< of them after the top level's refinement
  int keep_mid = 4;     ///< and after each further level
  double window = 0.3;  ///< candidates this much below the best are dropped
};

enum class Effort { quick, automatic, thorough };

struct BestSettings {
  PassSettings quick;
  PassSettings wide;                  ///< one part: more candidates of quick's coarse search; several: a finer one
  PassSettings thorough;              ///< a finer coarse search
  PassSettings last;                  ///< one part, found badly: more candidates of thorough's coarse search
  Effort effort = Effort::automatic;  ///< automatic: the next pass only where the one before is not sure
  double accept_ncc = 0.8;            ///< a pass's best match is believed from here on ...
  double accept_edge = 0.5;           ///< ... and here; or
  double accept_score = 0.6;          ///< from this score on, when nothing else in the picture ...
  double accept_margin = 0.12;        ///< ... comes this near to it
  double min_visible = 0.7;           ///< share of the part that must lie inside the picture
  double ambiguous_margin = 0.02;     ///< another angle this close in score makes the angle ambiguous

  BestSettings();
};

/// Keys: see the table in the source. Unknown keys, values that are no numbers and values out of range are usage errors
/// that name the known keys.
[[nodiscard]] core::Result<BestSettings> parse_best_settings(const Settings& settings);

}  // namespace pickcell::matches
