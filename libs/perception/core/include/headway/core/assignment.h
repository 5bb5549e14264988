// SPDX-License-Identifier: BSD-3-Clause
// Optimal assignment of rows to columns, for tracking and evaluation.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace headway {

/// A pair of a row and a column that is allowed, and its cost.
struct CandidatePair {
  std::size_t row = 0;
  std::size_t column = 0;
  double cost = 0.0;  ///< finite; any sign
};

/// Pairs rows with columns one to one at minimum total cost; only candidates are paired.
///
/// Minimises the sum of the selected costs plus `unassigned_cost` for each pair missing from the
/// largest assignment; a candidate with a cost of at least `unassigned_cost` is never selected. By
/// default the number of pairs is maximal. Gated pairs must not be among the candidates.
///
/// Shortest paths visit candidates only, so that sparse problems of thousands of rows are fast. The
/// order of the candidates does not matter; of a pair listed twice the lower cost is used.
///
/// @return  the selected candidates, by ascending row
/// @throws  std::invalid_argument if a cost is not finite
/// @see     Kuhn 1955; Jonker & Volgenant 1987 (shortest augmenting paths)
[[nodiscard]] std::vector<CandidatePair> assignPairs(
    std::vector<CandidatePair> candidates,
    double unassigned_cost = std::numeric_limits<double>::infinity());

}  // namespace headway
