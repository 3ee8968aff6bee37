#pragma once
/// What a run of N picks came to (docs/interfaces.md, start / serve --picks N --json).

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/cell/cell.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/picks/planner.hpp"
#include "pickcell/sim/world.hpp"

namespace pickcell::cli {

/// Place errors against the truth, where a simulation knows it.
struct PlaceErrors {
  std::vector<double> mm, deg;
  int strange = 0;     ///< placed parts of a kind that no tray is for
  int duplicates = 0;  ///< parts that were placed more than once
  int dropped = 0;     ///< fell out of the gripper, or were put where no tray is
};

[[nodiscard]] PlaceErrors judge_places(sim::World& world, core::TimePoint end, const picks::PlannerSettings& planner);

struct CellReport {
  std::int64_t asked = 0;
  cell::Counters counters;
  std::vector<double> match_ms, cycle_s;
  std::optional<PlaceErrors> places;  ///< empty on a real cell
  double sim_seconds = 0, wall_seconds = 0;
  double limit_mm = 1, limit_deg = 1;
  std::string run;  ///< the folder of its record
  std::string end;  ///< why the cell stands

  /// All that were asked for are placed, none wrong, none twice, none lost.
  [[nodiscard]] bool good() const;
  [[nodiscard]] core::Json json() const;
  /// For people, several lines.
  [[nodiscard]] std::string words() const;
};

}  // namespace pickcell::cli
