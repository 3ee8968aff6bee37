#pragma once
/// Model of the hand-over (docs/belt.md section 10): the PC's real state machine and the real job VISPICK, with every
/// write that was ever sent arriving again at any time, crashes of both sides at every step, a journal that gets lost,
/// and a person who always says "go on". The job's instructions that neither read nor write a shared variable take no
/// step of their own; poses, pictures and wrong reads are outside the model (a pose is the part it belongs to).

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <unordered_set>
#include <vector>

#include "pickcell/robot/hand_over.hpp"
#include "pickcell/sim/job_program.hpp"

namespace pickcell::robot {

struct HandOverFingerprint {
  static void append(std::string& out, std::int32_t value) {
    // Numbers are epoch * 10000 + a few: one byte tells them apart here.
    const std::int32_t small = value / HandOver::kPicksPerEpoch * 16 + value % HandOver::kPicksPerEpoch;
    out += static_cast<char>(small);
  }
  /// What the decision at the end of a procedure looks at.
  static std::vector<Register> asked(HandOver::Then then) {
    using enum Register;
    switch (then) {
      case HandOver::Then::connected:
        return {epoch, epoch_ack, held_epoch, sequence, sequence_copy, accepted, done, result, reason, command};
      case HandOver::Then::fence_looked:
        return {epoch_ack, epoch, held_epoch, command, reason, accepted, done, result};
      case HandOver::Then::may_submit:
      case HandOver::Then::command_looked:
        return {command};
      case HandOver::Then::read_back:
        return {sequence_copy, part_class, command_epoch, sequence};
      case HandOver::Then::outcome_looked:
        return {done, result, command, reason, accepted, held_epoch};
      case HandOver::Then::nothing:
        break;
    }
    return {};
  }
  static void append(std::string& out, const HandOver& m) {
    for (const std::int32_t v : {static_cast<std::int32_t>(m.phase_), static_cast<std::int32_t>(m.then_), m.epoch_,
                                 m.last_sequence_, m.looked_at_ ? *m.looked_at_ : -1,
                                 static_cast<std::int32_t>(m.queue_.size()), static_cast<std::int32_t>(m.open_.size())})
      append(out, v);
    for (const HandOverStep& s : m.queue_) {
      for (const std::int32_t v : {static_cast<std::int32_t>(s.kind), static_cast<std::int32_t>(s.which), s.value,
                                   s.epoch, static_cast<std::int32_t>(s.outcome), s.result})
        append(out, v);
    }
    for (const std::int32_t n : m.open_) append(out, n);
    append(out, m.known(Register::accepted));
    append(out, m.known(Register::done));
    for (const Register r : asked(m.then_)) {  // of the others, what was read earlier is not asked again
      const bool still_to_be_read = std::any_of(m.queue_.begin(), m.queue_.end(), [r](const HandOverStep& s) {
        return s.kind == HandOverStep::Kind::read && s.which == r;
      });
      append(out, still_to_be_read ? 0 : m.known(r));
    }
  }
};

namespace hand_over_model {

using Kind = HandOverStep::Kind;
using sim::Operand;

/// What is taken away to see that the checker would notice.
enum class Without { nothing, fence, journal_first, epoch_in_the_number, command_epoch, epoch_record };

struct Bounds {
  int commands = 3, parts = 2, pc_crashes = 2, controller_crashes = 1, late_writes = 2;
  int journal_losses = 0;     ///< with a crash of the PC
  bool eager_person = false;  ///< says "go on" whenever a pick is interrupted, not only when asked
};

enum Cell {
  kB10,
  kB11,
  kB12,
  kB13,
  kI10,
  kI11,
  kI12,
  kI13,
  kI14,
  kI21,
  kD10,
  kD11,
  kD12,
  kD13,
  kD21,
  kD22,
  kP10,
  kP21,
  kCells
};

constexpr std::array<Cell, kRegisters> kCellOf = {kB10, kB11, kB12, kB13, kI10, kI11, kI12,
                                                  kI13, kI14, kD10, kD11, kD12, kD13};

struct Row {
  std::int32_t sequence = 0, part = 0;
  CommandState state{};
};

struct State {
  HandOver pc;
  bool pc_idle = true;    ///< between procedures
  std::int32_t part = 0;  ///< of the pick being submitted
  std::vector<Row> rows;  ///< the journal
  std::int32_t last_epoch = 0, last_sequence = 0;
  std::vector<HandOverStep> postponed;                         ///< Without::journal_first
  std::array<std::int32_t, kCells> cells{};                    ///< the controller's variables
  int line = -1;                                               ///< of the job; -1: it stands
  std::set<std::pair<int, std::int32_t>> sent;                 ///< every write there ever was: cell, value
  std::vector<std::pair<std::int32_t, std::int32_t>> gripped;  ///< sequence, part of the pose
  int pc_crashes = 0, controller_crashes = 0, late_writes = 0, journal_losses = 0;
  bool settled_with_journal = false;  ///< ready was reached since the journal was lost
  bool asked_again = false;           ///< a person was asked about a lost journal that had been settled
  bool outcome_changed = false;
};

inline std::string fingerprint(const State& s) {
  std::string out;
  const auto add = [&out](std::int32_t v) { HandOverFingerprint::append(out, v); };
  HandOverFingerprint::append(out, s.pc);
  add(s.pc.phase() == HandOverPhase::submitting || s.pc.next() ? s.part : 0);
  for (const Row& r : s.rows) add(r.sequence), add(r.part), add(static_cast<int>(r.state));
  add(s.last_epoch), add(s.last_sequence), add(static_cast<int>(s.postponed.size()));
  for (const std::int32_t v : s.cells) add(v);
  add(s.line);
  for (const auto& [cell, value] : s.sent) add(cell), add(value);
  for (const auto& [sequence, part] : s.gripped) add(sequence), add(part);
  add(s.pc_crashes), add(s.controller_crashes), add(s.late_writes), add(s.journal_losses);
  add(s.settled_with_journal), add(s.asked_again), add(s.outcome_changed);
  return out;
}

}  // namespace hand_over_model
}  // namespace pickcell::robot
