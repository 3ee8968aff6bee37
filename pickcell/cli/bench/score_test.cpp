#include "pickcell/cli/bench/score.hpp"

#include <gtest/gtest.h>

namespace pickcell::cli {
namespace {

using matches::Match;
using matches::Pose2d;

Match match_at(double x, double y, double angle_deg, double scale, double score) {
  Match m;
  m.pose = {x, y, angle_deg, scale};
  m.score = score;
  return m;
}

constexpr double kSmall = 50;  // diagonal below 100 px: the 3 px rule

TEST(PoseErrors, AnglesWrapAtAFullTurn) {
  EXPECT_NEAR(pose_error({0, 0, -179, 1}, {0, 0, 182, 1}).angle_deg, 1, 1e-9);
  EXPECT_NEAR(pose_error({0, 0, 0.5, 1}, {0, 0, 359.8, 1}).angle_deg, 0.7, 1e-9);
  EXPECT_NEAR(pose_error({0, 0, 90, 1}, {0, 0, 270, 1}).angle_deg, 180, 1e-9);
}

TEST(PoseErrors, AnglesOfSymmetricPartsWrapAtTheirSymmetry) {
  EXPECT_NEAR(pose_error({0, 0, 90, 1}, {0, 0, 271, 1}, 180).angle_deg, 1, 1e-9);
  EXPECT_NEAR(pose_error({0, 0, 47, 1}, {0, 0, 0, 1}, 90).angle_deg, 43, 1e-9);
  EXPECT_NEAR(pose_error({0, 0, 361.0 / 7, 1}, {0, 0, 0, 1}, 360.0 / 7).angle_deg, 1.0 / 7, 1e-9);
}

TEST(PoseErrors, ScaleIsRelativeToTheTruth) {
  EXPECT_NEAR(pose_error({3, 4, 0, 1.05}, {0, 0, 0, 1.0}).scale_pct, 5, 1e-9);
  EXPECT_NEAR(pose_error({3, 4, 0, 0.9}, {0, 0, 0, 1.0}).scale_pct, 10, 1e-9);
  EXPECT_NEAR(pose_error({3, 4, 0, 1}, {0, 0, 0, 1.0}).position_px, 5, 1e-12);
}

TEST(Correct, LimitsAreThreePixelsOrThreePercentOfTheDiagonal) {
  EXPECT_TRUE(is_correct({3, 0, 0}, kSmall));
  EXPECT_FALSE(is_correct({3.01, 0, 0}, kSmall));
  EXPECT_TRUE(is_correct({6, 0, 0}, 200));
  EXPECT_FALSE(is_correct({6.01, 0, 0}, 200));
  EXPECT_TRUE(is_correct({0, 3, 5}, kSmall));
  EXPECT_FALSE(is_correct({0, 3.01, 0}, kSmall));
  EXPECT_FALSE(is_correct({0, 0, 5.01}, kSmall));
}

TEST(Correct, StrictIsOnePixelAndOneDegreeWhateverTheSize) {
  EXPECT_TRUE(is_strict({1, 1, 4.9}, 1000));
  EXPECT_FALSE(is_strict({1.01, 0, 0}, 1000));
  EXPECT_FALSE(is_strict({0, 1.01, 0}, 1000));
  EXPECT_FALSE(is_strict({0, 0, 6}, 1000));
}

TEST(ScoreOne, TheBestMatchDecides) {
  const TruthPose truth{100, 100, 10, 1};
  const std::vector<Match> found{match_at(300, 300, 0, 1, 0.7), match_at(100.5, 100, 10, 1, 0.9)};
  const ImageScore score = score_one(found, truth, kSmall, 360);
  EXPECT_TRUE(score.correct);
  EXPECT_TRUE(score.strict);
  ASSERT_EQ(score.hits.size(), 1u);
  EXPECT_EQ(score.hits[0].match, 1u);
  EXPECT_TRUE(score.why.empty());
}

TEST(ScoreOne, SaysWhyItIsNotCorrect) {
  const TruthPose truth{100, 100, 10, 1};
  EXPECT_EQ(score_one({}, truth, kSmall, 360).why, "no match");
  const std::vector<Match> wrong{match_at(103, 104, 190, 1.1, 0.9)};
  const ImageScore score = score_one(wrong, truth, kSmall, 360);
  EXPECT_FALSE(score.correct);
  EXPECT_TRUE(score.hits.empty());
  EXPECT_EQ(score.why, "off by 5.0 px, 180.0 deg, 10.0 % scale");
}

TEST(ScoreInstances, EachTruthIsTakenOnceByTheBetterMatch) {
  const std::vector<TruthPose> truths{{100, 100, 0, 1}, {200, 100, 0, 1}};
  const std::vector<Match> found{match_at(101, 100, 0, 1, 0.6), match_at(100, 102, 0, 1, 0.8),
                                 match_at(200, 100, 0, 1, 0.7)};
  const ImageScore score = score_instances(found, truths, kSmall, 360);
  ASSERT_EQ(score.hits.size(), 2u);
  EXPECT_EQ(score.hits[0].match, 1u);  // the higher score, although farther away
  EXPECT_EQ(score.hits[0].truth, 0u);
  EXPECT_EQ(score.hits[1].match, 2u);
  EXPECT_FALSE(score.correct);  // the third match is a wrong one
  EXPECT_EQ(score.why, "0 of 2 not found, 1 wrong");
}

TEST(ScoreInstances, AMatchTakesTheNearestFreeTruth) {
  const std::vector<TruthPose> truths{{100, 100, 0, 1}, {102, 100, 0, 1}};
  const std::vector<Match> found{match_at(101.8, 100, 0, 1, 0.9), match_at(101.9, 100, 0, 1, 0.8)};
  const ImageScore score = score_instances(found, truths, kSmall, 360);
  ASSERT_EQ(score.hits.size(), 2u);
  EXPECT_EQ(score.hits[0].truth, 1u);
  EXPECT_EQ(score.hits[1].truth, 0u);
  EXPECT_TRUE(score.correct);
  EXPECT_FALSE(score.strict);  // the second is 1.9 px off
}

TEST(ScoreInstances, NothingToFindIsCorrectWhenNothingIsReported) {
  EXPECT_TRUE(score_instances({}, {}, kSmall, 360).correct);
  const std::vector<Match> found{match_at(0, 0, 0, 1, 0.9)};
  const ImageScore score = score_instances(found, {}, kSmall, 360);
  EXPECT_FALSE(score.correct);
  EXPECT_EQ(score.why, "0 of 0 not found, 1 wrong");
}

}  // namespace
}  // namespace pickcell::cli
