// SPDX-License-Identifier: BSD-3-Clause
// Cells of a disparity image that scans of the static scene leave out.
#pragma once

#include <headway/core/moving_regions.h>
#include <headway/stereo/disparity.h>

#include <opencv2/imgproc.hpp>

namespace headway::detect {

/// Side of the neighbourhood that block matching smears at the edge of an object [cells].
inline constexpr int kSmearedCells = 5;

/// Cells of a disparity image on regions of moving and possibly moving objects: 8-bit, non-zero.
/// Widened, because block matching widens objects by half a block.
///
/// @param focal_baseline  of the camera, to keep cells in a box that are behind its object, such as
///                        the ground between legs [px m]; 0: all cells in boxes
[[nodiscard]] inline cv::Mat leftOutCells(const MovingRegions& moving,
                                          const stereo::DisparityImage& disparity,
                                          double focal_baseline = 0.0) {
  cv::Mat mask(disparity.values.size(), CV_8U, cv::Scalar(0));
  if (!moving.mask.empty()) {
    cv::resize(moving.mask, mask, mask.size(), 0, 0, cv::INTER_NEAREST);
  }
  for (const auto* boxes : {&moving.boxes, &moving.unsure}) {
    for (const MovingBox& box : *boxes) {
      const cv::Point corner(disparity.cellOf(box.left), disparity.cellOf(box.top));
      const cv::Point opposite(disparity.cellOf(box.right) + 1, disparity.cellOf(box.bottom) + 1);
      const cv::Rect cells = cv::Rect(corner, opposite) & cv::Rect({0, 0}, mask.size());
      if (cells.empty()) continue;
      const cv::Mat values = disparity.values(cells);
      mask(cells).setTo(255, (values <= 0.0F) | (values >= focal_baseline / box.to_m));
    }
  }
  cv::dilate(mask, mask, cv::getStructuringElement(cv::MORPH_RECT, {kSmearedCells, kSmearedCells}));
  return mask;
}

}  // namespace headway::detect
