#include "pickcell/cell/fate.hpp"

namespace pickcell::cell {

Fate fate_of(const Sight::Seen& seen, const picks::Plan& plan) {
  if (seen.rejection) return {DetectionState::rejected, seen.rejection->code, seen.rejection->why};
  for (const picks::Refusal& refusal : plan.refusals)
    if (refusal.detection_id == seen.detection_id) return {DetectionState::rejected, name(refusal.reason), refusal.why};
  for (const picks::Pick& pick : plan.picks)
    if (pick.detection_id == seen.detection_id) return {DetectionState::queued, "", ""};
  return {DetectionState::found, "", ""};
}

bool hangs_on_the_past(std::string_view code, std::string_view why) {
  if (code == kGaveUp || code == name(picks::RefusalReason::pattern_full)) return true;
  // Which place a part would go to follows from those that are filled; where it lies does not.
  return code == name(picks::RefusalReason::box) && why.starts_with("place ");
}

}  // namespace pickcell::cell
