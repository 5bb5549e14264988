// SPDX-License-Identifier: BSD-3-Clause
#include "obvious_pairs.h"

#include <algorithm>

namespace headway::objects {
namespace {

// The two lowest costs of one row or column, including that of no assignment (0).
struct Least {
  double first = 0.0;
  double second = 0.0;

  void add(double cost) {
    if (cost < first) {
      second = first;
      first = cost;
    } else {
      second = std::min(second, cost);
    }
  }
  /// The lowest cost without one of the added costs.
  [[nodiscard]] double without(double cost) const { return cost <= first ? second : first; }
};

}  // namespace

std::vector<CandidatePair> takeObviousPairs(std::vector<CandidatePair>& candidates) {
  std::size_t row_count = 0;
  std::size_t column_count = 0;
  for (const CandidatePair& pair : candidates) {
    row_count = std::max(row_count, pair.row + 1);
    column_count = std::max(column_count, pair.column + 1);
  }
  std::vector<Least> rows(row_count);
  std::vector<Least> columns(column_count);
  for (const CandidatePair& pair : candidates) {
    rows[pair.row].add(pair.cost);
    columns[pair.column].add(pair.cost);
  }
  std::vector<CandidatePair> obvious;
  std::vector<bool> row_taken(row_count, false);
  std::vector<bool> column_taken(column_count, false);
  for (const CandidatePair& pair : candidates) {
    const double others =
        rows[pair.row].without(pair.cost) + columns[pair.column].without(pair.cost);
    if (!(pair.cost < 0.0 && pair.cost < others)) continue;
    obvious.push_back(pair);
    row_taken[pair.row] = true;
    column_taken[pair.column] = true;
  }
  candidates.erase(std::remove_if(candidates.begin(), candidates.end(),
                                  [&](const CandidatePair& pair) {
                                    return row_taken[pair.row] || column_taken[pair.column];
                                  }),
                   candidates.end());
  return obvious;
}

}  // namespace headway::objects
