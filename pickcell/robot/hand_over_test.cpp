#include "pickcell/robot/hand_over.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <stdexcept>

namespace pickcell::robot {
namespace {

using ::testing::ElementsAre;
using Kind = HandOverStep::Kind;

/// Registers and a record, and the words of what was done to them.
struct Bench {
  std::map<Register, std::int32_t> registers;
  std::vector<std::string> done;

  void run(HandOver& machine) {
    while (const HandOverStep* next = machine.next()) {
      const HandOverStep step = *next;
      const auto number = std::to_string(step.value);
      switch (step.kind) {
        case Kind::read:
          machine.done(registers[step.which]);
          continue;
        case Kind::write:
          registers[step.which] = step.value;
          done.push_back(word(step.which) + "=" + number);
          break;
        case Kind::write_poses:
          done.push_back("poses");
          break;
        case Kind::verify_poses:
          done.push_back("verify");
          break;
        case Kind::record_intent:
          done.push_back("intent " + number);
          break;
        case Kind::record_sent:
          done.push_back("sent " + number);
          break;
        case Kind::record_end:
          done.push_back("end " + number + " " + name(command_state(step.outcome)));
          break;
        case Kind::record_epoch:
          done.push_back("epoch " + std::to_string(step.epoch) + " after " + number);
          break;
      }
      machine.done();
    }
  }
  /// What the job does in its waiting loop.
  void acknowledge() {
    registers[Register::command] = 0;
    registers[Register::epoch_ack] = registers[Register::epoch];
  }
  void accept() {
    registers[Register::accepted] = registers[Register::sequence];
    registers[Register::command] = 2;
  }
  void finish(std::int32_t result, std::int32_t reason = 0) {
    registers[Register::reason] = reason;
    registers[Register::result] = result;
    registers[Register::done] = registers[Register::accepted];
    registers[Register::command] = result;
  }
  /// The job at *HELD, after a restart.
  void stand_held(std::int32_t reason) {
    registers[Register::reason] = reason;
    registers[Register::held_epoch] = registers[Register::epoch];
    registers[Register::command] = 9;
  }
  static std::string word(Register r) {
    switch (r) {
      case Register::command:
        return "command";
      case Register::part_class:
        return "class";
      case Register::epoch:
        return "epoch";
      case Register::command_epoch:
        return "command_epoch";
      case Register::sequence:
        return "sequence";
      case Register::sequence_copy:
        return "copy";
      default:
        return "?";
    }
  }
};

/// Connected, fenced and ready.
HandOver ready(Bench& bench, const HandOver::Past& past = {}) {
  HandOver machine;
  machine.connect(past);
  bench.run(machine);
  EXPECT_EQ(machine.phase(), HandOverPhase::fencing);
  bench.acknowledge();
  machine.look();
  bench.run(machine);
  EXPECT_EQ(machine.phase(), HandOverPhase::ready);
  bench.done.clear();
  return machine;
}

TEST(HandOver, RaisesTheFenceOnEveryConnectAndRecordsItFirst) {
  Bench bench;
  bench.registers[Register::epoch_ack] = 5;
  HandOver machine;
  machine.connect({.last_epoch = 3, .last_sequence = 8, .open = {}});
  bench.run(machine);
  EXPECT_THAT(bench.done, ElementsAre("epoch 6 after 8", "epoch=6"));
}

TEST(HandOver, WritesTheIntentFirstTheCopyNextAndTheCommandLast) {
  Bench bench;
  HandOver machine = ready(bench);
  machine.submit(4);
  bench.run(machine);
  EXPECT_EQ(machine.phase(), HandOverPhase::running);
  EXPECT_THAT(bench.done, ElementsAre("intent 10001", "copy=10001", "poses", "class=4", "command_epoch=1",
                                      "sequence=10001", "verify", "command=1", "sent 10001"));
}

TEST(HandOver, NeverWritesWhileACommandIsThere) {
  for (const std::int32_t there : {1, 2}) {
    Bench bench;
    HandOver machine = ready(bench);
    bench.registers[Register::command] = there;
    machine.submit(0);
    bench.run(machine);
    EXPECT_EQ(machine.phase(), HandOverPhase::fencing);
    EXPECT_NE(machine.problem(), "");
    EXPECT_THAT(bench.done, ElementsAre("epoch 2 after 0", "epoch=2"));
  }
}

TEST(HandOver, NeverGivesTheCommandWhenTheVariablesReadOtherwise) {
  Bench bench;
  HandOver machine = ready(bench);
  machine.submit(0);
  while (machine.next() && machine.next()->kind != Kind::verify_poses) {
    if (machine.next()->kind == Kind::write) bench.registers[machine.next()->which] = machine.next()->value;
    machine.done(0);
  }
  bench.registers[Register::sequence] = 77;  // another program
  bench.run(machine);
  EXPECT_EQ(bench.registers[Register::command], 0);
  EXPECT_EQ(machine.phase(), HandOverPhase::fencing);
}

TEST(HandOver, ReportsWhatTheJobReports) {
  for (const auto& [result, reason, kind] : {std::tuple{3, 0, OutcomeKind::done},
                                             {9, 2, OutcomeKind::refused},
                                             {9, 1, OutcomeKind::refused},
                                             {9, 7, OutcomeKind::unknown}}) {
    Bench bench;
    HandOver machine = ready(bench);
    machine.submit(0);
    bench.run(machine);
    machine.look();
    bench.run(machine);
    EXPECT_EQ(machine.phase(), HandOverPhase::running);
    bench.accept();
    machine.look();
    bench.run(machine);
    EXPECT_EQ(machine.phase(), HandOverPhase::running);
    EXPECT_TRUE(machine.take_settled().empty());
    bench.finish(result, reason);
    machine.look();
    bench.run(machine);
    EXPECT_EQ(machine.phase(), HandOverPhase::ready);
    const auto settled = machine.take_settled();
    ASSERT_EQ(settled.size(), 1u);
    EXPECT_EQ(settled.front().kind, kind);
    EXPECT_EQ(settled.front().sequence, 10001);
    EXPECT_NE(settled.front().text, "");
  }
}

TEST(HandOver, ADroppedCommandIsSettledOnlyBehindTheFence) {
  Bench bench;
  HandOver machine = ready(bench);
  machine.submit(0);
  bench.run(machine);
  bench.registers[Register::command] = 9;  // stale, says the job
  bench.registers[Register::reason] = kStale;
  machine.look();
  bench.run(machine);
  EXPECT_EQ(machine.phase(), HandOverPhase::fencing);
  EXPECT_TRUE(machine.take_settled().empty());
  bench.acknowledge();
  machine.look();
  bench.run(machine);
  EXPECT_EQ(machine.take_settled().front().kind, OutcomeKind::not_started);
  machine.submit(0);  // and its number is not used again
  bench.run(machine);
  EXPECT_EQ(machine.last_sequence(), 20001);
}

TEST(HandOver, RecoversTheOpenIntentByTheTableOfTheSpecification) {
  struct Case {
    std::int32_t accepted, done, result;
    OutcomeKind kind;
  };
  for (const Case& c : {Case{7, 7, 3, OutcomeKind::done}, Case{7, 7, 9, OutcomeKind::refused},
                        Case{7, 6, 3, OutcomeKind::unknown}, Case{6, 6, 3, OutcomeKind::not_started}}) {
    Bench bench;
    bench.registers[Register::accepted] = c.accepted;
    bench.registers[Register::done] = c.done;
    bench.registers[Register::result] = c.result;
    bench.registers[Register::reason] = kNothingGripped;
    HandOver machine;
    machine.connect({.last_epoch = 1, .last_sequence = 7, .open = {7}});
    bench.run(machine);
    const bool certain = c.done == 7;
    EXPECT_EQ(machine.take_settled().size(), certain ? 1u : 0u);
    EXPECT_EQ(machine.open().empty(), certain);
    if (certain) continue;
    machine.look();
    bench.run(machine);
    EXPECT_TRUE(machine.take_settled().empty()) << "not before the fence is acknowledged";
    bench.acknowledge();
    machine.look();
    bench.run(machine);
    const auto settled = machine.take_settled();
    ASSERT_EQ(settled.size(), 1u);
    EXPECT_EQ(settled.front().kind, c.kind);
    EXPECT_EQ(machine.phase(), HandOverPhase::ready);
  }
}

TEST(HandOver, NumbersAndEpochsGoOnAboveWhateverIsHighest) {
  Bench bench;
  bench.registers[Register::accepted] = bench.registers[Register::done] = 20;
  bench.registers[Register::sequence] = 70023;  // a command of epoch 7 that a lost journal knew of
  HandOver machine = ready(bench, {.last_epoch = 2, .last_sequence = 20007, .open = {}});
  EXPECT_EQ(machine.epoch(), 8);
  machine.submit(0);
  bench.run(machine);
  EXPECT_EQ(machine.last_sequence(), 80001);
}

TEST(HandOver, AfterTheLastNumberOfAnEpochComesTheNextEpoch) {
  Bench bench;
  HandOver machine = ready(bench);
  for (int i = 1; i < HandOver::kPicksPerEpoch; ++i) {
    ASSERT_EQ(machine.phase(), HandOverPhase::ready);
    machine.submit(0);
    bench.run(machine);
    ASSERT_EQ(machine.last_sequence(), 10000 + i);
    bench.accept();
    bench.finish(3);
    machine.look();
    bench.run(machine);
  }
  EXPECT_EQ(machine.phase(), HandOverPhase::fencing);
  bench.acknowledge();
  machine.look();
  bench.run(machine);
  machine.submit(0);
  bench.run(machine);
  EXPECT_EQ(machine.last_sequence(), 20001);
  EXPECT_EQ(bench.registers[Register::command_epoch], 2);
}

TEST(HandOver, AJournalThatDoesNotKnowTheControllersPastNeedsAPerson) {
  Bench bench;
  bench.registers[Register::accepted] = bench.registers[Register::done] = 20;
  HandOver machine;
  machine.connect({});
  bench.run(machine);
  EXPECT_EQ(machine.phase(), HandOverPhase::journal_missing);
  EXPECT_TRUE(bench.done.empty());
  EXPECT_THROW(machine.submit(0), std::logic_error);
  machine.confirm();
  bench.run(machine);
  EXPECT_THAT(bench.done, ElementsAre("epoch 1 after 20", "epoch=1"));
  EXPECT_EQ(machine.phase(), HandOverPhase::fencing);
}

TEST(HandOver, AnInterruptedPickWaitsForAPerson) {
  Bench bench;
  HandOver machine = ready(bench);
  machine.submit(0);
  bench.run(machine);
  bench.accept();
  bench.stand_held(kOutcomeUnknown);  // the controller lost power and was started again
  machine.look();
  bench.run(machine);
  EXPECT_EQ(machine.phase(), HandOverPhase::held);
  EXPECT_EQ(bench.registers[Register::epoch], 1);
  EXPECT_TRUE(machine.take_settled().empty());
  bench.done.clear();
  machine.confirm();
  bench.run(machine);
  EXPECT_THAT(bench.done, ElementsAre("end 10001 unknown", "epoch 2 after 10001", "epoch=2"));
  EXPECT_EQ(machine.take_settled().front().kind, OutcomeKind::unknown);
  machine.look();
  bench.run(machine);
  EXPECT_EQ(machine.phase(), HandOverPhase::fencing) << "the job is about to go on";
}

TEST(HandOver, ConnectingDoesNotLetAHeldJobGoOn) {
  for (const std::int32_t reason : {kOutcomeUnknown, kHeldGripperFull}) {
    Bench bench;
    bench.registers[Register::epoch] = bench.registers[Register::epoch_ack] = 4;
    bench.registers[Register::accepted] = 7;
    bench.registers[Register::done] = reason == kOutcomeUnknown ? 6 : 7;
    bench.stand_held(reason);
    HandOver machine;
    machine.connect({.last_epoch = 4, .last_sequence = 7, .open = {}});
    bench.run(machine);
    EXPECT_EQ(machine.phase(), HandOverPhase::held);
    EXPECT_EQ(bench.registers[Register::epoch], 4);
    machine.confirm();
    bench.run(machine);
    EXPECT_EQ(bench.registers[Register::epoch], 5);
  }
}

TEST(HandOver, APersonMayLookBeforeTheJobIsStartedAgain) {
  Bench bench;
  HandOver machine = ready(bench);
  machine.submit(0);
  bench.run(machine);
  bench.accept();
  machine.connect(
      {.last_epoch = 1, .last_sequence = 10001, .open = {10001}});  // the controller is back, the job stands
  bench.run(machine);
  bench.done.clear();
  machine.confirm();
  bench.run(machine);
  EXPECT_THAT(bench.done, ElementsAre("end 10001 unknown")) << "the part may have been taken out of the gripper";
  bench.stand_held(kOutcomeUnknown);
  bench.done.clear();
  machine.look();
  bench.run(machine);
  EXPECT_THAT(bench.done, ElementsAre("epoch 3 after 10001", "epoch=3")) << "answered once, asked once";
}

TEST(HandOver, AJobThatGoesOnAfterAPersonHasAnsweredTellsNothingNew) {
  Bench bench;
  HandOver machine = ready(bench);
  machine.submit(0);
  bench.run(machine);
  bench.accept();
  machine.connect({.last_epoch = 1, .last_sequence = 10001, .open = {10001}});
  bench.run(machine);
  machine.confirm();
  bench.run(machine);
  EXPECT_EQ(machine.take_settled().size(), 1u);
  bench.finish(3);
  bench.acknowledge();
  machine.look();
  bench.run(machine);
  EXPECT_EQ(machine.phase(), HandOverPhase::ready);
  EXPECT_TRUE(machine.take_settled().empty());
}

TEST(HandOver, ALateOldEpochIsRaisedAgain) {
  Bench bench;
  bench.registers[Register::epoch] = 8;
  HandOver machine;
  machine.connect({.last_epoch = 8, .last_sequence = 0, .open = {}});
  bench.run(machine);
  bench.registers[Register::epoch] = 3;
  machine.look();
  bench.run(machine);
  EXPECT_EQ(bench.registers[Register::epoch], 9);
}

TEST(HandOver, NothingIsDoneAfterAFailedStep) {
  Bench bench;
  HandOver machine = ready(bench);
  machine.submit(0);
  machine.lost();
  EXPECT_EQ(machine.next(), nullptr);
  EXPECT_EQ(machine.phase(), HandOverPhase::lost);
  EXPECT_THROW(machine.submit(0), std::logic_error);
}

TEST(HandOver, UsedUpEpochsAreSaid) {
  Bench bench;
  bench.registers[Register::epoch] = 32767;
  HandOver machine;
  machine.connect({});
  bench.run(machine);
  EXPECT_EQ(machine.phase(), HandOverPhase::lost);
  EXPECT_NE(machine.problem(), "");
}

}  // namespace
}  // namespace pickcell::robot
