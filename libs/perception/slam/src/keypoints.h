// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway::slam {

/// A corner of an image.
struct Keypoint {
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();  ///< [px], level 0
  double score = 0.0;  ///< smaller eigenvalue of its structure tensor, mean squared grey a pixel
};

/// Square cells that spread features over an image.
class FeatureGrid {
 public:
  FeatureGrid() = default;
  /// About `cells` square cells on an image of this size [px].
  FeatureGrid(int width, int height, int cells);

  [[nodiscard]] int count() const { return columns_ * rows_; }
  [[nodiscard]] int cellOf(const Eigen::Vector2d& uv) const;
  [[nodiscard]] cv::Rect pixelsOf(int cell) const;

 private:
  int width_ = 0;
  int height_ = 0;
  int size_ = 1;  ///< side of a cell [px]
  int columns_ = 0;
  int rows_ = 0;
};

/// The best corner of every cell that is still free.
///
/// FAST finds candidates, with a threshold that is lowered in cells without any; Shi-Tomasi's
/// score chooses among them, so that edges lose.
///
/// @param occupied  per cell of the grid: true where no corner is wanted
/// @param excluded  8-bit, non-zero where corners are not allowed; may be empty
/// @see Rosten & Drummond 2006; Shi & Tomasi 1994
[[nodiscard]] std::vector<Keypoint> detectKeypoints(const cv::Mat& image, const FeatureGrid& grid,
                                                    const std::vector<bool>& occupied,
                                                    const cv::Mat& excluded);

}  // namespace headway::slam
