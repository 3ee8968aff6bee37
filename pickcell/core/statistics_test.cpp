#include "pickcell/core/statistics.hpp"

#include <gtest/gtest.h>

namespace pickcell::core {
namespace {

TEST(Statistics, QuantilesAreThoseOfNumpy) {
  EXPECT_FALSE(quantile({}, 0.5));
  EXPECT_EQ(quantile({3}, 0.95), 3);
  EXPECT_DOUBLE_EQ(*quantile({4, 1, 3, 2}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(*quantile({1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, 0.95), 9.55);  // numpy.quantile(range(1, 11), 0.95)
  EXPECT_EQ(quantile({5, 1, 9}, 0), 1);
  EXPECT_EQ(quantile({5, 1, 9}, 1), 9);
}

TEST(Statistics, MedianAndMean) {
  EXPECT_EQ(median({7, 1, 5}), 5);
  EXPECT_FALSE(mean({}));
  EXPECT_DOUBLE_EQ(*mean({1, 2, 6}), 3);
}

}  // namespace
}  // namespace pickcell::core
