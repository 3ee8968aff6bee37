#pragma once
/// A pick goes to the controller at most once, and its outcome is known or flagged as unknown. The PC's half as a pure
/// state machine: it says what to do next (read, write, record) and is told the result; it does nothing itself, so that
/// a model checker can drive it through every delay, repetition and crash. The controller's half is the job VISPICK.
/// Source: docs/belt.md section 10, docs/yaskawa-protocols.md 4.1 and 4.2. Deviations: the job accepts (and so uses up)
/// a sequence before it checks window and gripper; it copies what it compares; held at its start it waits for an EPOCH
/// raised after that.

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/robot/journal.hpp"
#include "pickcell/robot/registers.hpp"
#include "pickcell/robot/robot.hpp"

namespace pickcell::robot {

enum class HandOverPhase {
  lost,             ///< nothing is known of the controller: connect()
  reading,          ///< reading back what the controller knows
  journal_missing,  ///< the controller has accepted picks that the journal does not know: confirm()
  fencing,          ///< EPOCH is raised, the job has not acknowledged it: look() again
  held,             ///< the job waits for a person: confirm()
  ready,            ///< fenced, nothing open
  submitting,       ///< a command is being written
  running,          ///< a command is with the controller: look() for its outcome
};
[[nodiscard]] const char* name(HandOverPhase phase);

/// One thing to be done by whoever drives the machine, in order, one at a time.
struct HandOverStep {
  enum class Kind {
    read,           ///< which -> done(value)
    write,          ///< which = value
    write_poses,    ///< both poses of the command
    verify_poses,   ///< both poses read back are those of the command
    record_intent,  ///< value = sequence, epoch; durable before the step is done
    record_sent,    ///< value = sequence
    record_end,     ///< value = sequence, with outcome and result
    record_epoch,   ///< epoch, value = last sequence known
  };
  Kind kind{};
  Register which{};
  std::int32_t value = 0;
  std::int32_t epoch = 0;
  OutcomeKind outcome{};
  int result = 0;  ///< the reason of a refusal
  bool operator==(const HandOverStep&) const = default;
};

/// One thread at a time; copyable. Procedures (connect, look, submit, fence, confirm) queue steps; drive them with
/// next() and done() until next() is null, then see phase(). A step that failed ends everything: lost().
class HandOver {
 public:
  /// Numbers of epoch e are e * kPicksPerEpoch + 1 and up: pick 50001 is the first of epoch 5. The job takes no number
  /// of an earlier epoch, so that a void command stays void even when its writes arrive again among those of a later
  /// one.
  static constexpr std::int32_t kPicksPerEpoch = 10000;

  /// What the journal knows.
  struct Past {
    std::int32_t last_epoch = 0;
    std::int32_t last_sequence = 0;
    std::vector<std::int32_t> open;  ///< sequences in state intent or sent
  };

  /// Reads the controller's variables, settles what is certain, raises the fence. From any phase.
  void connect(const Past& past);
  /// fencing, held: is the fence acknowledged? then settles what is open. running: has the outcome come?
  void look();
  /// Hands over one pick; phase must be ready (throws). After the steps: running, or problem() says why not.
  void submit(std::int32_t part_class);
  /// ready, running: raises the fence, unless the outcome is there already or the job waits for a person; look() then
  /// settles what is open. Other phases: nothing.
  void fence();
  /// A person has looked. journal_missing: goes on with the controller's numbers. held: an open pick becomes unknown,
  /// and the job goes on. fencing with an interrupted pick: it becomes unknown, whatever a job that is taken up again
  /// says of it later; the job goes on as soon as it says that it is held.
  void confirm();
  /// A step failed: the link, the controller or the journal.
  void lost();

  [[nodiscard]] const HandOverStep* next() const { return queue_.empty() ? nullptr : &queue_.front(); }
  /// The step next() named is done; value: what was read.
  void done(std::int32_t value = 0);

  [[nodiscard]] HandOverPhase phase() const { return phase_; }
  /// Why the last procedure did not reach its end; "" when it did.
  [[nodiscard]] const std::string& problem() const { return problem_; }
  /// Sequence of the last submitted command.
  [[nodiscard]] std::int32_t last_sequence() const { return last_sequence_; }
  [[nodiscard]] std::int32_t epoch() const { return epoch_; }
  [[nodiscard]] const std::vector<std::int32_t>& open() const { return open_; }
  [[nodiscard]] std::int32_t known(Register which) const { return known_[static_cast<std::size_t>(which)]; }
  /// Outcomes settled since the last call, oldest first.
  [[nodiscard]] std::vector<Outcome> take_settled();

 private:
  friend struct HandOverFingerprint;  ///< of the model checker: tells states apart (tests/cell)
  enum class Then { nothing, connected, fence_looked, may_submit, read_back, command_looked, outcome_looked };

  void read(std::initializer_list<Register> registers);
  void write(Register which, std::int32_t value);
  void read_outcome();
  void decide();
  void decide_connected();
  void decide_fence();
  void decide_submit();
  void decide_read_back();
  void decide_outcome();
  void raise_fence();
  void settle_finished();
  void settle_all();
  void settle(std::int32_t sequence, OutcomeKind kind);
  [[nodiscard]] OutcomeKind finished_as() const;
  [[nodiscard]] bool interrupted() const { return known(Register::accepted) > known(Register::done); }
  [[nodiscard]] bool waits_for_a_person() const;

  HandOverPhase phase_ = HandOverPhase::lost;
  Then then_ = Then::nothing;
  std::deque<HandOverStep> queue_;
  std::array<std::int32_t, kRegisters> known_{};
  std::int32_t epoch_ = 0;
  std::int32_t last_sequence_ = 0;
  std::int32_t part_class_ = 0;
  std::vector<std::int32_t> open_;
  std::optional<std::int32_t> looked_at_;  ///< the last accepted sequence when a person said: go on
  std::vector<Outcome> settled_;
  std::string problem_;
};

/// Words for an outcome, for log and operator.
[[nodiscard]] std::string outcome_text(OutcomeKind kind, int reason);

/// The state an outcome has in the journal.
[[nodiscard]] CommandState command_state(OutcomeKind kind);

}  // namespace pickcell::robot
