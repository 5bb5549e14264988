// SPDX-License-Identifier: BSD-3-Clause
#include "left_out_cells.h"

#include <opencv2/imgproc.hpp>

namespace headway::detect {
namespace {

constexpr int kMarginCells = 2;

}  // namespace

cv::Mat leftOutCells(const MovingRegions& moving, const stereo::DisparityImage& disparity) {
  cv::Mat mask(disparity.values.size(), CV_8U, cv::Scalar(0));
  if (!moving.mask.empty()) {
    cv::resize(moving.mask, mask, mask.size(), 0, 0, cv::INTER_NEAREST);
  }
  const cv::Rect inside({0, 0}, mask.size());
  const auto fill = [&](const Box2d& box) {
    const cv::Point corner(disparity.cellOf(box.left), disparity.cellOf(box.top));
    const cv::Point opposite(disparity.cellOf(box.right) + 1, disparity.cellOf(box.bottom) + 1);
    mask(cv::Rect(corner, opposite) & inside).setTo(255);
  };
  for (const auto& box : moving.boxes) fill(box);
  for (const auto& box : moving.unsure) fill(box);
  const int side = 2 * kMarginCells + 1;
  cv::dilate(mask, mask, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  return mask;
}

}  // namespace headway::detect
