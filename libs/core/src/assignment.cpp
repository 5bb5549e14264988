#include <headway/core/assignment.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>
#include <tuple>

namespace headway {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Gives every row of a dense cost matrix (rows <= columns) a column at the least total cost.
///
/// Rows enter one by one, each along the shortest alternating path to a free column. Invariant:
/// cost(i, j) - row_price(i) - column_price(j) >= 0, and = 0 for the pairs made so far.
class DenseAssignment {
 public:
  explicit DenseAssignment(const Eigen::MatrixXd& cost)
      : cost_(cost),
        row_of_(static_cast<std::size_t>(cost.cols()), kFree),
        row_price_(static_cast<std::size_t>(cost.rows()), 0.0),
        column_price_(row_of_.size(), 0.0) {
    for (int row = 0; row < cost.rows(); ++row) enter(row);
  }

  /// Row of each column, kFree where there is none.
  [[nodiscard]] const std::vector<int>& rowOfColumn() const { return row_of_; }

  static constexpr int kFree = -1;

 private:
  struct Search {
    std::vector<double> distance;  ///< reduced length of the shortest path to each column
    std::vector<int> before;       ///< column before it on that path
    std::vector<bool> done;
    std::vector<int> visited;  ///< columns done, nearest first
  };

  void enter(int start) {
    const std::size_t columns = row_of_.size();
    Search search{std::vector<double>(columns, kInfinity),
                  std::vector<int>(columns, kFree),
                  std::vector<bool>(columns, false),
                  {}};
    double reached = 0.0;
    int column = kFree;
    for (int row = start; row != kFree; row = row_of_[column]) {  // Dijkstra
      relax(search, row, column, reached);
      column = nearest(search);
      reached = search.distance[column];
      search.done[column] = true;
      search.visited.push_back(column);
    }
    row_price_[start] += reached;
    for (const int j : search.visited) {
      if (row_of_[j] != kFree) row_price_[row_of_[j]] += reached - search.distance[j];
      column_price_[j] -= reached - search.distance[j];
    }
    for (; search.before[column] != kFree; column = search.before[column]) {
      row_of_[column] = row_of_[search.before[column]];
    }
    row_of_[column] = start;
  }

  void relax(Search& search, int row, int from, double reached) const {
    for (int j = 0; j < static_cast<int>(row_of_.size()); ++j) {
      const double length = reached + cost_(row, j) - row_price_[row] - column_price_[j];
      if (search.done[j] || !(length < search.distance[j])) continue;
      search.distance[j] = length;
      search.before[j] = from;
    }
  }

  [[nodiscard]] int nearest(const Search& search) const {
    int best = kFree;
    for (int j = 0; j < static_cast<int>(row_of_.size()); ++j) {
      if (search.done[j]) continue;
      if (best == kFree || search.distance[j] < search.distance[best]) best = j;
    }
    return best;
  }

  const Eigen::MatrixXd& cost_;
  std::vector<int> row_of_;
  std::vector<double> row_price_;
  std::vector<double> column_price_;
};

std::size_t rootOf(std::vector<std::size_t>& parent, std::size_t node) {
  while (parent[node] != node) node = parent[node] = parent[parent[node]];
  return node;
}

/// Position of each different value in ascending order.
template <typename Member>
std::map<std::size_t, int> numbered(const std::vector<CandidatePair>& candidates, Member member) {
  std::map<std::size_t, int> number;
  for (const auto& candidate : candidates) number.emplace(candidate.*member, 0);
  int next = 0;
  for (auto& [value, position] : number) position = next++;
  return number;
}

/// Candidates in groups that share neither rows nor columns.
std::vector<std::vector<CandidatePair>> grouped(const std::vector<CandidatePair>& candidates) {
  const auto rows = numbered(candidates, &CandidatePair::row);
  const auto columns = numbered(candidates, &CandidatePair::column);
  std::vector<std::size_t> parent(rows.size() + columns.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  for (const auto& candidate : candidates) {
    const std::size_t row = rootOf(parent, rows.at(candidate.row));
    const std::size_t column = rootOf(parent, rows.size() + columns.at(candidate.column));
    parent[std::max(row, column)] = std::min(row, column);
  }
  std::map<std::size_t, std::vector<CandidatePair>> groups;
  for (const auto& candidate : candidates) {
    groups[rootOf(parent, rows.at(candidate.row))].push_back(candidate);
  }
  std::vector<std::vector<CandidatePair>> result;
  for (auto& [root, group] : groups) result.push_back(std::move(group));
  return result;
}

/// What leaving a pair alone costs within a group: enough that more pairs are always cheaper,
/// whatever the others then cost, unless the caller's price is lower.
double priceOfNoPair(const std::vector<CandidatePair>& group, double pairs,
                     double unassigned_cost) {
  const auto [least, most] = std::minmax_element(
      group.begin(), group.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
  const double spread = most->cost - least->cost;
  return std::min(unassigned_cost, most->cost + pairs * spread + std::abs(most->cost) + 1.0);
}

/// Solves one group that has no more rows than columns.
std::vector<CandidatePair> solveGroup(const std::vector<CandidatePair>& group,
                                      double unassigned_cost) {
  const auto rows = numbered(group, &CandidatePair::row);
  const auto columns = numbered(group, &CandidatePair::column);
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(
      static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns.size()),
      priceOfNoPair(group, static_cast<double>(rows.size()), unassigned_cost));
  for (const auto& candidate : group) {
    cost(rows.at(candidate.row), columns.at(candidate.column)) = candidate.cost;
  }
  const DenseAssignment solved(cost);
  std::vector<CandidatePair> chosen;
  for (const auto& candidate : group) {
    const int row = solved.rowOfColumn()[columns.at(candidate.column)];
    if (row == rows.at(candidate.row)) chosen.push_back(candidate);
  }
  return chosen;
}

void swapRowsAndColumns(std::vector<CandidatePair>& pairs) {
  for (auto& pair : pairs) std::swap(pair.row, pair.column);
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
  std::vector<CandidatePair> chosen;
  for (auto& group : grouped(candidates)) {
    const bool tall = numbered(group, &CandidatePair::row).size() >
                      numbered(group, &CandidatePair::column).size();
    if (tall) swapRowsAndColumns(group);
    auto pairs = solveGroup(group, unassigned_cost);
    if (tall) swapRowsAndColumns(pairs);
    chosen.insert(chosen.end(), pairs.begin(), pairs.end());
  }
  std::sort(chosen.begin(), chosen.end(), order);
  return chosen;
}

}  // namespace headway
