#pragma once

#include <Eigen/Core>
#include <Eigen/StdVector>
#include <utility>
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

  /// Decomposes a matrix of the pattern given to the constructor.
  ///
  /// @param blocks  row by row, as `columns` names them
  /// @return        false if the matrix is not positive definite
  [[nodiscard]] bool factorise(const std::vector<Block, Eigen::aligned_allocator<Block>>& blocks);

  /// Replaces right-hand sides by solutions. Requires factorise() to have succeeded.
  void solveInPlace(Eigen::MatrixXd& columns) const;

 private:
  /// A column of the factor, in the elimination order.
  struct Column {
    std::vector<int> rows;  ///< below the diagonal, ascending
    std::size_t first = 0;  ///< index of the diagonal block in `factor_`; then those of `rows`
  };
  void analyse(const std::vector<std::vector<int>>& below);
  void update(const Column& column);

  std::vector<int> place_;  ///< in the elimination order, of each row of the matrix
  std::vector<std::pair<std::size_t, bool>>
      target_;  ///< in `factor_`, of each given block; flipped
  std::vector<Column> columns_;
  std::vector<Block, Eigen::aligned_allocator<Block>> factor_;
};

}  // namespace headway::slam
