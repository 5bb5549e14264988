// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/plot/chart.h>

namespace headway::plot {
namespace {

TEST(AxisTicksTest, StepsAreOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_DOUBLE_EQ(1.0, tickStep(10.0, 10.0));
  EXPECT_DOUBLE_EQ(2.0, tickStep(10.0, 9.0));
  EXPECT_DOUBLE_EQ(5.0, tickStep(10.0, 4.0));
  EXPECT_DOUBLE_EQ(10.0, tickStep(10.0, 1.9));
  EXPECT_DOUBLE_EQ(0.02, tickStep(0.1, 6.0));
  EXPECT_DOUBLE_EQ(500.0, tickStep(4000.0, 9.0));
}

TEST(AxisTicksTest, AtMostTheGivenNumberOfParts) {
  for (const double range : {0.003, 0.7, 1.0, 42.0, 999.0, 1e6}) {
    EXPECT_LE(range / tickStep(range, 7.0), 7.0 + 1e-9) << range;
    EXPECT_GT(range / tickStep(range, 7.0), 7.0 / 2.5 - 1e-9) << range;
  }
}

TEST(AxisTicksTest, TextHasTheDigitsOfTheStep) {
  EXPECT_EQ("20", tickText(20.0, 10.0));
  EXPECT_EQ("3", tickText(3.0, 1.0));
  EXPECT_EQ("0.5", tickText(0.5, 0.5));
  EXPECT_EQ("0.30", tickText(0.1 + 0.2, 0.02));
  EXPECT_EQ("-0.002", tickText(-0.002, 0.001));
}

TEST(AxisTicksTest, RoundsResiduesOfSumsToZero) { EXPECT_EQ("0.0", tickText(-2.8e-17, 0.1)); }

TEST(ScaleBarLengthTest, IsTheLargestRoundLengthWithinTheLimit) {
  EXPECT_DOUBLE_EQ(10.0, scaleBarLength(19.9));
  EXPECT_DOUBLE_EQ(20.0, scaleBarLength(20.0));
  EXPECT_DOUBLE_EQ(50.0, scaleBarLength(99.0));
  EXPECT_DOUBLE_EQ(0.5, scaleBarLength(0.7));
}

}  // namespace
}  // namespace headway::plot
