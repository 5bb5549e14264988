// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <utility>
#include <vector>

#include "block_cholesky.h"

namespace headway::slam {

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
