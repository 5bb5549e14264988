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

TEST(FrameRateTest, IsTheMedianOfTheIntervals) {
  FrameRate rate;
  EXPECT_EQ(rate.hz(), 10.0) << "assumed";
  EXPECT_EQ(rate.lastInterval(), 0.1);
  double time = 1.7e9;
  rate.add(time);
  rate.add(time += 20.0);
  EXPECT_EQ(rate.hz(), 10.0) << "one interval confirms nothing";
  EXPECT_EQ(rate.lastInterval(), 20.0);
  for (int i = 0; i < 50; ++i) rate.add(time += i % 2 == 0 ? 0.032 : 0.034);
  EXPECT_NEAR(rate.hz(), 30.0, 1.5);
  rate.add(time);
  EXPECT_EQ(rate.lastInterval(), 0.0) << "a time that is repeated";
  rate.add(time - 1.0);
  EXPECT_EQ(rate.lastInterval(), 0.0) << "a clock that is set back";
}

TEST(FrameRateTest, PeriodsEndWithTheNearestFrame) {
  for (const auto& [hz, frames] : {std::pair(5.0, 1), {10.0, 3}, {15.0, 4}, {30.0, 9}}) {
    FrameRate rate;
    for (int i = 0; i < 10; ++i) rate.add(1.7e9 + i / hz);
    int passed = 0;
    while (!rate.isOver(passed / hz, 0.3)) ++passed;
    EXPECT_EQ(passed, frames) << hz;
  }
}

}  // namespace
}  // namespace headway
