// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/assignment.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>
#include <stdexcept>

namespace headway {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double totalOf(const std::vector<CandidatePair>& pairs) {
  double total = 0.0;
  for (const auto& pair : pairs) total += pair.cost;
  return total;
}

/// Tries every choice: the least of cost + unassigned per pair fewer than `most_pairs`, or, where
/// leaving out has no price, the most pairs and then the least cost.
struct Best {
  std::size_t pairs = 0;
  double cost = kInfinity;
};

void tryAll(const std::vector<CandidatePair>& candidates, std::size_t from, std::size_t pairs,
            double cost, double unassigned, std::set<std::size_t>& rows,
            std::set<std::size_t>& columns, Best& best) {
  const bool priced = std::isfinite(unassigned);
  const double value = priced ? cost - unassigned * static_cast<double>(pairs) : cost;
  const bool better =
      priced ? value < best.cost : pairs > best.pairs || (pairs == best.pairs && value < best.cost);
  if (better) best = {pairs, value};
  for (std::size_t i = from; i < candidates.size(); ++i) {
    const auto& c = candidates[i];
    if (rows.count(c.row) + columns.count(c.column) > 0) continue;
    rows.insert(c.row);
    columns.insert(c.column);
    tryAll(candidates, i + 1, pairs + 1, cost + c.cost, unassigned, rows, columns, best);
    rows.erase(c.row);
    columns.erase(c.column);
  }
}

class AssignmentAgainstAllChoicesTest : public testing::TestWithParam<int> {};

TEST_P(AssignmentAgainstAllChoicesTest, IsTheBestOfAll) {
  std::mt19937 random(static_cast<unsigned>(GetParam()));
  std::uniform_real_distribution<double> cost(-3.0, 10.0);
  const std::size_t rows = 1 + random() % 5;
  const std::size_t columns = 1 + random() % 5;
  std::vector<CandidatePair> candidates;
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      if (random() % 3 != 0) candidates.push_back({i * 7, j * 3, cost(random)});
    }
  }
  for (const double unassigned : {kInfinity, 4.0, 0.5}) {
    Best best;
    std::set<std::size_t> used_rows, used_columns;
    tryAll(candidates, 0, 0, 0.0, unassigned, used_rows, used_columns, best);
    const auto chosen = assignPairs(candidates, unassigned);
    const double value =
        totalOf(chosen) -
        (std::isfinite(unassigned) ? unassigned * static_cast<double>(chosen.size()) : 0.0);
    EXPECT_NEAR(best.cost, value, 1e-9) << "unassigned " << unassigned;
    if (!std::isfinite(unassigned)) {
      EXPECT_EQ(best.pairs, chosen.size());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, AssignmentAgainstAllChoicesTest, testing::Range(0, 200));

TEST(AssignmentTest, MorePairsBeforeLessCost) {
  // Taking the cheapest pair would leave row 1 alone.
  const auto chosen = assignPairs({{0, 0, 0.0}, {0, 1, 100.0}, {1, 0, 100.0}});
  ASSERT_EQ(2u, chosen.size());
  EXPECT_EQ(1u, chosen[0].column);
  EXPECT_EQ(0u, chosen[1].column);
}

TEST(AssignmentTest, LeavingAloneIsChosenWhereItIsCheaper) {
  const auto chosen = assignPairs({{0, 0, 0.0}, {0, 1, 100.0}, {1, 0, 100.0}}, 50.0);
  ASSERT_EQ(1u, chosen.size());
  EXPECT_EQ(0u, chosen[0].row);
  EXPECT_EQ(0u, chosen[0].column);
  EXPECT_THAT(assignPairs({{3, 4, 50.0}}, 50.0), testing::IsEmpty());
}

TEST(AssignmentTest, EmptyGivesEmpty) { EXPECT_THAT(assignPairs({}), testing::IsEmpty()); }

TEST(AssignmentTest, OfAPairListedTwiceTheLowerCostIsUsed) {
  const auto chosen = assignPairs({{2, 5, 3.0}, {2, 5, 1.0}});
  ASSERT_EQ(1u, chosen.size());
  EXPECT_EQ(1.0, chosen[0].cost);
}

TEST(AssignmentTest, OrderOfCandidatesDoesNotMatterEvenInTies) {
  std::vector<CandidatePair> candidates;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 8; ++j) candidates.push_back({i, j, double((i + j) % 2)});
  }
  const auto expected = assignPairs(candidates);
  std::mt19937 random(3);
  for (int repeat = 0; repeat < 20; ++repeat) {
    std::shuffle(candidates.begin(), candidates.end(), random);
    const auto chosen = assignPairs(candidates);
    ASSERT_EQ(expected.size(), chosen.size());
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      EXPECT_EQ(expected[k].row, chosen[k].row);
      EXPECT_EQ(expected[k].column, chosen[k].column);
    }
  }
}

TEST(AssignmentTest, ThousandsOfRowsThatHardlyMeet) {
  std::vector<CandidatePair> candidates;
  const std::size_t n = 5000;
  for (std::size_t i = 0; i < n; ++i) {
    candidates.push_back({i, i, 1.0});
    if (i % 2 == 0) candidates.push_back({i, i + 1, 0.5});
  }
  EXPECT_EQ(n, assignPairs(candidates).size());
}

/// A matrix of all rows and columns would need 13 GB.
TEST(AssignmentTest, AChainOfManyRowsIsSolvedByItsCandidatesAlone) {
  constexpr std::size_t kRows = 40000;
  std::vector<CandidatePair> candidates;
  for (std::size_t row = 0; row < kRows; ++row) {
    candidates.push_back({row, row, -1.0});
    candidates.push_back({row, row + 1, -1.2});
  }
  const auto pairs = assignPairs(candidates, 0.0);
  ASSERT_EQ(kRows, pairs.size());
  for (const auto& pair : pairs) EXPECT_EQ(pair.row + 1, pair.column);
}

TEST(AssignmentTest, CostThatIsNotFiniteThrows) {
  EXPECT_THROW((void)assignPairs({{0, 0, kInfinity}}), std::invalid_argument);
  EXPECT_THROW((void)assignPairs({{0, 0, std::nan("")}}), std::invalid_argument);
}

}  // namespace
}  // namespace headway
