// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "consistency.h"

namespace headway::objects {
namespace {

double total(const std::vector<CandidatePair>& pairs) {
  double sum = 0.0;
  for (const CandidatePair& pair : pairs) sum += pair.cost;
  return sum;
}

TEST(ObviousPairsTest, LeaveTheBestAssignmentAsGoodAsItWas) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> cost(-10.0, 3.0);
  std::size_t obvious_in_all = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::bernoulli_distribution listed(0.1 + 0.3 * (trial % 3));
    std::vector<CandidatePair> candidates;
    for (std::size_t row = 0; row < 8; ++row) {
      for (std::size_t column = 0; column < 9; ++column) {
        if (listed(random)) candidates.push_back({row, column, cost(random)});
      }
    }
    const double best = total(assignPairs(candidates, 0.0));
    const auto obvious = takeObviousPairs(candidates);
    obvious_in_all += obvious.size();
    EXPECT_NEAR(total(obvious) + total(assignPairs(candidates, 0.0)), best, 1e-9);
  }
  EXPECT_GT(obvious_in_all, 300u);
}

TEST(ObviousPairsTest, AreNotThoseThatSomethingElseMayBeat) {
  std::vector<CandidatePair> candidates = {{0, 0, -5.0}, {0, 1, -4.0}, {1, 0, -4.0}};
  EXPECT_THAT(takeObviousPairs(candidates), ::testing::IsEmpty()) << "-8 beats -5";
  EXPECT_EQ(candidates.size(), 3u);
}

TEST(ObviousPairsTest, CostAtMostZero) {
  std::vector<CandidatePair> candidates = {{0, 0, 2.0}, {1, 1, -1.0}};
  const auto obvious = takeObviousPairs(candidates);
  ASSERT_EQ(obvious.size(), 1u);
  EXPECT_EQ(obvious[0].row, 1u);
}

}  // namespace
}  // namespace headway::objects
