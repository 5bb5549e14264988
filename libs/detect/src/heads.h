#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

namespace headway::detect {

/// Tells people who walk abreast apart.
///
/// Their bodies touch in the disparity image, their heads do not: every run of columns in which
/// cells reach into the uppermost fifth of the thing is a head, and each cell goes to the nearest.
///
/// @param cells           connected, of nearly one disparity
/// @param heights         of each above the ground [m]
/// @param metres_per_cell at their depth
/// @return                for each cell the number of its person, 0 ... n - 1, from left to right
[[nodiscard]] std::vector<int> personOfCells(const std::vector<cv::Point>& cells,
                                             const std::vector<double>& heights,
                                             double metres_per_cell);

}  // namespace headway::detect
