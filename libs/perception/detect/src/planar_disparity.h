// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway::detect {

/// Disparities smoothed and completed by local planes, whose disparities are linear in the image.
///
/// Block matching leaves most of plain surfaces unknown, and what it gives of them is noisy. A
/// plane is fitted by least squares to the known disparities in square windows around a cell, the
/// largest first. Where they agree with it, the cell takes the plane's disparity: a known one if it
/// agrees, too, and an unknown one if known ones surround it. At edges and creases no plane fits,
/// and the disparities stay as they are.
///
/// @see  Scharstein & Szeliski 2002, "A taxonomy and evaluation of dense two-frame stereo
///       correspondence algorithms", sec. 3.4 (holes are filled by fitting surfaces)
class PlanarDisparity {
 public:
  /// @param disparity  32-bit float [px]
  /// @param known      8-bit, non-zero where planes are fitted to it
  /// @param reliable   8-bit, non-zero where it is taken as it is if no plane fits
  /// @param sigma_px   noise of a disparity [px]
  PlanarDisparity(const cv::Mat& disparity, const cv::Mat& known, const cv::Mat& reliable,
                  double sigma_px);

  /// Disparity in a cell [px]; 0 where it is unknown.
  [[nodiscard]] float at(int column, int row) const;

 private:
  /// Sums over known cells: 1, u, v, d, uu, uv, vv, ud, vd, dd.
  using Moments = std::array<double, 10>;

  [[nodiscard]] Moments momentsAround(int column, int row, int half_side) const;

  cv::Mat disparity_;
  cv::Mat known_;
  cv::Mat reliable_;
  double sigma_px_;
  int columns_, rows_;             ///< of blocks of 2 x 2 cells
  std::vector<Moments> integral_;  ///< of the blocks above and left of each corner of a block
};

}  // namespace headway::detect
