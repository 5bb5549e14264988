// SPDX-License-Identifier: BSD-3-Clause
// The sparse linear system of the poses that remains of a bundle adjustment when its points are
// eliminated, and its Cholesky decomposition.
#pragma once

#include <Eigen/Cholesky>
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

/// Normal equations of poses, in blocks of 6x6, and of one scalar that is coupled to all of them.
///
/// Symmetric: only blocks on and below the diagonal are held. Few poses are solved by a dense
/// Cholesky decomposition, many by a sparse one, which orders them. The scalar is eliminated last
/// (block elimination), so that it does not fill the sparse factor.
class ReducedSystem {
 public:
  using Block = BlockCholesky::Block;
  static constexpr int kDense = 100;  ///< poses up to which a dense decomposition is faster

  /// @param poses    their number
  /// @param coupled  pairs of poses whose block is not zero, in any order, repeats allowed; of up
  /// to
  ///                 kDense poses all pairs are
  ReducedSystem(int poses, const std::vector<std::pair<int, int>>& coupled);

  [[nodiscard]] int poses() const { return poses_; }
  /// Place of a pose in the system. All other functions name poses by their places.
  [[nodiscard]] int place(int pose) const { return isDense() ? pose : sparse_.place(pose); }
  void setZero();
  /// Block of two coupled poses, row >= column; unlike pairs must have been named to the
  /// constructor.
  [[nodiscard]] Block& block(int row, int column) {
    return isDense() ? denseBlock(row, column) : sparse_.block(row, column);
  }
  [[nodiscard]] Eigen::Ref<Eigen::Matrix<double, 6, 1>> right(int i) {
    return right_.segment<6>(6 * i);
  }
  [[nodiscard]] Eigen::Ref<Eigen::Matrix<double, 6, 1>> border(int i) {
    return border_.segment<6>(6 * i);
  }
  double corner = 0.0;        ///< diagonal element of the scalar
  double right_corner = 0.0;  ///< right-hand side of the scalar

  /// Solves the system.
  ///
  /// @param step         6 elements a pose
  /// @param step_corner  of the scalar
  /// @return             false if the matrix is not positive definite
  [[nodiscard]] bool solve(Eigen::VectorXd& step, double& step_corner);
  /// Inverse variance of the scalar with all poses unknown, as of solve().
  [[nodiscard]] double pivot() const { return pivot_; }

 private:
  [[nodiscard]] bool isDense() const { return poses_ <= kDense; }
  [[nodiscard]] Block& denseBlock(int row, int column) {
    return blocks_[static_cast<std::size_t>(row * (row + 1) / 2 + column)];
  }
  void fillDense();

  int poses_ = 0;
  double pivot_ = 0.0;
  std::vector<Block, Eigen::aligned_allocator<Block>> blocks_;  ///< of a dense system, row by row
  Eigen::VectorXd right_;
  Eigen::VectorXd border_;
  Eigen::MatrixXd dense_;
  BlockCholesky sparse_;
};

}  // namespace headway::slam
