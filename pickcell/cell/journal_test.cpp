#include "pickcell/cell/journal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <functional>
#include <set>

#include "pickcell/core/file.hpp"

namespace pickcell::cell {
namespace {

using robot::CommandState;
using robot::JournalRow;
using ::testing::HasSubstr;

class JournalTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("pickcell_journal_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    path_ = folder_ / "state" / "journal.db";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::unique_ptr<SqliteJournal> open() {
    auto journal = SqliteJournal::open(path_);
    EXPECT_TRUE(journal) << journal.error().line();
    return journal ? std::move(*journal) : nullptr;
  }

  /// Runs the work in a process of its own that then vanishes without closing anything.
  static int in_a_process_that_is_killed(const std::function<bool()>& work) {
    const pid_t child = fork();
    if (child == 0) _exit(work() ? 0 : 1);
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  static JournalRow row(std::int32_t sequence, std::uint64_t detection, int slot) {
    JournalRow r;
    r.sequence = sequence, r.epoch = 3, r.detection_id = detection, r.place_slot = slot;
    r.model = "bracket", r.payload = "grasp 1,0,300.000", r.t_intent_us = 1000 + sequence;
    return r;
  }

  std::filesystem::path folder_, path_;
};

TEST_F(JournalTest, ANewOneKnowsNothing) {
  auto journal = open();
  EXPECT_EQ(journal->last_epoch().value(), 0);
  EXPECT_EQ(journal->last_sequence().value(), 0);
  EXPECT_TRUE(journal->open_rows()->empty());
}

TEST_F(JournalTest, KeepsARowFromIntentToEnd) {
  auto journal = open();
  ASSERT_TRUE(journal->record_epoch(7, 40));
  EXPECT_EQ(journal->last_epoch().value(), 7);
  EXPECT_EQ(journal->last_sequence().value(), 40);
  ASSERT_TRUE(journal->record_intent(row(41, 1ULL << 63, 2)));
  ASSERT_TRUE(journal->record_sent(41, 2000));
  const auto open_rows = journal->open_rows();
  ASSERT_EQ(open_rows->size(), 1u);
  EXPECT_EQ(open_rows->front().state, CommandState::sent);
  EXPECT_EQ(open_rows->front().detection_id, 1ULL << 63);
  EXPECT_EQ(open_rows->front().payload, "grasp 1,0,300.000");
  ASSERT_TRUE(journal->record_end(41, CommandState::refused, 2, 3000));
  EXPECT_TRUE(journal->open_rows()->empty());
  EXPECT_EQ(journal->last_sequence().value(), 41);
  const auto newest = journal->newest_rows(5);
  ASSERT_EQ(newest->size(), 1u);
  EXPECT_EQ(newest->front().state, CommandState::refused);
  EXPECT_EQ(newest->front().result, 2);
  EXPECT_EQ(newest->front().t_done_us, 3000);
}

TEST_F(JournalTest, ASequencePartOrSlotIsNeverOpenTwice) {
  auto journal = open();
  ASSERT_TRUE(journal->record_intent(row(1, 10, 0)));
  EXPECT_FALSE(journal->record_intent(row(1, 11, 1)));
  EXPECT_FALSE(journal->record_intent(row(2, 10, 1)));
  EXPECT_FALSE(journal->record_intent(row(2, 11, 0)));
  ASSERT_TRUE(journal->record_end(1, CommandState::void_, 0, 5));
  EXPECT_TRUE(journal->record_intent(row(2, 10, 0)));
  EXPECT_FALSE(journal->record_intent(row(1, 12, 3)));
}

TEST_F(JournalTest, KnowsWhichPlacesAreFilledSinceTheTrayWasExchanged) {
  {
    auto journal = open();
    ASSERT_TRUE(journal->record_intent(row(1, 10, 0)));
    ASSERT_TRUE(journal->record_end(1, CommandState::done, 0, 5));
    ASSERT_TRUE(journal->record_intent(row(2, 11, 1)));
    ASSERT_TRUE(journal->record_end(2, CommandState::refused, 2, 6));
    ASSERT_TRUE(journal->record_intent(row(3, 12, 2)));
    ASSERT_TRUE(journal->record_end(3, CommandState::unknown, 0, 7));
    ASSERT_TRUE(journal->record_intent(row(4, 13, 3)));
  }
  auto journal = open();  // of the next process
  std::set<int> slots;
  const auto filled = journal->filled();
  for (const FilledPlace& place : *filled) slots.insert(place.slot);
  EXPECT_EQ(slots, (std::set<int>{0, 2, 3}));
  const std::string model = journal->newest_rows(1)->front().model;
  ASSERT_TRUE(journal->exchanged(model));
  EXPECT_TRUE(journal->filled()->empty());
  ASSERT_TRUE(journal->record_intent(row(5, 14, 1)));
  ASSERT_EQ(journal->filled()->size(), 1u);
  EXPECT_EQ(journal->filled()->front().slot, 1);
}

TEST_F(JournalTest, AFileOfVersion1IsBroughtUpToDate) {
  {
    auto journal = open();
    ASSERT_TRUE(journal->record_intent(row(1, 10, 0)));
    ASSERT_TRUE(journal->record_end(1, CommandState::done, 0, 5));
  }
  ASSERT_TRUE(Database::open(path_)->script("DROP TABLE tray; PRAGMA user_version = 1"));
  auto journal = open();
  EXPECT_EQ(journal->last_sequence().value(), 1);
  EXPECT_EQ(journal->filled()->size(), 1u);
}

TEST_F(JournalTest, AnOutcomeIsWrittenOnce) {
  auto journal = open();
  ASSERT_TRUE(journal->record_intent(row(1, 10, 0)));
  ASSERT_TRUE(journal->record_end(1, CommandState::unknown, 0, 5));
  EXPECT_FALSE(journal->record_end(1, CommandState::done, 0, 6));
  EXPECT_FALSE(journal->record_sent(1, 6));
  EXPECT_FALSE(journal->record_end(99, CommandState::done, 0, 6));
}

TEST_F(JournalTest, WhatWasRecordedSurvivesAKill) {
  ASSERT_EQ(in_a_process_that_is_killed([&] {
              auto journal = SqliteJournal::open(path_);
              return journal && (*journal)->record_epoch(4, 0) && (*journal)->record_intent(row(1, 10, 0)) &&
                     (*journal)->record_end(1, CommandState::done, 0, 9) && (*journal)->record_intent(row(2, 11, 1)) &&
                     (*journal)->record_sent(2, 10);
            }),
            0);
  auto journal = open();
  EXPECT_EQ(journal->last_epoch().value(), 4);
  EXPECT_EQ(journal->last_sequence().value(), 2);
  ASSERT_EQ(journal->open_rows()->size(), 1u);
  EXPECT_EQ(journal->open_rows()->front().state, CommandState::sent);
}

TEST_F(JournalTest, TwoProcessesNeverShareIt) {
  auto journal = open();
  EXPECT_EQ(in_a_process_that_is_killed([&] {
              const auto second = SqliteJournal::open(path_);
              return !second && second.error().line().find("in use by another process") != std::string::npos;
            }),
            0);
  EXPECT_TRUE(journal->record_epoch(1, 0));
}

TEST_F(JournalTest, AFullDiskIsSaidAndLeavesTheJournalSound) {
  {
    auto journal = open();
    ASSERT_TRUE(journal->record_intent(row(1, 10, 0)));
  }
  EXPECT_EQ(in_a_process_that_is_killed([&] {
              auto journal = SqliteJournal::open(path_);
              std::signal(SIGXFSZ, SIG_IGN);
              const rlimit no_room{16384, 16384};
              setrlimit(RLIMIT_FSIZE, &no_room);
              for (int i = 2; i < 500; ++i) {
                auto big = row(i, static_cast<std::uint64_t>(i) + 10, i);
                big.payload.assign(4000, 'x');
                const auto written = (*journal)->record_intent(big);
                if (!written) return written.error().line().find("make room on the disk") != std::string::npos;
              }
              return false;
            }),
            0);
  auto journal = open();
  EXPECT_EQ(journal->newest_rows(1000)->back().sequence, 1);
  EXPECT_TRUE(journal->record_end(1, CommandState::done, 0, 1));
}

TEST_F(JournalTest, OtherFilesAreRefusedInWords) {
  std::filesystem::create_directories(path_.parent_path());
  ASSERT_TRUE(
      core::write_file_atomically(path_, std::string_view("no database at all, only text that is long enough")));
  EXPECT_THAT(SqliteJournal::open(path_).error().line(), HasSubstr("keep the file"));
  std::filesystem::remove(path_);
  {
    auto other = Database::open(path_);
    ASSERT_TRUE(other && other->script("CREATE TABLE t (i INTEGER); "));
  }
  EXPECT_THAT(SqliteJournal::open(path_).error().line(), HasSubstr("no journal"));
  std::filesystem::remove(path_);
  {
    auto later = open();
  }
  {
    ASSERT_TRUE(Database::open(path_)->script("PRAGMA user_version = 9"));
  }
  EXPECT_THAT(SqliteJournal::open(path_).error().line(), HasSubstr("version 9"));
}

TEST_F(JournalTest, DamageIsFound) {
  {
    auto journal = open();
    for (int i = 1; i < 50; ++i) {
      ASSERT_TRUE(journal->record_intent(row(i, static_cast<std::uint64_t>(i), i)));
      ASSERT_TRUE(journal->record_end(i, CommandState::done, 0, 1));
    }
  }
  auto bytes = core::read_file(path_);
  ASSERT_TRUE(bytes);
  for (std::size_t i = 5000; i < bytes->size(); i += 7) (*bytes)[i] ^= std::byte{0x5a};
  ASSERT_TRUE(core::write_file_atomically(path_, std::span<const std::byte>(*bytes)));
  const auto damaged = SqliteJournal::open(path_);
  ASSERT_FALSE(damaged);
  EXPECT_EQ(damaged.error().code, core::ErrorCode::unreadable);
}

}  // namespace
}  // namespace pickcell::cell
