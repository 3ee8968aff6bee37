// Model check of the hand-over (docs/belt.md section 10): the PC's real state machine and the real job VISPICK, with
// every write that was ever sent arriving again at any time, crashes of both sides at every step, and a person who
// always says "go on". The job's instructions that neither read nor write a shared variable take no step of their own;
// poses, pictures and wrong reads are outside the model (a pose is the part it belongs to).

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <string>
#include <unordered_set>
#include <vector>

#include "pickcell/core/file.hpp"
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

namespace {

using Kind = HandOverStep::Kind;
using sim::Operand;

/// What is taken away to see that the checker would notice.
enum class Without { nothing, fence, journal_first, epoch_in_the_number };

struct Bounds {
  int commands = 3, parts = 2, pc_crashes = 2, controller_crashes = 1, late_writes = 2;
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
  int pc_crashes = 0, controller_crashes = 0, late_writes = 0;
};

std::string fingerprint(const State& s) {
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
  add(s.pc_crashes), add(s.controller_crashes), add(s.late_writes);
  return out;
}

/// The job, one shared variable at a time.
class Job {
 public:
  Job(const sim::JobProgram& program, Without without) : lines_(program.lines), without_(without) {}

  /// One step of the running job and all that follows it unseen.
  void step(State& s) const {
    bool touched = false;
    for (;;) {
      const auto& i = lines_[static_cast<std::size_t>(s.line)];
      if (shared(i)) {
        if (touched) return;
        touched = true;
      }
      execute(s, i);
      if (s.line < 0 || i.op == sim::Op::timer) {
        // After a wait the job asks none of its own copies before it has made new ones.
        for (const Cell own : {kI21, kD21, kD22, kP21}) s.cells[own] = 0;
        return;
      }
    }
  }

 private:
  static int cell(const Operand& o) {
    const auto in = [&](int first, int last, int base) {
      return o.index >= first && o.index <= last ? base + o.index - first : -1;
    };
    switch (o.kind) {
      case Operand::Kind::B:
        return in(10, 13, kB10);
      case Operand::Kind::I:
        return o.index == 21 ? kI21 : in(10, 14, kI10);
      case Operand::Kind::D:
        return o.index == 21 ? kD21 : o.index == 22 ? kD22 : in(10, 13, kD10);
      case Operand::Kind::P:
        return o.index == 10 ? kP10 : o.index == 21 ? kP21 : -1;
      default:
        return -1;
    }
  }

  /// Seen by the PC, or written by it.
  static bool shared(int cell) {
    return cell >= 0 && cell != kB12 && cell != kI21 && cell != kD21 && cell != kD22 && cell != kP21;
  }
  static bool shared(const sim::Instruction& i) {
    if (i.op == sim::Op::output) return true;
    bool any = shared(cell(i.a)) || shared(cell(i.b));
    if (i.condition) {
      for (const auto& t : i.condition->terms) any = any || shared(cell(t.left)) || shared(cell(t.right));
    }
    return any;
  }

  std::int32_t value(const State& s, const Operand& o) const {
    const int c = cell(o);
    return c >= 0 ? s.cells[static_cast<std::size_t>(c)] : static_cast<std::int32_t>(o.number);
  }

  /// Contacts and the window never hinder; without the fence the job does not ask for epochs.
  bool holds(const State& s, const sim::Condition& condition) const {
    for (const auto& t : condition.terms) {
      if (t.left.kind == Operand::Kind::IN || cell(t.left) < 0) return false;
      const bool of_number = cell(t.right) == kD22, of_command = cell(t.left) == kI13;
      if (without_ == Without::fence && (of_number || of_command)) return false;
      if (without_ == Without::epoch_in_the_number && of_number) return false;
      const std::int32_t l = value(s, t.left), r = value(s, t.right);
      const bool yes = t.compare == sim::Compare::equal        ? l == r
                       : t.compare == sim::Compare::not_equal  ? l != r
                       : t.compare == sim::Compare::less       ? l < r
                       : t.compare == sim::Compare::greater    ? l > r
                       : t.compare == sim::Compare::less_equal ? l <= r
                                                               : l >= r;
      if (!yes) return false;
    }
    return true;
  }

  void execute(State& s, const sim::Instruction& i) const {
    int next = s.line + 1;
    switch (i.op) {
      case sim::Op::jump:
        if (!i.condition || holds(s, *i.condition)) next = static_cast<int>(i.target);
        break;
      case sim::Op::set:
        if (const int c = cell(i.a); c >= 0) s.cells[static_cast<std::size_t>(c)] = value(s, i.b);
        break;
      case sim::Op::mul:
        if (const int c = cell(i.a); c >= 0) s.cells[static_cast<std::size_t>(c)] *= value(s, i.b);
        break;
      case sim::Op::output:
        if (i.value == 1) s.gripped.emplace_back(s.cells[kD12], s.cells[kP21]);
        break;
      case sim::Op::end:
        next = -1;
        break;
      default:
        break;
    }
    s.line = next;
  }

