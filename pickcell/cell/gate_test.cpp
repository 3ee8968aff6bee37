#include "pickcell/cell/gate.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace pickcell::cell {
namespace {

matches::Model model_with(double threshold, int symmetry_order) {
  matches::Model model;
  model.learnt.suggested_min_score = threshold;
  model.learnt.symmetry_order = symmetry_order;
  return model;
}

matches::Match match_with(double score, std::vector<double> ambiguous_deg = {}) {
  matches::Match match;
  match.score = score;
  match.ambiguous_deg = std::move(ambiguous_deg);
  match.covariance.diagonal() << 0.01, 0.01, 0.01, 1e-6;
  return match;
}

TEST(Gate, HoldsTheScoreAgainstTheModelsThreshold) {
  const auto model = model_with(0.7, 1);
  EXPECT_FALSE(judge(match_with(0.7), model));
  ASSERT_TRUE(judge(match_with(0.699), model));
  EXPECT_EQ(judge(match_with(0.699), model)->code, "score");
  EXPECT_TRUE(judge(match_with(std::numeric_limits<double>::quiet_NaN()), model)) << "no score is no good score";
}

TEST(Gate, AMatchWithoutACovarianceIsNotPicked) {
  matches::Match match = match_with(0.9);
  match.covariance.setZero();
  ASSERT_TRUE(judge(match, model_with(0.7, 1)));
  EXPECT_EQ(judge(match, model_with(0.7, 1))->code, "uncertain");
  match.covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(judge(match, model_with(0.7, 1)));
}

TEST(Gate, ThePartsOwnSymmetryIsNoAmbiguity) {
  EXPECT_EQ(open_ambiguities_deg(match_with(0.9, {120, -120}), model_with(0.7, 3)), std::vector<double>{});
  EXPECT_EQ(open_ambiguities_deg(match_with(0.9, {120, 180}), model_with(0.7, 3)), std::vector<double>{180});
  EXPECT_EQ(open_ambiguities_deg(match_with(0.9, {180}), model_with(0.7, 1)), std::vector<double>{180});
  EXPECT_EQ(open_ambiguities_deg(match_with(0.9, {180}), model_with(0.7, 2)), std::vector<double>{});
}

}  // namespace
}  // namespace pickcell::cell
