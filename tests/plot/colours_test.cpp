// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/plot/colours.h>

#include <cstdlib>

namespace headway::plot {
namespace {

int distance(Colour a, Colour b) {
  return std::abs(a.red - b.red) + std::abs(a.green - b.green) + std::abs(a.blue - b.blue);
}

TEST(BgrTest, ReversesTheChannels) { EXPECT_EQ(bgr({1, 2, 3}), cv::Scalar(3, 2, 1)); }

TEST(LightenedTest, IsHalfwayToWhite) {
  const Colour colour = lightened({0, 101, 255});
  EXPECT_EQ(colour.red, 127);
  EXPECT_EQ(colour.green, 178);
  EXPECT_EQ(colour.blue, 255);
}

TEST(CategoryColourTest, EightColoursAreDistinctAndRepeat) {
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(distance(categoryColour(i), categoryColour(i + 8)), 0);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GT(distance(categoryColour(i), categoryColour(j)), 60) << i << " " << j;
    }
  }
}

TEST(RampColourTest, IsContinuous) {
  for (int i = 0; i < 1000; ++i) {
    EXPECT_LE(distance(rampColour(0.001 * i), rampColour(0.001 * (i + 1))), 4) << i;
  }
}

}  // namespace
}  // namespace headway::plot
