#pragma once
/// What changed between two searches of one picture: the recorded one and today's. Pure functions.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/cell/recorded_run.hpp"

namespace pickcell::cli {

/// Differences up to these are none. Another machine rounds in other places; a search that changed shows more.
struct Tolerance {
  double px = 0.05;
  double deg = 0.05;  ///< of the match, and of the part in the robot's frame
  double mm = 0.05;
  double scale_pct = 0.05;
  double score = 0.005;
};

/// What a comparison has to know of a part's model.
struct PartTraits {
  double reach_px = 3;     ///< finds whose centres lie farther apart are not one and the same
  int symmetry_order = 1;  ///< angles are compared modulo 360 degrees by this
};

enum class Change { same, changed, lost, added };
[[nodiscard]] const char* name(Change change);  ///< "same", "changed", "lost", "new"

/// One thing that was seen then, now, or both times. The differences are of both times, now less then.
struct FindChange {
  Change change = Change::same;
  std::optional<cell::RecordedFind> recorded, now;
  double off_px = 0;     ///< between the centres
  double off_deg = 0;    ///< modulo the symmetry
  double off_scale = 0;  ///< fraction of the recorded scale
  double off_score = 0;
  std::optional<double> off_mm, off_base_deg;  ///< where both could be located
  bool moved = false;                          ///< pose or place differ by more than the tolerance
  bool scored = false;                         ///< the score does
  bool judged = false;  ///< it is turned down now and was not, the other way round, or for another reason

  /// For sorting, worst first: what is picked or not, then how far it moved in tolerances.
  [[nodiscard]] double weight(const Tolerance& tolerance) const;
};

/// Each find is paired at most once: of one part, nearest first, within its reach. Those left over are lost or new.
/// Parts without traits have the default ones. In the order of the recorded ones, the new ones behind.
[[nodiscard]] std::vector<FindChange> compare(const std::vector<cell::RecordedFind>& recorded,
                                              const std::vector<cell::RecordedFind>& now,
                                              const std::map<std::string, PartTraits>& parts,
                                              const Tolerance& tolerance);

}  // namespace pickcell::cli
