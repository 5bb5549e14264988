// SPDX-License-Identifier: BSD-3-Clause
// The sparse linear system of the poses that remains of a bundle adjustment when its points are
// eliminated, and its Cholesky decomposition.
#include "reduced_system.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <iterator>

namespace headway::slam {
namespace {

/// Place of each row in an elimination order of little fill.
std::vector<int> eliminationOrder(const std::vector<std::vector<int>>& columns) {
  const int count = static_cast<int>(columns.size());
  std::vector<Eigen::Triplet<double>> elements;
  for (int i = 0; i < count; ++i) {
    for (const int j : columns[static_cast<std::size_t>(i)]) {
      elements.emplace_back(i, j, 1.0);
      if (i != j) elements.emplace_back(j, i, 1.0);
    }
  }
  Eigen::SparseMatrix<double> pattern(count, count);
  pattern.setFromTriplets(elements.begin(), elements.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern, order);
  std::vector<int> place(columns.size());
  for (int k = 0; k < count; ++k) place[static_cast<std::size_t>(order.indices()[k])] = k;
  return place;
}

}  // namespace

BlockCholesky::BlockCholesky(const std::vector<std::vector<int>>& columns)
    : place_(eliminationOrder(columns)), columns_(columns.size()) {
  std::vector<std::vector<int>> below(columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (const int j : columns[i]) {
      const auto [first, last] = std::minmax(place_[i], place_[static_cast<std::size_t>(j)]);
      if (first != last) below[static_cast<std::size_t>(first)].push_back(last);
    }
  }
  analyse(below);
}

/// A column of the factor has the rows of its matrix column, and those of the columns whose first
/// row it is.
void BlockCholesky::analyse(const std::vector<std::vector<int>>& below) {
  std::vector<std::vector<int>> children(columns_.size());
  std::size_t next = 0;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    std::vector<int> rows = below[k];
    for (const int child : children[k]) {
      const auto& inherited = columns_[static_cast<std::size_t>(child)].rows;
      rows.insert(rows.end(), std::next(inherited.begin()), inherited.end());
    }
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    if (!rows.empty()) {
      children[static_cast<std::size_t>(rows.front())].push_back(static_cast<int>(k));
    }
    columns_[k].first = next;
    next += 1 + rows.size();
    columns_[k].rows = std::move(rows);
  }
  factor_.resize(next);
}

void BlockCholesky::setZero() { std::fill(factor_.begin(), factor_.end(), Block::Zero()); }

BlockCholesky::Block& BlockCholesky::block(int row, int column) {
  const Column& of = columns_[static_cast<std::size_t>(column)];
  if (row == column) return factor_[of.first];
  const auto at = std::lower_bound(of.rows.begin(), of.rows.end(), row);
  return factor_[of.first + 1 + static_cast<std::size_t>(at - of.rows.begin())];
}

bool BlockCholesky::factorise() {
  for (const Column& column : columns_) {
    Block& diagonal = factor_[column.first];
    const Eigen::LLT<Block> decomposed(diagonal);
    if (decomposed.info() != Eigen::Success) return false;
    diagonal = decomposed.matrixL();
    for (std::size_t i = 1; i <= column.rows.size(); ++i) {
      diagonal.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(
          factor_[column.first + i]);
    }
    update(column);
  }
  return true;
}

/// Subtracts a finished column's products from the columns of its rows.
void BlockCholesky::update(const Column& column) {
  for (std::size_t j = 0; j < column.rows.size(); ++j) {
    const Block right = factor_[column.first + 1 + j].transpose();
    const Column& target = columns_[static_cast<std::size_t>(column.rows[j])];
    factor_[target.first].noalias() -= factor_[column.first + 1 + j] * right;
    auto row = target.rows.begin();
    for (std::size_t i = j + 1; i < column.rows.size(); ++i) {
      while (*row != column.rows[i]) ++row;
      const auto at = static_cast<std::size_t>(row - target.rows.begin());
      factor_[target.first + 1 + at].noalias() -= factor_[column.first + 1 + i] * right;
    }
  }
}

void BlockCholesky::solveInPlace(Eigen::MatrixXd& columns) const {
  const auto part = [](Eigen::MatrixXd& values, int i) { return values.middleRows<6>(6 * i); };
  const int count = static_cast<int>(columns_.size());
  for (int k = 0; k < count; ++k) {
    const Column& column = columns_[static_cast<std::size_t>(k)];
    auto own = part(columns, k);
    factor_[column.first].triangularView<Eigen::Lower>().solveInPlace(own);
    for (std::size_t i = 0; i < column.rows.size(); ++i) {
      part(columns, column.rows[i]) -= factor_[column.first + 1 + i] * own;
    }
  }
  for (int k = count - 1; k >= 0; --k) {
    const Column& column = columns_[static_cast<std::size_t>(k)];
    auto own = part(columns, k);
    for (std::size_t i = 0; i < column.rows.size(); ++i) {
      own -= factor_[column.first + 1 + i].transpose() * part(columns, column.rows[i]);
    }
    factor_[column.first].triangularView<Eigen::Lower>().transpose().solveInPlace(own);
  }
}

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
