#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace headway {

/// A row and a column that may be paired, and the cost of that.
struct CandidatePair {
  std::size_t row = 0;
  std::size_t column = 0;
  double cost = 0.0;  ///< finite; any sign
};

/// Pairs rows with columns one to one at the least total cost; only candidates are ever paired.
///
/// Minimises the sum of the chosen costs plus `unassigned_cost` for each pair fewer than could be;
/// a candidate that costs `unassigned_cost` or more is never chosen. With the default there are as
/// many pairs as possible, and among those choices the cheapest. To gate a pair, leave it out.
///
/// Candidates fall into groups that share no row and no column; each is solved on its own in
/// O(rows^2 columns), so sparse problems of thousands of rows are fast. The order of the
/// candidates does not matter; of a pair listed twice the cheaper one counts.
///
/// @return  the chosen candidates, ascending rows
/// @throws  std::invalid_argument if a cost is not finite
/// @see     Kuhn 1955; Jonker & Volgenant 1987 (shortest augmenting paths)
[[nodiscard]] std::vector<CandidatePair> assignPairs(
    std::vector<CandidatePair> candidates,
    double unassigned_cost = std::numeric_limits<double>::infinity());

}  // namespace headway
