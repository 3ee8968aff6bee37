#include "pickcell/robot/hand_over.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace pickcell::robot {

using Kind = HandOverStep::Kind;

namespace {

// Values of Register::command and Register::result.
constexpr std::int32_t kPickReady = 1, kTaken = 2, kDone = 3, kRefused = 9;
constexpr std::int32_t kMaxEpoch = std::numeric_limits<std::int16_t>::max();
constexpr std::int32_t kPicksPerEpoch = HandOver::kPicksPerEpoch;

Outcome outcome_of(const HandOverStep& record_end) {
  return {record_end.outcome, record_end.value, record_end.result, outcome_text(record_end.outcome, record_end.result)};
}

}  // namespace

void HandOver::read(std::initializer_list<Register> registers) {
  for (const Register r : registers) queue_.push_back({.kind = Kind::read, .which = r});
}

void HandOver::write(Register which, std::int32_t value) {
  queue_.push_back({.kind = Kind::write, .which = which, .value = value});
}

void HandOver::lost() {
  queue_.clear();
  then_ = Then::nothing;
  phase_ = HandOverPhase::lost;
}

std::vector<Outcome> HandOver::take_settled() { return std::exchange(settled_, {}); }

void HandOver::connect(const Past& past) {
  lost();
  problem_.clear();
  looked_at_.reset();
  epoch_ = past.last_epoch;
  last_sequence_ = past.last_sequence;
  open_ = past.open;
  phase_ = HandOverPhase::reading;
  read({Register::epoch, Register::epoch_ack, Register::held_epoch, Register::sequence, Register::sequence_copy,
        Register::accepted, Register::done, Register::result, Register::reason, Register::command});
  then_ = Then::connected;
}

void HandOver::look() {
  if (next()) throw std::logic_error("hand-over: a procedure is under way");
  problem_.clear();
  if (phase_ == HandOverPhase::fencing || phase_ == HandOverPhase::held) {
    // The acknowledgement first: once it is there, nothing that is read after it can change any more.
    read({Register::epoch_ack, Register::epoch, Register::held_epoch, Register::command, Register::reason,
          Register::accepted, Register::done, Register::result});
    then_ = Then::fence_looked;
  } else if (phase_ == HandOverPhase::running) {
    read({Register::command});
    then_ = Then::command_looked;
  }
}

void HandOver::submit(std::int32_t part_class) {
  if (phase_ != HandOverPhase::ready || next()) throw std::logic_error("hand-over: not ready for a pick");
  problem_.clear();
  part_class_ = part_class;
  read({Register::command});
  then_ = Then::may_submit;
}

void HandOver::fence() {
  if (next()) throw std::logic_error("hand-over: a procedure is under way");
  problem_.clear();
  if (phase_ == HandOverPhase::ready) raise_fence();
  if (phase_ == HandOverPhase::running) read_outcome();
}

void HandOver::read_outcome() {
  read({Register::done, Register::result, Register::command, Register::reason, Register::accepted,
        Register::held_epoch});
  then_ = Then::outcome_looked;
}

void HandOver::confirm() {
  if (next()) throw std::logic_error("hand-over: a procedure is under way");
  problem_.clear();
  const bool goes_on = phase_ == HandOverPhase::journal_missing || phase_ == HandOverPhase::held;
  const bool stands = phase_ == HandOverPhase::fencing && interrupted();
  if (goes_on || stands) looked_at_ = known(Register::accepted);
  if (phase_ == HandOverPhase::held || stands) {
    // For good, also where the job is taken up again at its line: the part may have been taken out of the gripper.
    for (const std::int32_t n : std::vector(open_)) {
      if (n <= known(Register::accepted) && n > known(Register::done)) settle(n, OutcomeKind::unknown);
    }
  }
  if (goes_on) raise_fence();
}

void HandOver::done(std::int32_t value) {
  const HandOverStep step = queue_.front();
  queue_.pop_front();
  if (step.kind == Kind::read) known_[static_cast<std::size_t>(step.which)] = value;
  if (step.kind == Kind::record_end) settled_.push_back(outcome_of(step));
  if (queue_.empty()) decide();
}

