// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/stereo/disparity.h>
#include <headway/stereo/ground_plane.h>

#include "drive.h"
#include "object_extent.h"

namespace headway::detect::test {

/// An empty disparity image, at half size, of a camera 1.65 m above level ground; boxes that face
/// the camera are drawn into it.
struct Grid {
  StereoCamera camera = testCamera();
  stereo::DisparityImage disparity;
  stereo::GroundPlane ground{{0.0, -1.0, 0.0}, 1.65};

  Grid() {
    disparity.reduce = 2;
    disparity.values = cv::Mat(188, 620, CV_32F, cv::Scalar(0));
  }

  /// Cells of a rectangle at a depth.
  ///
  /// @param x       of its centre, to the right [m]
  /// @param bottom  height of its lower edge above the ground [m]
  std::vector<cv::Point> draw(double x, double depth, double width, double bottom, double top) {
    const auto upper_left = *project({x - 0.5 * width, ground.camera_height - top, depth}, camera);
    const auto lower_right =
        *project({x + 0.5 * width, ground.camera_height - bottom, depth}, camera);
    std::vector<cv::Point> cells;
    for (int row = disparity.cellOf(upper_left.y()); row < disparity.cellOf(lower_right.y());
         ++row) {
      for (int column = disparity.cellOf(upper_left.x());
           column < disparity.cellOf(lower_right.x()); ++column) {
        const cv::Point cell(column, row);
        if (!cv::Rect({0, 0}, disparity.values.size()).contains(cell)) continue;
        disparity.values.at<float>(cell) = static_cast<float>(upper_left.z());
        cells.push_back(cell);
      }
    }
    return cells;
  }

  [[nodiscard]] std::vector<ObjectCell> inSpace(const std::vector<cv::Point>& cells) const {
    std::vector<ObjectCell> result;
    for (const auto& cell : cells) {
      const Eigen::Vector3d uvd(disparity.pixelOf(cell.x), disparity.pixelOf(cell.y),
                                disparity.values.at<float>(cell));
      result.push_back({cell, *triangulate(uvd, camera)});
    }
    return result;
  }
};

}  // namespace headway::detect::test
