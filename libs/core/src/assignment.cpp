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

/// Column of each row at the least total cost, by shortest augmenting paths.
///
/// @param cost  rows <= columns; every row gets a column
std::vector<int> solveDense(const Eigen::MatrixXd& cost) {
  const int rows = static_cast<int>(cost.rows());
  const int columns = static_cast<int>(cost.cols());
  constexpr int kFree = -1;
  std::vector<int> row_of(columns, kFree);
  std::vector<double> row_price(rows, 0.0);
  std::vector<double> column_price(columns, 0.0);
  for (int start = 0; start < rows; ++start) {
    std::vector<double> distance(columns, kInfinity);  // reduced length of the path to a column
    std::vector<int> before(columns, kFree);           // column before it on that path
    std::vector<bool> done(columns, false);
    std::vector<int> visited;
    int row = start;
    int column = kFree;
    double reached = 0.0;
    do {  // Dijkstra from `start` to the nearest free column
      int nearest = kFree;
      for (int j = 0; j < columns; ++j) {
        if (done[j]) continue;
        const double length = reached + cost(row, j) - row_price[row] - column_price[j];
        if (length < distance[j]) {
          distance[j] = length;
          before[j] = column;
        }
        if (nearest == kFree || distance[j] < distance[nearest]) nearest = j;
      }
      column = nearest;
      reached = distance[column];
      done[column] = true;
      visited.push_back(column);
      row = row_of[column];
    } while (row != kFree);
    row_price[start] += reached;
    for (const int j : visited) {
      if (row_of[j] != kFree) row_price[row_of[j]] += reached - distance[j];
      column_price[j] -= reached - distance[j];
    }
    for (; before[column] != kFree; column = before[column]) row_of[column] = row_of[before[column]];
    row_of[column] = start;
  }
  std::vector<int> column_of(rows, kFree);
  for (int j = 0; j < columns; ++j) {
    if (row_of[j] != kFree) column_of[row_of[j]] = j;
  }
  return column_of;
}

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

/// Solves one group; a pair that is no candidate costs as much as leaving both alone.
void solveGroup(const std::vector<CandidatePair>& group, double unassigned_cost,
                std::vector<CandidatePair>& chosen) {
  if (group.size() == 1) {
    chosen.push_back(group.front());
    return;
  }
  auto rows = numbered(group, &CandidatePair::row);
  auto columns = numbered(group, &CandidatePair::column);
  const bool transposed = rows.size() > columns.size();
  const auto [least, most] = std::minmax_element(
      group.begin(), group.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
  const auto pairs = static_cast<double>(std::min(rows.size(), columns.size()));
  // One pair more must outweigh any difference between the costs of all the others.
  const double enough_for_more_pairs =
      most->cost + pairs * (most->cost - least->cost) + std::abs(most->cost) + 1.0;
  const double no_pair = std::min(unassigned_cost, enough_for_more_pairs);
  const auto place = [&](const CandidatePair& pair) {
    const int row = rows.at(pair.row);
    const int column = columns.at(pair.column);
    return transposed ? std::pair(column, row) : std::pair(row, column);
  };
  if (transposed) std::swap(rows, columns);
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(rows.size()),
                                                   static_cast<Eigen::Index>(columns.size()),
                                                   no_pair);
  if (transposed) std::swap(rows, columns);
  for (const auto& candidate : group) {
    const auto [i, j] = place(candidate);
    cost(i, j) = candidate.cost;
  }
  const auto column_of = solveDense(cost);
  for (const auto& candidate : group) {
    const auto [i, j] = place(candidate);
    if (column_of[i] == j) chosen.push_back(candidate);
  }
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
  for (const auto& group : grouped(candidates)) solveGroup(group, unassigned_cost, chosen);
  std::sort(chosen.begin(), chosen.end(), order);
  return chosen;
}

}  // namespace headway
