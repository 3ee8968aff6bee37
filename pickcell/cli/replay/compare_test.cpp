#include "pickcell/cli/replay/compare.hpp"

#include <gtest/gtest.h>

#include "pickcell/cli/replay/shard.hpp"

namespace pickcell::cli {
namespace {

using cell::RecordedFind;

RecordedFind find(const std::string& part, double x_px, double y_px, double angle_deg = 0, double score = 0.9) {
  RecordedFind out;
  out.part = part;
  out.pose = {x_px, y_px, angle_deg, 1};
  out.score = score;
  out.place = cell::RecordedPlace{x_px / 2, y_px / 2, 6, -angle_deg};
  out.code = "";
  return out;
}

RecordedFind rejected(RecordedFind of, const std::string& code, const std::string& why) {
  of.rejected = true;
  of.code = code;
  of.why = why;
  return of;
}

const std::map<std::string, PartTraits> kParts{{"gear", {8, 18}}, {"bracket", {5, 1}}};

std::vector<FindChange> changes(const std::vector<RecordedFind>& recorded, const std::vector<RecordedFind>& now) {
  return compare(recorded, now, kParts, {});
}

TEST(Compare, TheSameFindsInAnotherOrderAreTheSame) {
  const auto a = find("gear", 100, 100), b = find("gear", 104, 100), c = find("bracket", 100, 100, 30);
  for (const FindChange& change : changes({a, b, c}, {c, b, a})) {
    EXPECT_EQ(change.change, Change::same);
    EXPECT_EQ(change.off_px, 0);
    EXPECT_EQ(change.off_mm, 0);
  }
}

TEST(Compare, TellsHowFarAPartMoved) {
  const auto moved = changes({find("bracket", 100, 100, 179, 0.9)}, {find("bracket", 103, 96, -179, 0.8)});
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_EQ(moved[0].change, Change::changed);
  EXPECT_TRUE(moved[0].moved && moved[0].scored && !moved[0].judged);
  EXPECT_NEAR(moved[0].off_px, 5, 1e-12);  // 3-4-5
  EXPECT_NEAR(moved[0].off_deg, 2, 1e-12) << "across 180";
  EXPECT_NEAR(moved[0].off_mm.value_or(0), 2.5, 1e-12);
  EXPECT_NEAR(moved[0].off_base_deg.value_or(0), -2, 1e-12);
  EXPECT_NEAR(moved[0].off_score, -0.1, 1e-12);
}

TEST(Compare, WithinTheToleranceIsTheSame) {
  const auto one = [](double off) {
    return changes({find("bracket", 100, 100)}, {find("bracket", 100 + off, 100)}).front().change;
  };
  EXPECT_EQ(one(0.049), Change::same);
  EXPECT_EQ(one(0.051), Change::changed);
}

TEST(Compare, TurnedByItsSymmetryAPartIsTheSame) {
  EXPECT_EQ(changes({find("gear", 9, 9, 10)}, {find("gear", 9, 9, 50)}).front().change, Change::same);
  const auto half = changes({find("bracket", 9, 9, 10)}, {find("bracket", 9, 9, -170)}).front();
  EXPECT_EQ(half.change, Change::changed) << "and no other part";
  EXPECT_NEAR(std::abs(half.off_deg), 180, 1e-9);
}

TEST(Compare, BeyondItsReachOrOfAnotherKindAPartIsLostAndNew) {
  for (const auto& other : {find("bracket", 105.1, 100), find("gear", 100, 100)}) {
    const auto both = changes({find("bracket", 100, 100)}, {other});
    ASSERT_EQ(both.size(), 2u);
    EXPECT_EQ(both[0].change, Change::lost);
    EXPECT_FALSE(both[0].now);
    EXPECT_EQ(both[1].change, Change::added);
    EXPECT_STREQ(name(both[1].change), "new");
  }
}

TEST(Compare, EachFindHasOnePartnerTheNearest) {
  const auto pairs = changes({find("gear", 100, 100), find("gear", 106, 100)}, {find("gear", 105, 100)});
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].change, Change::lost);
  EXPECT_NEAR(pairs[1].off_px, 1, 1e-12);
}

TEST(Compare, AnotherJudgementIsAChange) {
  const auto good = find("gear", 9, 9);
  const auto low = rejected(good, "score", "score 0.60 is below the threshold 0.70");
  const auto tight = rejected(good, "clearance", "the gripper would touch a neighbour");
  EXPECT_TRUE(changes({good}, {low}).front().judged);
  EXPECT_TRUE(changes({low}, {tight}).front().judged);
  EXPECT_FALSE(changes({low}, {low}).front().judged);
  auto old = low;  // of format 1: only that it was turned down
  old.code.reset();
  EXPECT_FALSE(changes({old}, {tight}).front().judged);
  EXPECT_TRUE(changes({old}, {good}).front().judged);
}

TEST(Compare, WhatHangsOnTheCellsPastIsNotHeldAgainstThePicture) {
  const auto good = find("gear", 9, 9);
  for (const auto& past : {rejected(good, "pattern_full", "all places of the pattern are taken"),
                           rejected(good, "gave_up", "picking it failed 2 times"),
                           rejected(good, "box", "place at 1.0, 2.0, 3.0 mm lies outside the workspace box")})
    EXPECT_EQ(changes({past}, {good}).front().change, Change::same) << past.why;
  const auto grasp = rejected(good, "box", "grasp at 1.0, 2.0, 3.0 mm lies outside the workspace box");
  EXPECT_EQ(changes({grasp}, {good}).front().change, Change::changed);
}

TEST(Compare, TheWorstComesFirst) {
  const Tolerance t;
  const auto good = find("bracket", 9, 9);
  const auto weight = [&](const RecordedFind& now) { return changes({good}, {now}).front().weight(t); };
  const double lost = changes({good}, {}).front().weight(t), added = changes({}, {good}).front().weight(t);
  EXPECT_GT(lost, added);
  EXPECT_GT(added, weight(rejected(good, "score", "low")));
  EXPECT_GT(weight(rejected(good, "score", "low")), weight(find("bracket", 13, 9)));
  EXPECT_GT(weight(find("bracket", 13, 9)), weight(find("bracket", 10, 9)));
}

TEST(Shard, IsTheIthOfN) {
  const auto shard = parse_shard("3/8");
  ASSERT_TRUE(shard);
  EXPECT_EQ(shard->index, 3u);
  EXPECT_EQ(shard->count, 8u);
  EXPECT_TRUE(parse_shard("1/1"));
  for (const char* wrong : {"", "/", "1", "1/", "/1", "0/3", "4/3", "-1/3", "1/-3", "+1/3", "1/3/5", "1.5/3", " 1/3",
                            "1/3 ", "a/b", "1/0", "99999999999999999999/99999999999999999999", "1/1000001"}) {
    const auto refused = parse_shard(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().code, core::ErrorCode::usage);
    EXPECT_EQ(refused.error().what, "--shard");
  }
}

}  // namespace
}  // namespace pickcell::cli
