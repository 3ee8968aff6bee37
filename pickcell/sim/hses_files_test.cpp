// Jobs as files (docs/yaskawa-protocols 2.6), block by block.

#include "pickcell/sim/hses_files.hpp"

#include <gtest/gtest.h>

#include "pickcell/robot/hses_codec.hpp"
#include "pickcell/sim/shipped_jobs.hpp"

namespace pickcell::sim {
namespace {

using namespace robot;

class HsesFileService : public testing::Test {
 protected:
  static ControllerSettings settings() {
    ControllerSettings s;
    s.jobs = shipped_jobs();
    return s;
  }
  static HsesBytes bytes(std::string_view text) { return {text.begin(), text.end()}; }
  static std::string text(const HsesBytes& b) { return {b.begin(), b.end()}; }
  HsesAnswer ask(const HsesRequest& r) {
    const auto answer = files.handle(state, r);
    EXPECT_TRUE(answer.has_value());
    return answer.value_or(HsesAnswer{});
  }
  int refused(const HsesRequest& r) { return ask(r).added_status; }
  /// Sends a job in blocks of n bytes; the added status of the last answer.
  int load(const std::string& name, const std::string& content, std::size_t n) {
    HsesAnswer a = ask(hses_file(HsesService::file_load, name));
    if (a.status != 0) return a.added_status;
    EXPECT_EQ(a.block, 0u);
    for (std::size_t from = 0, block = 1; from < content.size() || from == 0; from += n, ++block) {
      const bool last = from + n >= content.size();
      const auto number = static_cast<std::uint32_t>(block) | (last ? kHsesLastBlock : 0);
      a = ask(hses_file_block(HsesService::file_load, number, bytes(content.substr(from, n))));
      EXPECT_EQ(a.block, number) << "every block is confirmed by its number";
      if (last) break;
    }
    return a.added_status;
  }
  inline static const std::string kJob =
      "/JOB\r\n//NAME MINE\r\n//POS\r\n///NPOS 0,0,0,0,0,0\r\n//INST\r\n///DATE 2026/11/22 08:00\r\n///ATTR SC,RW\r\n"
      "///GROUP1 RB1\r\nNOP\r\nSET B030 9\r\nEND\r\n";
  ControllerState state{settings()};
  HsesFiles files;
};

TEST_F(HsesFileService, ListsInOneBlock) {
  const HsesAnswer a = ask(hses_file(HsesService::file_list, "*.JBI"));
  EXPECT_EQ(a.block, 1 | kHsesLastBlock);
  EXPECT_EQ(text(a.payload), "TEST1.JBI\r\nTEST2.JBI\r\nVISPICK.JBI\r\n");
  EXPECT_FALSE(files.handle(state, hses_file_block(HsesService::file_list, a.block))) << "the last ack gets no answer";
  EXPECT_EQ(text(ask(hses_file(HsesService::file_list, "*.DAT")).payload), "");
  EXPECT_EQ(text(ask(hses_file(HsesService::file_list, "?EST*.J*")).payload), "TEST1.JBI\r\nTEST2.JBI\r\n");
}

TEST_F(HsesFileService, SavesBlockByBlockAndRepeatsWhatWasLost) {
  const std::string job = state.jobs.at("VISPICK")->text;
  HsesAnswer a = ask(hses_file(HsesService::file_save, "VISPICK.JBI"));
  std::string got;
  for (std::uint32_t block = 1;; ++block) {
    EXPECT_EQ(a.block & ~kHsesLastBlock, block);
    got += text(a.payload);
    if ((a.block & kHsesLastBlock) != 0) break;
    const HsesAnswer next = ask(hses_file_block(HsesService::file_save, block));
    EXPECT_EQ(ask(hses_file_block(HsesService::file_save, block)), next) << "the same acknowledgement again";
    a = next;
  }
  EXPECT_EQ(got, job);
  EXPECT_FALSE(files.handle(state, hses_file_block(HsesService::file_save, a.block & ~kHsesLastBlock)))
      << "one client leaves the mark out";
  EXPECT_EQ(refused(hses_file(HsesService::file_save, "NONE.JBI")), 0xE2B3);
}

TEST_F(HsesFileService, LoadsInAnyBlockSize) {
  for (const std::size_t n : {7u, 100u, 400u, 479u}) {
    state.jobs.erase("MINE");
    EXPECT_EQ(load("MINE.JBI", kJob, n), 0) << n;
    ASSERT_TRUE(state.jobs.contains("MINE"));
    EXPECT_EQ(state.jobs.at("MINE")->text, kJob);
  }
}

TEST_F(HsesFileService, ARepeatedBlockCountsOnce) {
  const std::string content = kJob;
  (void)ask(hses_file(HsesService::file_load, "MINE.JBI"));
  const auto first = hses_file_block(HsesService::file_load, 1, bytes(content.substr(0, 50)));
  const auto last = hses_file_block(HsesService::file_load, 2 | kHsesLastBlock, bytes(content.substr(50)));
  EXPECT_EQ(ask(first), ask(first));
  EXPECT_EQ(refused(hses_file_block(HsesService::file_load, 3, {})), 0xE4A1) << "one was skipped";
  EXPECT_EQ(ask(last), ask(last));
  EXPECT_EQ(state.jobs.at("MINE")->text, kJob);
}

TEST_F(HsesFileService, AFileBehindItsNameIsNotTakenForAName) {
  HsesRequest r = hses_file(HsesService::file_load, "MINE.JBI");
  r.payload.resize(r.payload.size() + 4, 0);
  EXPECT_EQ(refused(r), 0) << "filled up with NULs";
  const HsesBytes file = bytes(kJob);
  r.payload.insert(r.payload.end(), file.begin(), file.end());
  EXPECT_EQ(refused(r), 0xE2B4);
  EXPECT_EQ(state.jobs.count("MINE"), 0u);
}

TEST_F(HsesFileService, WhatIsNoJobIsNotTaken) {
  std::string lf = kJob;
  std::erase(lf, '\r');
  EXPECT_EQ(load("MINE.JBI", lf, 400), 0x5130) << "NOP and END are not found";
  EXPECT_EQ(load("MINE.JBI", kJob + "X\r\n", 400), 0x4230);
  EXPECT_EQ(load("OTHER.JBI", kJob, 400), 0x5390) << "the job is called MINE";
  EXPECT_EQ(load("MINE.JBI", "", 400), 0xE29C);
  EXPECT_EQ(load("mine.jbi", kJob, 400), 0x4190);
  EXPECT_EQ(load("AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA.JBI", kJob, 400), 0xE2B4);
  EXPECT_FALSE(state.jobs.contains("MINE"));
  state.remote = false;
  EXPECT_EQ(load("MINE.JBI", kJob, 400), 0xE2B2);
  EXPECT_EQ(refused(hses_file(HsesService::file_delete, "TEST1.JBI")), 0xE2B2);
}

TEST_F(HsesFileService, DeletesWhatIsNotRunning) {
  state.task.at = {state.jobs.at("TEST2"), 0};
  state.task.running = true;
  const HsesAnswer a = ask(hses_file(HsesService::file_delete, "TEST2.JBI"));
  EXPECT_EQ(a.added_status, 0xE2AF);
  EXPECT_TRUE(HsesFiles::in_use(a));
  state.task.running = false;
  EXPECT_EQ(refused(hses_file(HsesService::file_delete, "TEST2.JBI")), 0);
  EXPECT_FALSE(state.jobs.contains("TEST2"));
  EXPECT_EQ(refused(hses_file(HsesService::file_delete, "TEST2.JBI")), 0xE2B3);
}

TEST_F(HsesFileService, AJobLoadedAgainIsTheOneThatRuns) {
  state.task.at = {state.jobs.at("TEST1"), 1};
  std::string content = kJob;
  content.replace(content.find("MINE"), 4, "TEST1");
  EXPECT_EQ(load("TEST1.JBI", content, 400), 0);
  EXPECT_EQ(state.task.at.job->text, content);
  EXPECT_EQ(state.task.at.line, 0u);
}

}  // namespace
}  // namespace pickcell::sim
