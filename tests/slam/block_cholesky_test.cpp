// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "reduced_system.h"

namespace headway::slam {
namespace {

/// A positive definite matrix whose blocks couple neighbours and a few distant rows, as keyframes
/// of a path with loops.
struct Matrix {
  std::vector<std::vector<int>> columns;
  Eigen::MatrixXd dense;

  /// Above the diagonal, the blocks of the diagonal are not filled.
  void copyInto(BlockCholesky& solver) const {
    solver.setZero();
    for (int i = 0; i < static_cast<int>(columns.size()); ++i) {
      for (const int j : columns[static_cast<std::size_t>(i)]) {
        const int row = solver.place(i), column = solver.place(j);
        BlockCholesky::Block block = dense.block<6, 6>(6 * i, 6 * j);
        if (i == j) block.triangularView<Eigen::StrictlyUpper>().setConstant(99.0);
        if (row >= column) {
          solver.block(row, column) = block;
        } else {
          solver.block(column, row) = block.transpose();
        }
      }
    }
  }
};

/// Rows of six in the order of the solver, or back.
Eigen::MatrixXd ordered(const Eigen::MatrixXd& rows, const BlockCholesky& solver, bool back) {
  Eigen::MatrixXd result(rows.rows(), rows.cols());
  for (int i = 0; 6 * i < rows.rows(); ++i) {
    const int from = 6 * (back ? solver.place(i) : i), to = 6 * (back ? i : solver.place(i));
    result.middleRows<6>(to) = rows.middleRows<6>(from);
  }
  return result;
}

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
      matrix.columns[static_cast<std::size_t>(i)].push_back(j);
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
      matrix.copyInto(solver);
      ASSERT_TRUE(solver.factorise()) << rows;
      Eigen::MatrixXd solution = ordered(right, solver, false);
      solver.solveInPlace(solution);
      solution = ordered(solution, solver, true);
      const Eigen::MatrixXd expected = matrix.dense.llt().solve(right);
      EXPECT_LT((solution - expected).norm(), 1e-12 * expected.norm()) << rows;
    }
  }
}

TEST(BlockCholeskyTest, RefusesAMatrixThatIsNotPositiveDefinite) {
  Matrix matrix = pathWithLoops(8, 3);
  matrix.dense.bottomRightCorner<4, 4>()(0, 0) = -1e6;
  BlockCholesky solver(matrix.columns);
  matrix.copyInto(solver);
  EXPECT_FALSE(solver.factorise());
}

}  // namespace
}  // namespace headway::slam
