#pragma once
/// Whether the journal, the gripper and the parts tell the same story at the end of a soak.

#include <cstdint>
#include <map>
#include <vector>

#include "pickcell/cli/experiment/faults_soak.hpp"
#include "pickcell/cli/experiment/faults_watch.hpp"
#include "pickcell/robot/journal.hpp"

namespace pickcell::cli {

/// Which fault was ordered for which pick.
using FaultOfPick = std::map<std::int32_t, SoakFault>;

/// Counts the rows by their end, and notes what contradicts the gripper.
void audit_rows(const std::vector<robot::JournalRow>& rows, std::map<std::int32_t, GripWatch::Closings> closings,
                const FaultOfPick& faults, FaultSoakReport& report);
/// Parts are things: none is placed twice, and each that was gripped is somewhere. After audit_rows.
void audit_parts(sim::World& world, core::TimePoint now, FaultSoakReport& report);

}  // namespace pickcell::cli
