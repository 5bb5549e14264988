// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/StdVector>
#include <vector>

namespace headway::slam {

/// Cholesky decomposition of a sparse symmetric matrix of 6x6 blocks.
///
/// Eigen's SimplicialLLT works on scalars. With blocks the inner loop is a product of small dense
/// matrices (doc/lab/slam.md, "Loops", compares the times for 791 keyframes).
///
/// @see Davis 2006, "Direct Methods for Sparse Linear Systems", chapter 4 (symbolic analysis);
///      Amestoy, Davis & Duff 1996 (approximate minimum degree ordering)
class BlockCholesky {
 public:
  using Block = Eigen::Matrix<double, 6, 6>;

  BlockCholesky() = default;
  /// Orders the blocks and finds the pattern of the factor.
  ///
  /// @param columns  of each row of blocks (i), the columns (j >= i) that are not zero, ascending
  explicit BlockCholesky(const std::vector<std::vector<int>>& columns);

  /// Place of a row in the elimination order. All other functions name rows by their places.
  [[nodiscard]] int place(int row) const { return place_[static_cast<std::size_t>(row)]; }

  void setZero();
  /// Block of a row and a column <= row that is not zero; of the diagonal's only the lower triangle
  /// is used. The matrix is filled in after setZero() and replaced by its factor in factorise().
  [[nodiscard]] Block& block(int row, int column);
  /// Decomposes the matrix; false if it is not positive definite.
  [[nodiscard]] bool factorise();
  /// Replaces right-hand sides by solutions. Requires factorise() to have succeeded.
  void solveInPlace(Eigen::MatrixXd& columns) const;

 private:
  /// A column of the factor.
  struct Column {
    std::vector<int> rows;  ///< below the diagonal, ascending
    std::size_t first = 0;  ///< index of the diagonal block in `factor_`; then those of `rows`
  };
  void analyse(const std::vector<std::vector<int>>& below);
  void update(const Column& column);

  std::vector<int> place_;  ///< in the elimination order, of each row of the matrix
  std::vector<Column> columns_;
  std::vector<Block, Eigen::aligned_allocator<Block>> factor_;
};

}  // namespace headway::slam
