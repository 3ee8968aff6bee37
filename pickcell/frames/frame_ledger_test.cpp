#include "pickcell/frames/frame_ledger.hpp"

#include <gtest/gtest.h>

#include <random>

namespace pickcell::frames {
namespace {

constexpr auto kWhole = Wholeness::whole;

TEST(FrameLedger, CountsOnAcrossTheEndOfSixteenBits) {
  FrameLedger ledger;
  std::uint64_t expected = 0;
  for (const std::uint64_t id : {65533U, 65534U, 65535U, 1U, 2U}) {
    EXPECT_EQ(ledger.enter(id, 0, kWhole), Verdict::good);
    EXPECT_EQ(ledger.sequence(), ++expected) << "0 is no number of a frame";
  }
  EXPECT_EQ(ledger.counters().missing, 0u);
}

TEST(FrameLedger, ExtendedNumbersPassSixteenBits) {
  FrameLedger ledger;
  for (std::uint64_t id = 65530; id < 65550; ++id) EXPECT_EQ(ledger.enter(id, 0, kWhole), Verdict::good);
  EXPECT_EQ(ledger.enter(65552, 0, kWhole), Verdict::good);
  EXPECT_EQ(ledger.counters().missing, 2u);
  EXPECT_EQ(ledger.counters().frames, 21u);
}

TEST(FrameLedger, NamesEveryCause) {
  FrameLedger ledger;
  EXPECT_EQ(ledger.enter(10, 100, kWhole), Verdict::good);
  EXPECT_EQ(ledger.enter(10, 100, kWhole), Verdict::repeated);
  EXPECT_EQ(ledger.enter(11, 100, kWhole), Verdict::repeated) << "the same stamp: the same exposure sent twice";
  EXPECT_EQ(ledger.enter(14, 200, kWhole), Verdict::good);
  EXPECT_EQ(ledger.counters().missing, 2u);
  EXPECT_EQ(ledger.enter(13, 150, kWhole), Verdict::late);
  EXPECT_EQ(ledger.counters().missing, 1u) << "it did arrive after all";
  EXPECT_EQ(ledger.enter(15, 0, Wholeness::incomplete), Verdict::incomplete);
  EXPECT_EQ(ledger.enter(16, 300, Wholeness::torn), Verdict::torn);
  const FrameCounters& c = ledger.counters();
  EXPECT_EQ(c.frames, 2u);
  EXPECT_EQ(c.repeated, 2u);
  EXPECT_EQ(c.late, 1u);
  EXPECT_EQ(c.incomplete, 1u);
  EXPECT_EQ(c.torn, 1u);
}

TEST(FrameLedger, AnIncompleteFrameWithoutItsNumberIsNotMissingToo) {
  FrameLedger ledger;
  (void)ledger.enter(10, 0, kWhole);
  EXPECT_EQ(ledger.enter_unnumbered(), Verdict::incomplete);
  EXPECT_EQ(ledger.enter(13, 0, kWhole), Verdict::good);
  EXPECT_EQ(ledger.counters().incomplete, 1u);
  EXPECT_EQ(ledger.counters().missing, 1u);
  EXPECT_EQ(ledger.enter(15, 0, kWhole), Verdict::good);
  EXPECT_EQ(ledger.counters().missing, 2u) << "it stands for one gap only";
}

TEST(FrameLedger, ANewStartBeginsWithoutLosses) {
  FrameLedger ledger;
  (void)ledger.enter(500, 0, kWhole);
  ledger.restart();
  EXPECT_EQ(ledger.enter(1, 0, kWhole), Verdict::good);
  EXPECT_EQ(ledger.sequence(), 2u);
  EXPECT_EQ(ledger.enter(40'000, 0, kWhole), Verdict::good) << "a jump back by half a turn is no late frame";
}

/// A link that loses, cuts, doubles and swaps frames at random: what was sent is what is counted.
TEST(FrameLedger, EverythingSentIsCountedOnce) {
  std::mt19937 random(7);
  for (int round = 0; round < 50; ++round) {
    FrameLedger ledger;
    std::uint64_t id = random() % 65535 + 1, sent = 0, doubled = 0;
    const std::uint64_t start = id;
    std::int64_t stamp = 0;
    bool held_back = false;
    std::uint64_t held_id = 0;
    const auto next = [&] { id = id % 65535 + 1; };
    (void)ledger.enter(id, ++stamp, kWhole);
    ++sent;
    for (int i = 0; i < 3000; ++i) {
      next();
      ++sent;
      const unsigned fate = random() % 100;
      if (fate < 5 && i < 2990) continue;  // lost
      if (fate < 10)
        (void)ledger.enter(id, ++stamp, Wholeness::incomplete);
      else if (fate < 12 && !held_back && i < 2990)
        held_back = true, held_id = id;
      else
        (void)ledger.enter(id, ++stamp, kWhole);
      if (fate >= 90 && ledger.counters().frames > 0 && !(held_back && held_id == id))
        (void)ledger.enter(id, stamp, kWhole), ++doubled;
      if (held_back && held_id != id) (void)ledger.enter(held_id, ++stamp, kWhole), held_back = false;
    }
    const FrameCounters& c = ledger.counters();
    EXPECT_EQ(c.frames + c.incomplete + c.missing + c.late, sent) << "from " << start;
    EXPECT_EQ(c.repeated, doubled);
  }
}

}  // namespace
}  // namespace pickcell::frames
