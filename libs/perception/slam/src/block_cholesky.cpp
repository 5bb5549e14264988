// SPDX-License-Identifier: BSD-3-Clause
#include "block_cholesky.h"

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

}  // namespace headway::slam
