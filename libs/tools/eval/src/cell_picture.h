// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace headway::eval {

/// A colour of cells and its meaning.
struct Shade {
  std::string name;
  cv::Vec3b bgr;
};

/// Cells seen from above, enlarged, with legend and scale bar.
///
/// @param cells   8-bit BGR, one pixel a cell, y upwards
/// @param side_m  of a cell [m]
[[nodiscard]] cv::Mat cellPicture(const cv::Mat& cells, double side_m,
                                  const std::vector<Shade>& shades);

}  // namespace headway::eval