void HandOver::decide() {
  switch (std::exchange(then_, Then::nothing)) {
    case Then::nothing:
      return;
    case Then::connected:
      return decide_connected();
    case Then::fence_looked:
      return decide_fence();
    case Then::may_submit:
      return decide_submit();
    case Then::read_back:
      return decide_read_back();
    case Then::command_looked:
      if (known(Register::command) == kPickReady || known(Register::command) == kTaken) return;
      return read_outcome();
    case Then::outcome_looked:
      return decide_outcome();
  }
}

void HandOver::decide_connected() {
  epoch_ = std::max({epoch_, known(Register::epoch), known(Register::epoch_ack)});
  const bool strange = known(Register::accepted) > last_sequence_;
  last_sequence_ = std::max({last_sequence_, known(Register::sequence), known(Register::sequence_copy),
                             known(Register::accepted), known(Register::done)});
  if (strange) {
    phase_ = HandOverPhase::journal_missing;
    problem_ = "the controller has accepted picks up to number " + std::to_string(known(Register::accepted)) +
               ", which this journal does not know";
    return;
  }
  settle_finished();
  if (waits_for_a_person() && known(Register::held_epoch) >= known(Register::epoch)) {
    phase_ = HandOverPhase::held;  // raising the fence now would let the job go on
  } else {
    raise_fence();
  }
}

void HandOver::raise_fence() {
  // Every number of an epoch is above epoch * kPicksPerEpoch, so the job can tell that an older one is void.
  const std::int32_t next_epoch = std::max(epoch_ + 1, last_sequence_ / kPicksPerEpoch + 1);
  if (next_epoch > kMaxEpoch) {
    lost();
    problem_ = "the epoch counter of the controller is used up";
    return;
  }
  epoch_ = next_epoch;
  phase_ = HandOverPhase::fencing;
  queue_.push_back({.kind = Kind::record_epoch, .value = last_sequence_, .epoch = epoch_});
  write(Register::epoch, epoch_);
}

bool HandOver::waits_for_a_person() const {
  if (known(Register::command) != kRefused) return false;
  return (known(Register::reason) == kOutcomeUnknown && interrupted()) || known(Register::reason) == kHeldGripperFull;
}

void HandOver::decide_fence() {
  if (known(Register::epoch_ack) == epoch_) {
    looked_at_.reset();
    settle_all();
    phase_ = HandOverPhase::ready;
    return;
  }
  if (known(Register::epoch_ack) > epoch_) {  // somebody else raised it too: it must be ours
    epoch_ = std::max(known(Register::epoch_ack), known(Register::epoch));
    return raise_fence();
  }
  if (known(Register::epoch) < epoch_) write(Register::epoch, epoch_);  // a late old write lowered it
  const bool held = waits_for_a_person() && known(Register::held_epoch) >= epoch_;
  phase_ = held ? HandOverPhase::held : HandOverPhase::fencing;
  if (held && looked_at_ == known(Register::accepted)) {
    queue_.clear();
    confirm();
  }
}

void HandOver::decide_submit() {
  if (known(Register::command) == kPickReady || known(Register::command) == kTaken) {
    problem_ = "the controller still shows another command";
    return raise_fence();
  }
  const std::int32_t n = last_sequence_ = std::max(last_sequence_, epoch_ * kPicksPerEpoch) + 1;
  open_.push_back(n);
  phase_ = HandOverPhase::submitting;
  queue_.push_back({.kind = Kind::record_intent, .value = n, .epoch = epoch_});
  write(Register::sequence_copy, n);  // from here the job takes nothing until `sequence` says the same
  queue_.push_back({.kind = Kind::write_poses});
  write(Register::part_class, part_class_);
  write(Register::command_epoch, epoch_);
  write(Register::sequence, n);
  queue_.push_back({.kind = Kind::verify_poses});
  read({Register::sequence_copy, Register::part_class, Register::command_epoch, Register::sequence});
  then_ = Then::read_back;
}

