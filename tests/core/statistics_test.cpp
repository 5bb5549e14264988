// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/statistics.h>

namespace headway {
namespace {

TEST(MedianTest, IsTheUpperOfTheMiddleTwo) {
  EXPECT_DOUBLE_EQ(median({5.0, 1.0, 3.0}), 3.0);
  EXPECT_DOUBLE_EQ(median({4.0, 1.0, 3.0, 2.0}), 3.0);
  EXPECT_DOUBLE_EQ(median({}), 0.0);
}

TEST(PercentileTest, IsTheNearestRank) {
  const std::vector<double> samples{40.0, 10.0, 30.0, 20.0};
  EXPECT_DOUBLE_EQ(percentile(samples, 0.0), 10.0);
  EXPECT_DOUBLE_EQ(percentile(samples, 0.5), 20.0);
  EXPECT_DOUBLE_EQ(percentile(samples, 0.51), 30.0);
  EXPECT_DOUBLE_EQ(percentile(samples, 1.0), 40.0);
  EXPECT_DOUBLE_EQ(percentile({}, 0.5), 0.0);
}

}  // namespace
}  // namespace headway
