// SPDX-License-Identifier: BSD-3-Clause
#include "left_out_cells.h"

#include <opencv2/imgproc.hpp>

namespace headway::detect {
namespace {

constexpr int kMarginCells = 2;

/// Adds the cells in a box, or those of them that are not farther than a depth.
void fill(const MovingBox& box, double min_disparity, const stereo::DisparityImage& disparity,
          cv::Mat& mask) {
  const cv::Point corner(disparity.cellOf(box.left), disparity.cellOf(box.top));
  const cv::Point opposite(disparity.cellOf(box.right) + 1, disparity.cellOf(box.bottom) + 1);
  const cv::Rect cells = cv::Rect(corner, opposite) & cv::Rect({0, 0}, mask.size());
  if (cells.empty()) return;
  const cv::Mat values = disparity.values(cells);
  mask(cells).setTo(255, (values <= 0.0F) | (values >= min_disparity));
}

}  // namespace

cv::Mat leftOutCells(const MovingRegions& moving, const stereo::DisparityImage& disparity,
                     double focal_baseline) {
  cv::Mat mask(disparity.values.size(), CV_8U, cv::Scalar(0));
  if (!moving.mask.empty()) {
    cv::resize(moving.mask, mask, mask.size(), 0, 0, cv::INTER_NEAREST);
  }
  for (const auto& box : moving.boxes) fill(box, focal_baseline / box.to_m, disparity, mask);
  for (const auto& box : moving.unsure) fill(box, focal_baseline / box.to_m, disparity, mask);
  const int side = 2 * kMarginCells + 1;
  cv::dilate(mask, mask, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  return mask;
}

}  // namespace headway::detect
