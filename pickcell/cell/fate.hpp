#pragma once
/// What becomes of one thing that a picture shows: to be picked, left for later, or turned down by its match or by the
/// plan. Pure functions; the cell records what they say, a replay says it again.

#include <string>
#include <string_view>

#include "pickcell/cell/cell_port.hpp"
#include "pickcell/cell/vision.hpp"
#include "pickcell/picks/planner.hpp"

namespace pickcell::cell {

struct Fate {
  DetectionState state = DetectionState::found;  ///< queued, rejected, or found: neither
  std::string code;                              ///< of a rejection: "score", "clearance", ...; else empty
  std::string why;                               ///< the same for people
};

[[nodiscard]] Fate fate_of(const Sight::Seen& seen, const picks::Plan& plan);

/// The code of parts that are left alone because picking them failed too often.
constexpr std::string_view kGaveUp = "gave_up";

/// A rejection that what the picture shows does not explain: it hangs on which places are filled and what failed
/// before.
[[nodiscard]] bool hangs_on_the_past(std::string_view code, std::string_view why);

}  // namespace pickcell::cell
