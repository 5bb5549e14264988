// SPDX-License-Identifier: BSD-3-Clause
#include "static_scene.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace headway::detect {
namespace {

const cv::Size kNearMargin(17, 5);  // by which near objects are dilated [cells]

// Fills a row's holes with the smaller of the disparities beside them, the background's.
void fillRow(float* row, int columns) {
  float left = 0.0F;
  for (int begin = 0; begin < columns;) {
    if (row[begin] > 0.0F) {
      left = row[begin++];
      continue;
    }
    int end = begin;
    while (end < columns && row[end] <= 0.0F) ++end;
    const float right = end < columns ? row[end] : left;
    const float fill = left > 0.0F ? std::min(left, right) : right;
    std::fill(row + begin, row + end, fill);
    begin = end;
  }
}

// Disparities without holes, near objects dilated so that the warp does not tear at outlines.
cv::Mat smoothed(const cv::Mat& disparities) {
  cv::Mat result;
  cv::dilate(disparities, result, cv::getStructuringElement(cv::MORPH_RECT, kNearMargin));
  for (int row = 0; row < result.rows; ++row) fillRow(result.ptr<float>(row), result.cols);
  return result;
}

}  // namespace

Warp warpOf(const cv::Mat& disparities, const StaticScene& scene) {
  const cv::Mat filled = smoothed(disparities);
  Warp warp{cv::Mat(disparities.size(), CV_32F), cv::Mat(disparities.size(), CV_32F)};
  forEachRow(disparities.rows, [&](int row) {
    const StaticRow static_row = scene.row(row);
    const auto* d = filled.ptr<float>(row);
    auto* columns = warp.columns.ptr<float>(row);
    auto* rows = warp.rows.ptr<float>(row);
    for (int column = 0; column < disparities.cols; ++column) {
      const cv::Point2f there = static_row.before(column, d[column]);
      columns[column] = there.x;
      rows[column] = there.y;
    }
  });
  return warp;
}

}  // namespace headway::detect
