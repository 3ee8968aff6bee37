#pragma once
/// Every order of things that can happen to a hand-over, see hand_over_model_state.hpp, and the properties that must
/// hold in all of them.

#include <algorithm>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "hand_over_model_job.hpp"

namespace pickcell::robot {
namespace hand_over_model {

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
      if (s.journal_losses < bounds_.journal_losses) visit(without_journal(next));
      visit(std::move(next));
    }
    if (bounds_.eager_person && s.pc.phase() == HandOverPhase::fencing && !s.pc.next()) {
      State next = s;
      next.pc.confirm();
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

  static State without_journal(State s) {
    s.rows.clear();
    s.last_epoch = s.last_sequence = 0;
    s.settled_with_journal = false;
    ++s.journal_losses;
    return s;
  }

  /// One step of the PC; false when it has nothing to do.
  bool pc(State& s) {
    if (!s.pc.next() && !decide(s)) return false;
    if (s.pc.next()) perform(s);
    (void)s.pc.take_settled();
    const HandOverPhase phase = s.pc.phase();
    if (phase == HandOverPhase::journal_missing && s.settled_with_journal && s.journal_losses > 0) s.asked_again = true;
    if (phase == HandOverPhase::ready && !s.pc.next()) s.settled_with_journal = true;
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
      // What is no longer there is not seen; only a lost journal does not know it.
      const bool gone = s.journal_losses > 0 && std::any_of(s.gripped.begin(), s.gripped.end(),
                                                            [&](const auto& grip) { return grip.second == part; });
      if (taken || gone) continue;
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
        if (without_ == Without::epoch_record) break;
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
      if (r.sequence != sequence) continue;
      const bool ended = r.state != CommandState::intent && r.state != CommandState::sent;
      s.outcome_changed = s.outcome_changed || (ended && r.state != state);
      r.state = state;
    }
  }

  std::string violated(const State& s) const {
    if (s.asked_again) return "a person was asked twice about one lost journal";
    if (s.outcome_changed) return "an outcome changed";
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

}  // namespace hand_over_model
}  // namespace pickcell::robot
