// SPDX-License-Identifier: BSD-3-Clause
// Optimal assignment of rows to columns, for tracking and evaluation.
#include <headway/core/assignment.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace headway {
namespace {

/// Gives every row one of its candidate columns, or leaves it alone for a price, at the least total
/// cost.
///
/// Rows enter one by one, each along the shortest alternating path to a free column; each row has
/// a column of its own, for being left alone. Invariant: cost(i, j) - row_price(i) -
/// column_price(j) >= 0, and = 0 for the pairs made so far. Only candidates are visited, so that
/// thousands of rows cost little where each has few.
class SparseAssignment {
 public:
  /// @param candidates  sorted by row and column, each pair once
  SparseAssignment(const std::vector<CandidatePair>& candidates, double price_of_no_pair)
      : candidates_(candidates), price_of_no_pair_(price_of_no_pair) {
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (i == 0 || candidates[i].row != candidates[i - 1].row) first_.push_back(i);
      columns_ = std::max(columns_, candidates[i].column + 1);
    }
    const std::size_t rows = first_.size();
    first_.push_back(candidates.size());
    row_of_.assign(columns_ + rows, kNone);
    row_price_.assign(rows, 0.0);
    column_price_.assign(columns_ + rows, 0.0);
    distance_.assign(columns_ + rows, INFINITY);
    before_.assign(columns_ + rows, kNone);
    done_.assign(columns_ + rows, false);
    for (std::size_t row = 0; row < rows; ++row) enter(row);
  }

  /// The chosen candidates, in their order.
  [[nodiscard]] std::vector<CandidatePair> pairs() const {
    std::vector<CandidatePair> pairs;
    for (std::size_t row = 0; row + 1 < first_.size(); ++row) {
      for (std::size_t i = first_[row]; i < first_[row + 1]; ++i) {
        if (row_of_[candidates_[i].column] == row) pairs.push_back(candidates_[i]);
      }
    }
    return pairs;
  }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  using Reached = std::pair<double, std::size_t>;  ///< length of the path to a column

  /// A priority queue whose memory is used again.
  class Queue : public std::priority_queue<Reached, std::vector<Reached>, std::greater<>> {
   public:
    void clear() { c.clear(); }
  };

  void enter(std::size_t start) {
    queue_.clear();
    visited_.clear();
    seen_.clear();
    double reached = 0.0;
    std::size_t column = kNone;
    for (std::size_t row = start; row != kNone; row = row_of_[column]) {  // Dijkstra
      relaxRow(row, column, reached);
      while (queue_.top().first > distance_[queue_.top().second]) queue_.pop();  // outdated
      std::tie(reached, column) = queue_.top();
      queue_.pop();
      done_[column] = true;
      visited_.push_back(column);
    }
    row_price_[start] += reached;
    for (const std::size_t j : visited_) {
      if (row_of_[j] != kNone) row_price_[row_of_[j]] += reached - distance_[j];
      column_price_[j] -= reached - distance_[j];
    }
    for (; before_[column] != kNone; column = before_[column]) {
      row_of_[column] = row_of_[before_[column]];
    }
    row_of_[column] = start;
    for (const std::size_t j : visited_) done_[j] = false;
    for (const std::size_t j : seen_) distance_[j] = INFINITY;
  }

  void relaxRow(std::size_t row, std::size_t from, double reached) {
    const auto relax = [&](std::size_t column, double cost) {
      const double length = reached + cost - row_price_[row] - column_price_[column];
      if (done_[column] || !(length < distance_[column])) return;
      if (distance_[column] == INFINITY) seen_.push_back(column);
      distance_[column] = length;
      before_[column] = from;
      queue_.emplace(length, column);
    };
    for (std::size_t i = first_[row]; i < first_[row + 1]; ++i) {
      relax(candidates_[i].column, candidates_[i].cost);
    }
    relax(columns_ + row, price_of_no_pair_);
  }

  const std::vector<CandidatePair>& candidates_;
  double price_of_no_pair_;
  std::size_t columns_ = 0;         ///< of candidates; those of single rows follow
  std::vector<std::size_t> first_;  ///< of a row's candidates
  std::vector<std::size_t> row_of_;
  std::vector<double> row_price_;
  std::vector<double> column_price_;
  std::vector<double> distance_;  ///< reduced length of the shortest path to each column
  std::vector<bool> done_;
  std::vector<std::size_t> before_;  ///< column before it on that path
  // Of the row that enters:
  Queue queue_;
  std::vector<std::size_t> visited_;  ///< columns whose distance is final
  std::vector<std::size_t> seen_;     ///< columns with a distance
};

/// Numbers the rows or columns that occur from 0 on.
template <typename Member>
std::vector<std::size_t> renumber(std::vector<CandidatePair>& candidates, Member member) {
  std::vector<std::size_t> numbers;
  numbers.reserve(candidates.size());
  for (const auto& candidate : candidates) numbers.push_back(candidate.*member);
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  for (auto& candidate : candidates) {
    const auto number = std::lower_bound(numbers.begin(), numbers.end(), candidate.*member);
    candidate.*member = static_cast<std::size_t>(number - numbers.begin());
  }
  return numbers;
}

/// What leaving a pair alone costs: enough that more pairs are always cheaper, whatever the others
/// then cost, unless the caller's price is lower.
double priceOfNoPair(const std::vector<CandidatePair>& candidates, double pairs,
                     double unassigned_cost) {
  const auto [least, most] =
      std::minmax_element(candidates.begin(), candidates.end(),
                          [](const auto& a, const auto& b) { return a.cost < b.cost; });
  const double spread = most->cost - least->cost;
  return std::min(unassigned_cost, most->cost + pairs * spread + std::abs(most->cost) + 1.0);
}

}  // namespace

std::vector<CandidatePair> assignPairs(std::vector<CandidatePair> candidates,
                                       double unassigned_cost) {
  for (const auto& candidate : candidates) {
    if (!std::isfinite(candidate.cost)) {
      throw std::invalid_argument("assignPairs: the cost of a candidate is not finite");
    }
  }
  const auto order = [](const CandidatePair& a, const CandidatePair& b) {
    return std::tie(a.row, a.column, a.cost) < std::tie(b.row, b.column, b.cost);
  };
  const auto same_pair = [](const CandidatePair& a, const CandidatePair& b) {
    return a.row == b.row && a.column == b.column;
  };
  candidates.erase(std::remove_if(candidates.begin(), candidates.end(),
                                  [&](const auto& c) { return !(c.cost < unassigned_cost); }),
                   candidates.end());
  std::sort(candidates.begin(), candidates.end(), order);
  candidates.erase(std::unique(candidates.begin(), candidates.end(), same_pair), candidates.end());
  if (candidates.empty()) return candidates;
  const auto columns = renumber(candidates, &CandidatePair::column);
  const auto rows = static_cast<double>(std::min(candidates.size(), columns.size()));
  auto chosen =
      SparseAssignment(candidates, priceOfNoPair(candidates, rows, unassigned_cost)).pairs();
  for (auto& pair : chosen) pair.column = columns[pair.column];
  return chosen;
}

}  // namespace headway
