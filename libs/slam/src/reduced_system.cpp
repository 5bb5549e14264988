#include "reduced_system.h"

#include <algorithm>

namespace headway::slam {

ReducedSystem::ReducedSystem(int poses, std::vector<std::pair<int, int>> coupled)
    : poses_(poses), columns_(static_cast<std::size_t>(poses)) {
  for (int i = 0; i < poses; ++i) coupled.emplace_back(i, i);
  std::sort(coupled.begin(), coupled.end());
  coupled.erase(std::unique(coupled.begin(), coupled.end()), coupled.end());
  for (const auto& [i, j] : coupled) columns_[static_cast<std::size_t>(i)].push_back(j);
  std::size_t first = 0;
  for (const auto& row : columns_) {
    first_block_.push_back(first);
    first += row.size();
  }
  blocks_.resize(coupled.size());
  setZero();
  if (poses_ > kDense) sparse_ = BlockCholesky(columns_);
}

void ReducedSystem::setZero() {
  std::fill(blocks_.begin(), blocks_.end(), Block::Zero());
  right_.setZero(6 * poses_);
  border_.setZero(6 * poses_);
  corner = right_corner = 0.0;
}

ReducedSystem::Block& ReducedSystem::block(int i, int j) {
  const auto& row = columns_[static_cast<std::size_t>(i)];
  const std::size_t first = first_block_[static_cast<std::size_t>(i)];
  auto at = static_cast<std::size_t>(j - i);  // where all in between are coupled as well
  if (at >= row.size() || row[at] != j) {
    at = static_cast<std::size_t>(std::lower_bound(row.begin(), row.end(), j) - row.begin());
  }
  return blocks_[first + at];
}

void ReducedSystem::fillDense() {
  dense_.resize(6 * poses_, 6 * poses_);
  dense_.setZero();
  auto next = blocks_.begin();
  for (int i = 0; i < poses_; ++i) {
    for (const int j : columns_[static_cast<std::size_t>(i)]) {
      dense_.block<6, 6>(6 * j, 6 * i) = (next++)->transpose();
    }
  }
}

bool ReducedSystem::solve(Eigen::VectorXd& step, double& step_corner) {
  Eigen::MatrixXd columns(6 * poses_, 2);
  columns << right_, border_;
  if (poses_ > 0 && poses_ <= kDense) {
    fillDense();
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> solver(dense_);
    if (solver.info() != Eigen::Success) return false;
    solver.solveInPlace(columns);
  } else if (poses_ > 0) {
    if (!sparse_.factorise(blocks_)) return false;
    sparse_.solveInPlace(columns);
  }
  const double pivot = corner - border_.dot(columns.col(1));
  if (!(pivot > 0.0)) return false;
  step_corner = (right_corner - border_.dot(columns.col(0))) / pivot;
  step = columns.col(0) - step_corner * columns.col(1);
  return true;
}

}  // namespace headway::slam