  const std::vector<sim::Instruction>& lines_;
  Without without_;
};

class Checker {
 public:
  Checker(const sim::JobProgram& program, Bounds bounds, Without without)
      : bounds_(bounds), without_(without), job_(program, without) {}

  /// The first violated property, or "" when none is in reach.
  std::string run(std::size_t limit) {
    visit(State{});
    while (!stack_.empty() && violation_.empty() && seen_.size() < limit) {
      const State s = std::move(stack_.back());
      stack_.pop_back();
      expand(s);
    }
    return violation_;
  }
  [[nodiscard]] std::size_t states() const { return seen_.size(); }
  [[nodiscard]] bool complete() const { return stack_.empty(); }
  /// Somewhere all parts were picked and recorded as done.
  [[nodiscard]] bool reached_the_end() const { return all_done_; }

 private:
  void visit(State s) {
    if (violation_.empty()) violation_ = violated(s);
    const auto done =
        std::count_if(s.rows.begin(), s.rows.end(), [](const Row& r) { return r.state == CommandState::done; });
    all_done_ = all_done_ || done == bounds_.parts;
    if (seen_.insert(std::hash<std::string>{}(fingerprint(s))).second) stack_.push_back(std::move(s));
  }

  void expand(const State& s) {
    {
      State next = s;
      if (pc(next)) visit(std::move(next));
    }
    if (s.pc_crashes < bounds_.pc_crashes) {
      State next = s;  // its last write may be on the way
      if (const HandOverStep* step = s.pc.next(); step && step->kind == Kind::write) note_sent(next, *step);
      next.pc = HandOver{};
      next.postponed.clear();
      ++next.pc_crashes;
      visit(std::move(next));
    }
    if (s.line >= 0) {
      State next = s;
      job_.step(next);
      visit(std::move(next));
    } else {
      State next = s;
      next.line = 0;
      visit(std::move(next));
    }
    if (s.line >= 0 && s.controller_crashes < bounds_.controller_crashes) {
      State next = s;  // power loss; variables survive
      next.line = -1;
      ++next.controller_crashes;
      visit(std::move(next));
    }
    if (s.late_writes < bounds_.late_writes) {
      for (const auto& [cell, value] : s.sent) {
        if (s.cells[static_cast<std::size_t>(cell)] == value) continue;
        State next = s;
        next.cells[static_cast<std::size_t>(cell)] = value;
        ++next.late_writes;
        visit(std::move(next));
      }
    }
  }

  /// One step of the PC; false when it has nothing to do.
  bool pc(State& s) {
    if (!s.pc.next() && !decide(s)) return false;
    if (s.pc.next()) perform(s);
    (void)s.pc.take_settled();
    return true;
  }

  bool decide(State& s) {
    switch (s.pc.phase()) {
      case HandOverPhase::lost: {
        HandOver::Past past{s.last_epoch, s.last_sequence, {}};
        for (const Row& r : s.rows) {
          if (r.state == CommandState::intent || r.state == CommandState::sent) past.open.push_back(r.sequence);
        }
        s.pc.connect(past);
        return true;
      }
      case HandOverPhase::journal_missing:
      case HandOverPhase::held:
        s.pc.confirm();
        return true;
      case HandOverPhase::fencing:
      case HandOverPhase::running:
        s.pc.look();
        return true;
      case HandOverPhase::ready:
        return submit_next(s);
      default:
        return false;
    }
  }

  bool submit_next(State& s) {
    if (static_cast<int>(s.rows.size()) >= bounds_.commands) return false;
    for (std::int32_t part = 1; part <= bounds_.parts; ++part) {
      const bool taken = std::any_of(s.rows.begin(), s.rows.end(),
                                     [&](const Row& r) { return r.part == part && r.state != CommandState::void_; });
      if (taken) continue;
      s.part = part;
      s.pc.submit(0);
      return true;
    }
    return false;
  }

  void note_sent(State& s, const HandOverStep& step) const {
    if (without_ == Without::fence && step.which == Register::epoch) return;
    if (step.which != Register::part_class) s.sent.emplace(kCellOf[static_cast<std::size_t>(step.which)], step.value);
  }

