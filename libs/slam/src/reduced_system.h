#pragma once

#include <Eigen/Cholesky>
#include <utility>
#include <vector>

#include "block_cholesky.h"

namespace headway::slam {

/// Normal equations of poses, in blocks of 6x6, and of one scalar that is coupled to all of them.
///
/// Symmetric: only blocks on and above the diagonal are held. Few poses are solved by a dense
/// Cholesky decomposition, many by a sparse one. The scalar is eliminated last (block elimination),
/// so that it does not fill the sparse factor.
class ReducedSystem {
 public:
  using Block = BlockCholesky::Block;
  static constexpr int kDense = 100;  ///< poses up to which a dense decomposition is faster

  /// @param poses    their number
  /// @param coupled  pairs of poses (i < j) whose block is not zero, in any order, repeats allowed
  ReducedSystem(int poses, std::vector<std::pair<int, int>> coupled);

  [[nodiscard]] int poses() const { return poses_; }
  void setZero();
  /// Block of two coupled poses, i <= j; unlike pairs must have been named to the constructor.
  [[nodiscard]] Block& block(int i, int j);
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

 private:
  void fillDense();

  int poses_ = 0;
  std::vector<std::vector<int>> columns_;  ///< of each row of blocks: from the diagonal, ascending
  std::vector<std::size_t> first_block_;   ///< of each row
  std::vector<Block, Eigen::aligned_allocator<Block>> blocks_;
  Eigen::VectorXd right_;
  Eigen::VectorXd border_;
  Eigen::MatrixXd dense_;
  BlockCholesky sparse_;
};

}  // namespace headway::slam
