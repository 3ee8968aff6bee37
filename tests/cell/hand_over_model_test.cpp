// Model check of the hand-over: see hand_over_model.hpp.

#include <gtest/gtest.h>

#include <filesystem>

#include "hand_over_model.hpp"
#include "pickcell/core/file.hpp"

namespace pickcell::robot {
namespace {

using hand_over_model::Bounds;
using hand_over_model::Checker;
using hand_over_model::Without;

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

/// The job asks twice whether a command is of this epoch. The second question (the number) is the stronger one; the
/// first (I013, which a job after the reference's example has alone) still stands against one stray write.
TEST_F(HandOverModel, EachQuestionForTheEpochHoldsWithoutTheOther) {
  const Bounds a_stray{.commands = 2, .pc_crashes = 1, .controller_crashes = 0, .late_writes = 1};
  for (const Without one : {Without::epoch_in_the_number, Without::command_epoch}) {
    Checker checker(program_, a_stray, one);
    EXPECT_EQ(checker.run(kLimit), "");
    EXPECT_TRUE(checker.complete());
    EXPECT_TRUE(checker.reached_the_end());
  }
}

TEST_F(HandOverModel, ALostJournalIsAskedForOnce) {
  const Bounds lost{.commands = 2, .pc_crashes = 2, .controller_crashes = 0, .late_writes = 0, .journal_losses = 1};
  Checker checker(program_, lost, Without::nothing);
  EXPECT_EQ(checker.run(kLimit), "");
  EXPECT_TRUE(checker.complete());
  Checker forgetful(program_, lost, Without::epoch_record);
  EXPECT_EQ(forgetful.run(kLimit), "a person was asked twice about one lost journal");
}

/// A person who says "go on" while the job stands, and a job that is then taken up again at its line.
TEST_F(HandOverModel, WhatAPersonHasAnsweredStays) {
  Checker checker(program_,
                  {.commands = 2, .pc_crashes = 1, .controller_crashes = 1, .late_writes = 0, .eager_person = true},
                  Without::nothing);
  EXPECT_EQ(checker.run(kLimit), "");
  EXPECT_TRUE(checker.complete());
}

/// Variables are no atomic command: three late writes complete a void one among those of the next.
TEST_F(HandOverModel, WithoutTheEpochInTheNumberItWouldFail) {
  Checker checker(program_, {.commands = 2, .pc_crashes = 1, .controller_crashes = 0, .late_writes = 3},
                  Without::epoch_in_the_number);
  EXPECT_NE(checker.run(kLimit), "");
}

}  // namespace
}  // namespace pickcell::robot