  void perform(State& s) const {
    const HandOverStep step = *s.pc.next();
    std::int32_t value = 0;
    switch (step.kind) {
      case Kind::read:
        value = s.cells[kCellOf[static_cast<std::size_t>(step.which)]];
        if (without_ == Without::fence && step.which == Register::epoch_ack) value = s.pc.epoch();
        break;
      case Kind::write:
        note_sent(s, step);
        if (without_ != Without::fence || step.which != Register::epoch)
          s.cells[kCellOf[static_cast<std::size_t>(step.which)]] = step.value;
        break;
      case Kind::write_poses:
        s.cells[kP10] = s.part;
        break;
      case Kind::verify_poses:
        break;
      case Kind::record_intent:
        if (without_ == Without::journal_first) {
          s.postponed.push_back(step);
        } else {
          record(s, step);
        }
        break;
      case Kind::record_sent:
        for (const HandOverStep& p : s.postponed) record(s, p);
        s.postponed.clear();
        set(s, step.value, CommandState::sent);
        break;
      case Kind::record_end:
        set(s, step.value, command_state(step.outcome));
        break;
      case Kind::record_epoch:
        s.last_epoch = step.epoch;
        s.last_sequence = std::max(s.last_sequence, step.value);
        break;
    }
    s.pc.done(value);
  }

  static void record(State& s, const HandOverStep& intent) {
    s.rows.push_back({intent.value, s.part, CommandState::intent});
    s.last_sequence = std::max(s.last_sequence, intent.value);
  }
  static void set(State& s, std::int32_t sequence, CommandState state) {
    for (Row& r : s.rows) {
      if (r.sequence == sequence) r.state = state;
    }
  }

  std::string violated(const State& s) const {
    for (std::size_t i = 0; i < s.gripped.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (s.gripped[i].first == s.gripped[j].first) return "a command was executed twice";
        if (s.gripped[i].second == s.gripped[j].second) return "a part was picked twice";
      }
    }
    for (const Row& r : s.rows) {
      const bool ran =
          std::any_of(s.gripped.begin(), s.gripped.end(), [&](const auto& g) { return g.first == r.sequence; });
      if (r.state == CommandState::void_ && ran) return "a void command was executed";
      if (r.state == CommandState::done && !ran) return "done without a run";
    }
    return {};
  }

  Bounds bounds_;
  Without without_;
  Job job_;
  std::unordered_set<std::size_t> seen_;
  std::vector<State> stack_;
  std::string violation_;
  bool all_done_ = false;
};

class HandOverModel : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto text = core::read_text_file(std::filesystem::path(PICKCELL_SOURCE_DIR) / "docs/inform/VISPICK.JBI");
    ASSERT_TRUE(text);
    auto parsed = sim::parse_job(*text);
    ASSERT_TRUE(parsed) << parsed.error().why;
    program_ = std::move(*parsed);
  }
  sim::JobProgram program_;
};

constexpr std::size_t kLimit = 6'000'000;

TEST_F(HandOverModel, NothingIsPickedTwiceAndVoidStaysVoid) {
  for (const Bounds& bounds : {Bounds{.commands = 2, .pc_crashes = 1, .controller_crashes = 0, .late_writes = 2},
                               Bounds{.commands = 2, .pc_crashes = 1, .controller_crashes = 1, .late_writes = 1},
                               Bounds{.commands = 3, .pc_crashes = 2, .controller_crashes = 0, .late_writes = 1},
                               Bounds{.commands = 3, .pc_crashes = 2, .controller_crashes = 1, .late_writes = 0}}) {
    Checker checker(program_, bounds, Without::nothing);
    EXPECT_EQ(checker.run(kLimit), "");
    EXPECT_TRUE(checker.complete());
    EXPECT_GT(checker.states(), 500'000u) << "the model does not move";
    EXPECT_TRUE(checker.reached_the_end());
  }
}

TEST_F(HandOverModel, WithoutTheFenceItWouldFail) {
  Checker checker(program_, {.commands = 2, .pc_crashes = 1, .controller_crashes = 0, .late_writes = 1},
                  Without::fence);
  EXPECT_EQ(checker.run(kLimit), "a void command was executed");
}

TEST_F(HandOverModel, WithoutTheJournalFirstItWouldFail) {
  Checker checker(program_, {.commands = 2, .pc_crashes = 1, .controller_crashes = 0, .late_writes = 0},
                  Without::journal_first);
  EXPECT_EQ(checker.run(kLimit), "a part was picked twice");
}

/// Variables are no atomic command: three late writes complete a void one among those of the next.
TEST_F(HandOverModel, WithoutTheEpochInTheNumberItWouldFail) {
  Checker checker(program_, {.commands = 2, .pc_crashes = 1, .controller_crashes = 0, .late_writes = 3},
                  Without::epoch_in_the_number);
  EXPECT_NE(checker.run(kLimit), "");
}

}  // namespace
}  // namespace pickcell::robot
