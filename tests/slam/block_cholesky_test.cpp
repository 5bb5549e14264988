#include "block_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

namespace headway::slam {
namespace {

using Blocks = std::vector<BlockCholesky::Block, Eigen::aligned_allocator<BlockCholesky::Block>>;

/// A positive definite matrix whose blocks couple neighbours and a few distant rows, as keyframes
/// of a path with loops. Below the diagonal, the given blocks of the diagonal are not filled.
struct Matrix {
  std::vector<std::vector<int>> columns;
  Blocks blocks;
  Eigen::MatrixXd dense;
};

Matrix pathWithLoops(int rows, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  std::uniform_int_distribution<int> chance(0, 19);
  Matrix matrix;
  matrix.columns.resize(static_cast<std::size_t>(rows));
  matrix.dense.setZero(6 * rows, 6 * rows);
  for (int i = 0; i < rows; ++i) {
    for (int j = i; j < rows; ++j) {
      if (j - i > 3 && chance(random) != 0) continue;
      BlockCholesky::Block block =
          BlockCholesky::Block::NullaryExpr([&]() { return value(random); });
      if (i == j) {
        block = block * block.transpose() + 12.0 * rows * BlockCholesky::Block::Identity();
      }
      matrix.dense.block<6, 6>(6 * i, 6 * j) = block;
      matrix.dense.block<6, 6>(6 * j, 6 * i) = block.transpose();
      if (i == j) block.triangularView<Eigen::StrictlyLower>().setConstant(99.0);
      matrix.columns[static_cast<std::size_t>(i)].push_back(j);
      matrix.blocks.push_back(block);
    }
  }
  return matrix;
}

TEST(BlockCholeskyTest, SolvesAsADenseDecomposition) {
  for (const int rows : {1, 2, 5, 30, 60}) {
    const Matrix matrix = pathWithLoops(rows, static_cast<unsigned>(rows));
    const Eigen::MatrixXd right = Eigen::MatrixXd::Random(6 * rows, 2);
    BlockCholesky solver(matrix.columns);
    for (int repeat = 0; repeat < 2; ++repeat) {
      ASSERT_TRUE(solver.factorise(matrix.blocks)) << rows;
      Eigen::MatrixXd solution = right;
      solver.solveInPlace(solution);
      const Eigen::MatrixXd expected = matrix.dense.llt().solve(right);
      EXPECT_LT((solution - expected).norm(), 1e-12 * expected.norm()) << rows;
    }
  }
}

TEST(BlockCholeskyTest, RefusesAMatrixThatIsNotPositiveDefinite) {
  Matrix matrix = pathWithLoops(8, 3);
  matrix.blocks.back()(2, 2) = -1e6;
  BlockCholesky solver(matrix.columns);
  EXPECT_FALSE(solver.factorise(matrix.blocks));
}

}  // namespace
}  // namespace headway::slam
