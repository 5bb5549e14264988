// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

namespace headway::detect {

/// Splits people who walk abreast.
///
/// They touch in the disparity image but for their heads: every run of columns with cells in the
/// uppermost fifth of the height is a head, and each cell belongs to the nearest one.
///
/// @param cells           connected, of nearly one disparity
/// @param heights         of each above the ground [m]
/// @param metres_per_cell at their depth
/// @return                for each cell the number of its person, 0 ... n - 1, from left to right
[[nodiscard]] std::vector<int> personOfCells(const std::vector<cv::Point>& cells,
                                             const std::vector<double>& heights,
                                             double metres_per_cell);

}  // namespace headway::detect
