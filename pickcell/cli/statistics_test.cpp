#include "pickcell/cli/statistics.hpp"

#include <gtest/gtest.h>

namespace pickcell::cli {
namespace {

TEST(Statistics, QuantilesAreThoseOfNumpy) {
  // numpy.quantile([3, 1, 4, 1, 5, 9, 2, 6], [0, .5, .95, 1])
  const std::vector<double> values{3, 1, 4, 1, 5, 9, 2, 6};
  EXPECT_DOUBLE_EQ(*quantile(values, 0), 1);
  EXPECT_DOUBLE_EQ(*quantile(values, 0.5), 3.5);
  EXPECT_NEAR(*quantile(values, 0.95), 7.95, 1e-12);
  EXPECT_DOUBLE_EQ(*quantile(values, 1), 9);
  EXPECT_DOUBLE_EQ(*median({7, 1, 5}), 5);
  EXPECT_DOUBLE_EQ(*mean({1, 2, 6}), 3);
}

TEST(Statistics, OneValueIsEveryQuantileAndNoneIsNothing) {
  EXPECT_DOUBLE_EQ(*quantile({4}, 0.95), 4);
  EXPECT_FALSE(median({}));
  EXPECT_FALSE(mean({}));
}

}  // namespace
}  // namespace pickcell::cli
