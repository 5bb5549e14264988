// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/eval/grid_error.h>
#include <headway/eval/plots.h>

#include <string>

namespace headway::eval {
namespace {

/// 'f' free, 'o' occupied, anything else unknown; the first row is the lowest.
GridCells gridOf(const std::vector<std::string>& rows) {
  GridCells grid({-1.0, 2.0}, 0.5, static_cast<int>(rows[0].size()), static_cast<int>(rows.size()));
  for (std::size_t y = 0; y < rows.size(); ++y) {
    for (std::size_t x = 0; x < rows[y].size(); ++x) {
      grid.states[y * rows[y].size() + x] = rows[y][x] == 'f'   ? CellState::kFree
                                            : rows[y][x] == 'o' ? CellState::kOccupied
                                                                : CellState::kUnknown;
    }
  }
  return grid;
}

const std::vector<std::uint8_t> kUntrodden(12, 0);

TEST(GridCellsTest, FindTheCellOfAPosition) {
  const auto grid = gridOf({"ffff", "ffff", "ffff"});
  EXPECT_EQ(grid.at({-0.9, 2.1}), 0u);
  EXPECT_EQ(grid.at({0.6, 2.6}), 7u);
  EXPECT_FALSE(grid.at({-1.1, 2.1}));
  EXPECT_FALSE(grid.at({1.1, 2.1}));
}

TEST(VisibleObstaclesTest, CountWhatIsJudgedFoundAndCalledFreeWithNothingBeside) {
  const auto truth = gridOf({"ooff", "ffff", "ooff", "ffff", "fffo"});
  const auto estimate = gridOf({"offf", "ffff", "fff?", "ffff", "f??o"});
  std::vector<std::uint8_t> visible(20, 1);
  auto obstacles = visibleObstacles(truth, estimate, visible);
  EXPECT_EQ(obstacles.occupied, 5u);
  EXPECT_EQ(obstacles.judged, 5u);
  EXPECT_EQ(obstacles.found, 2u);
  EXPECT_EQ(obstacles.free_alone, 2u) << "the second cell of the first row is beside a found one";
  visible.assign(20, 0);
  visible[19] = 1;
  obstacles = visibleObstacles(truth, estimate, visible);
  EXPECT_EQ(obstacles.judgedRatio(), 1.0);
  EXPECT_EQ(obstacles.foundRatio(), 1.0);
  EXPECT_EQ(visibleObstacles(truth, estimate, std::vector<std::uint8_t>(20, 0)).foundRatio(),
            std::nullopt);
  EXPECT_EQ(markedFree(estimate, visible), 0u);
  visible[8] = 1;
  EXPECT_EQ(markedFree(estimate, visible), 1u);
}

TEST(GridErrorTest, IsZeroForTheTruth) {
  const auto truth = gridOf({"ffof", "f?of", "ffff"});
  const auto error = gridError(truth, truth, kUntrodden);
  EXPECT_EQ(error.observed, 11u);
  EXPECT_EQ(error.correct, 11u);
  EXPECT_EQ(error.correctRatio(), 1.0);
}

TEST(GridErrorTest, DistinguishesFalseOccupiedAndFalseFreeCells) {
  const auto truth = gridOf({"ffof", "ffff", "ffff"});
  const auto estimate = gridOf({"ffff", "offf", "?o?o"});
  const auto error = gridError(truth, estimate, kUntrodden);
  EXPECT_EQ(error.compared, 10u);
  EXPECT_EQ(error.false_free, 1u);
  EXPECT_EQ(error.false_occupied, 3u);
  EXPECT_EQ(error.near_false_occupied, 0u);
  EXPECT_EQ(error.correct, 6u);
}

TEST(GridErrorTest, ComputesRecallAndPrecision) {
  const auto truth = gridOf({"ooff", "oooo", "ffff"});
  const auto estimate = gridOf({"offf", "?off", "ffof"});
  const auto error = gridError(truth, estimate, kUntrodden);
  EXPECT_EQ(error.occupied, 5u);
  EXPECT_EQ(error.found, 2u);
  EXPECT_EQ(error.false_free, 3u);
  EXPECT_EQ(error.near_false_free, 3u);
  EXPECT_EQ(error.unseen, 1u);
  EXPECT_DOUBLE_EQ(error.occupiedRecall().value(), 2.0 / 5.0);
  EXPECT_DOUBLE_EQ(error.occupiedPrecision().value(), 2.0 / 3.0);
  const auto free = gridOf({"ffff", "ffff", "ffff"});
  EXPECT_EQ(gridError(free, free, kUntrodden).occupiedRecall(), std::nullopt);
  EXPECT_EQ(gridError(free, free, kUntrodden).occupiedPrecision(), std::nullopt);
}

TEST(GridErrorTest, ComparesOnlyObservedCellsWithKnownTruth) {
  const auto error =
      gridError(gridOf({"????", "ffff", "????"}), gridOf({"ffff", "f???", "oooo"}), kUntrodden);
  EXPECT_EQ(error.observed, 9u);
  EXPECT_EQ(error.compared, 1u);
  EXPECT_EQ(gridError(gridOf({"????"}), gridOf({"ffff"}), {0, 0, 0, 0}).correctRatio(),
            std::nullopt);
}

TEST(GridErrorTest, CountsOccupiedCellsOnAMovingObjectsPathAsGhosts) {
  std::vector<std::uint8_t> swept(12, 0);
  swept[0] = swept[1] = swept[11] = 1;
  const auto error =
      gridError(gridOf({"ffff", "ffff", "ffoo"}), gridOf({"offf", "ffff", "ffff"}), swept);
  EXPECT_EQ(error.swept, 2u);
  EXPECT_EQ(error.ghosts, 1u);
  EXPECT_DOUBLE_EQ(error.ghostRatio().value(), 0.5);
}

TEST(OccupiedPrecisionTest, TakesACellBesideAnObstacleForRightAndLeavesOutWhatDoesNotCount) {
  //  o: obstacle; the estimate hits one, touches one from two sides, and has two phantoms.
  const auto truth = gridOf({"offff", "ffff?", "fffff"});
  const auto estimate = gridOf({"oofff", "oof?o", "ffooo"});
  std::vector<std::uint8_t> left_out(15, 0);
  left_out[14] = 1;
  const auto precision = occupiedPrecision(truth, estimate, left_out);
  EXPECT_EQ(precision.called, 6u);
  EXPECT_EQ(precision.strict, 1u);
  EXPECT_EQ(precision.touching, 4u);
  EXPECT_EQ(precision.phantoms(), 2u);
  EXPECT_EQ(precision.unknown, 1u);
  EXPECT_EQ(precision.left_out, 1u);
  EXPECT_DOUBLE_EQ(precision.touchRatio().value(), 4.0 / 6.0);
  EXPECT_DOUBLE_EQ(precision.strictRatio().value(), 1.0 / 6.0);
  const auto free = gridOf({"fffff", "fffff", "fffff"});
  EXPECT_EQ(occupiedPrecision(truth, free, left_out).touchRatio(), std::nullopt);
  EXPECT_ANY_THROW((void)occupiedPrecision(truth, estimate, {0, 0}));
}

TEST(RimsTest, AreTheCellsOfADropThatBorderOtherGround) {
  const auto grid = gridOf({"fffff", "fffff", "fffff", "fffff"});
  const std::vector<std::uint8_t> drops = {0, 0, 0, 0, 0,  //
                                           0, 1, 1, 1, 1,  //
                                           0, 1, 1, 1, 1,  //
                                           0, 1, 1, 1, 1};
  const std::vector<std::uint8_t> rims = {0, 0, 0, 0, 0,  //
                                          0, 1, 1, 1, 1,  //
                                          0, 1, 0, 0, 0,  //
                                          0, 1, 0, 0, 0};
  EXPECT_EQ(rimsOf(grid, drops), rims);
}

TEST(GridErrorTest, RefusesGridsOfDifferentSizes) {
  EXPECT_ANY_THROW((void)gridError(gridOf({"ff"}), gridOf({"fff"}), {0, 0}));
}

TEST(GridPlotTest, ShowsEveryCell) {
  const auto truth = gridOf({"ffof", "ffff", "ffff"});
  const auto plot = gridPlot(truth, truth, kUntrodden);
  EXPECT_GE(plot.cols, 4);
  EXPECT_GT(plot.rows, 3);
}

}  // namespace
}  // namespace headway::eval
