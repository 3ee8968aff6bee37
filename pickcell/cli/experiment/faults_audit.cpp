#include "pickcell/cli/experiment/faults_audit.hpp"

#include <set>
#include <string>

namespace pickcell::cli {

using robot::CommandState;

namespace {

void audit_row(const robot::JournalRow& row, const GripWatch::Closings& grips, FaultSoakReport& report) {
  const std::string who = "pick " + std::to_string(row.sequence);
  if (grips.all > 1)
    report.finding(report.executed_twice, who + " closed the gripper " + std::to_string(grips.all) + " times");
  if (row.state == CommandState::done && grips.took != 1)
    report.finding(report.lost, who + " is done and took nothing");
  if (row.state == CommandState::void_ && grips.all > 0) report.finding(report.lost, who + " is void and was executed");
  if (row.state == CommandState::intent || row.state == CommandState::sent)
    report.finding(report.lost, who + " was left open");
  if (grips.all > grips.took) report.finding(report.forbidden_motions, who + " gripped where no part lay");
}

void explain_unknown(const robot::JournalRow& row, const GripWatch::Closings& grips, const FaultOfPick& faults,
                     FaultSoakReport& report) {
  const auto fault = faults.find(row.sequence);
  ++report.unknown_after[fault == faults.end() ? kSoakFaults : static_cast<std::size_t>(fault->second)];
  ++(grips.took == 0 ? report.unknown_untouched : grips.placed > 0 ? report.unknown_placed : report.unknown_in_between);
}

}  // namespace

void audit_rows(const std::vector<robot::JournalRow>& rows, std::map<std::int32_t, GripWatch::Closings> closings,
                const FaultOfPick& faults, FaultSoakReport& report) {
  std::map<CommandState, int> count;
  for (const robot::JournalRow& row : rows) {
    ++count[row.state];
    audit_row(row, closings[row.sequence], report);
    if (row.state == CommandState::unknown) explain_unknown(row, closings[row.sequence], faults, report);
    closings.erase(row.sequence);
  }
  for (const auto& [sequence, grips] : closings)
    report.finding(report.lost, "pick " + std::to_string(sequence) + " was executed and no row knows");
  report.done = count[CommandState::done];
  report.refused = count[CommandState::refused];
  report.unknown = count[CommandState::unknown];
  report.withdrawn = count[CommandState::void_];
  report.parts = report.done + report.refused + report.unknown;
}

void audit_parts(sim::World& world, core::TimePoint now, FaultSoakReport& report) {
  std::set<std::uint64_t> placed;
  for (const sim::PlacedPart& part : world.placed())
    if (!placed.insert(part.id).second)
      report.finding(report.executed_twice, "part " + std::to_string(part.id) + " was placed twice");
  const sim::WorldCounts counts = world.counts(now);
  const int held = world.held() ? 1 : 0;
  if (counts.taken != counts.placed + counts.dropped + counts.returned + held)
    report.finding(report.lost, "parts were taken and are nowhere");
  if (counts.placed < report.done) report.finding(report.lost, "more picks are done than parts lie in the trays");
}

}  // namespace pickcell::cli
