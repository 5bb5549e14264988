// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/random.h>

#include <cmath>
#include <set>

namespace headway {
namespace {

TEST(RandomTest, GivesTheSameNumbersForTheSameSeed) {
  Random one(7), same(7), other(8);
  const auto first = one.bits();
  EXPECT_EQ(first, same.bits());
  EXPECT_NE(first, other.bits());
}

/// Reference: the first outputs of SplitMix64 with seed 1234567 (Vigna's splitmix64.c).
TEST(RandomTest, IsSplitMix64) {
  Random random(1234567);
  EXPECT_EQ(random.bits(), 6457827717110365317ULL);
  EXPECT_EQ(random.bits(), 3203168211198807973ULL);
}

TEST(RandomTest, UniformNumbersFillTheirRange) {
  Random random(1);
  double sum = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double x = random.uniform(-1.0, 3.0);
    ASSERT_GE(x, -1.0);
    ASSERT_LT(x, 3.0);
    sum += x;
  }
  EXPECT_NEAR(sum / 20000, 1.0, 0.03);
}

TEST(RandomTest, NormalNumbersHaveMean0AndVariance1) {
  Random random(2);
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / 20000, 0.0, 0.02);
  EXPECT_NEAR(squares / 20000, 1.0, 0.03);
}

TEST(RandomTest, BelowReachesEachNumber) {
  Random random(3);
  std::set<int> seen;
  for (int i = 0; i < 200; ++i) seen.insert(random.below(5));
  EXPECT_EQ(seen, (std::set<int>{0, 1, 2, 3, 4}));
}

TEST(RandomTest, SeedsOfPartsDifferInEachNumberAndInOrder) {
  const std::set<std::uint64_t> seeds = {seedOf({1, 2}), seedOf({2, 1}), seedOf({1, 3}),
                                         seedOf({1}), seedOf({1, 2, 0})};
  EXPECT_EQ(seeds.size(), 5u);
}

}  // namespace
}  // namespace headway
