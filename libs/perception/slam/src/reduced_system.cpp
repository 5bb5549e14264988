// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_system.h"

#include <algorithm>

namespace headway::slam {

namespace {

/// Of each pose those coupled to it that are not before it, ascending.
std::vector<std::vector<int>> rowsOf(int poses, const std::vector<std::pair<int, int>>& coupled) {
  std::vector<std::vector<int>> rows(static_cast<std::size_t>(poses));
  for (int i = 0; i < poses; ++i) rows[static_cast<std::size_t>(i)].push_back(i);
  for (const auto& [i, j] : coupled) {
    rows[static_cast<std::size_t>(std::min(i, j))].push_back(std::max(i, j));
  }
  for (auto& row : rows) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
  }
  return rows;
}

}  // namespace

ReducedSystem::ReducedSystem(int poses, const std::vector<std::pair<int, int>>& coupled)
    : poses_(poses) {
  if (isDense()) {
    blocks_.resize(static_cast<std::size_t>(poses * (poses + 1) / 2));
  } else {
    sparse_ = BlockCholesky(rowsOf(poses, coupled));
  }
  setZero();
}

void ReducedSystem::setZero() {
  std::fill(blocks_.begin(), blocks_.end(), Block::Zero());
  sparse_.setZero();
  right_.setZero(6 * poses_);
  border_.setZero(6 * poses_);
  corner = right_corner = 0.0;
}

void ReducedSystem::fillDense() {
  dense_.resize(6 * poses_, 6 * poses_);
  dense_.setZero();
  auto next = blocks_.begin();
  for (int row = 0; row < poses_; ++row) {
    for (int column = 0; column <= row; ++column) {
      dense_.block<6, 6>(6 * row, 6 * column) = *next++;
    }
  }
}

bool ReducedSystem::solve(Eigen::VectorXd& step, double& step_corner) {
  Eigen::MatrixXd columns(6 * poses_, 2);
  columns << right_, border_;
  if (poses_ > 0 && isDense()) {
    fillDense();
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> solver(dense_);
    if (solver.info() != Eigen::Success) return false;
    solver.solveInPlace(columns);
  } else if (poses_ > 0) {
    if (!sparse_.factorise()) return false;
    sparse_.solveInPlace(columns);
  }
  pivot_ = corner - border_.dot(columns.col(1));
  if (!(pivot_ > 0.0)) return false;
  step_corner = (right_corner - border_.dot(columns.col(0))) / pivot_;
  step = columns.col(0) - step_corner * columns.col(1);
  return true;
}

}  // namespace headway::slam