void HandOver::decide_read_back() {
  const std::int32_t n = last_sequence_;
  if (known(Register::sequence_copy) != n || known(Register::sequence) != n ||
      known(Register::part_class) != part_class_ || known(Register::command_epoch) != epoch_) {
    problem_ = "the variables read back differ from those written";
    return raise_fence();
  }
  write(Register::command, kPickReady);
  queue_.push_back({.kind = Kind::record_sent, .value = n});
  phase_ = HandOverPhase::running;
}

void HandOver::decide_outcome() {
  settle_finished();
  if (open_.empty() && last_sequence_ % kPicksPerEpoch != kPicksPerEpoch - 1) {
    phase_ = HandOverPhase::ready;
  } else if (waits_for_a_person() && known(Register::held_epoch) >= epoch_) {
    phase_ = HandOverPhase::held;  // the controller was restarted; raising the fence now would let the job go on
  } else {
    // The job dropped the command: only behind the fence is it certain that it stays dropped. Or the numbers of this
    // epoch are used up.
    raise_fence();
  }
}

OutcomeKind HandOver::finished_as() const {
  if (known(Register::result) == kDone) return OutcomeKind::done;
  if (known(Register::result) == kRefused && known(Register::reason) != kOutcomeUnknown) return OutcomeKind::refused;
  return OutcomeKind::unknown;
}

void HandOver::settle_finished() {
  for (const std::int32_t n : std::vector(open_)) {
    if (n == known(Register::done)) settle(n, finished_as());
  }
}

void HandOver::settle_all() {
  settle_finished();
  for (const std::int32_t n : std::vector(open_)) {
    settle(n, n <= known(Register::accepted) ? OutcomeKind::unknown : OutcomeKind::not_started);
  }
}

void HandOver::settle(std::int32_t sequence, OutcomeKind kind) {
  const int reason = kind == OutcomeKind::refused ? known(Register::reason) : 0;
  HandOverStep record{.kind = Kind::record_end, .value = sequence};
  record.outcome = kind;
  record.result = reason;
  queue_.push_back(record);
  std::erase(open_, sequence);
}

CommandState command_state(OutcomeKind kind) {
  switch (kind) {
    case OutcomeKind::done:
      return CommandState::done;
    case OutcomeKind::refused:
      return CommandState::refused;
    case OutcomeKind::not_started:
      return CommandState::void_;
    case OutcomeKind::unknown:
      return CommandState::unknown;
  }
  return CommandState::unknown;
}

std::string outcome_text(OutcomeKind kind, int reason) {
  switch (kind) {
    case OutcomeKind::done:
      return "placed";
    case OutcomeKind::not_started:
      return "withdrawn before the arm took it";
    case OutcomeKind::unknown:
      return "interrupted: nobody knows whether the part was moved";
    case OutcomeKind::refused:
      break;
  }
  switch (reason) {
    case kOutsideWindow:
      return "refused by the job: pose outside its window";
    case kNothingGripped:
      return "nothing in the gripper after gripping";
    case kLostOnTheWay:
      return "the part was lost on the way";
    case kGripperNotEmpty:
      return "refused by the job: something is in the gripper";
    default:
      return "refused by the job with reason " + std::to_string(reason);
  }
}

const char* name(HandOverPhase phase) {
  switch (phase) {
    case HandOverPhase::lost:
      return "lost";
    case HandOverPhase::reading:
      return "reading";
    case HandOverPhase::journal_missing:
      return "journal_missing";
    case HandOverPhase::fencing:
      return "fencing";
    case HandOverPhase::held:
      return "held";
    case HandOverPhase::ready:
      return "ready";
    case HandOverPhase::submitting:
      return "submitting";
    case HandOverPhase::running:
      return "running";
  }
  return "?";
}

const char* name(CommandState state) {
  switch (state) {
    case CommandState::intent:
      return "intent";
    case CommandState::sent:
      return "sent";
    case CommandState::done:
      return "done";
    case CommandState::refused:
      return "refused";
    case CommandState::void_:
      return "void";
    case CommandState::unknown:
      return "unknown";
  }
  return "?";
}

}  // namespace pickcell::robot
