// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/parallel_rows.h>
#include <headway/core/pose.h>
#include <headway/core/stereo_camera.h>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace headway::detect {

/// Positions of a row's static cells in the previous frame, by their disparities.
class StaticRow {
 public:
  StaticRow(const Eigen::Matrix3f& turn, const Eigen::Vector3f& shift, int row, int reduce)
      : reduce_(static_cast<float>(reduce)),
        begin_(turn.col(1) * pixelOf(row) + turn.col(2)),
        step_(turn.col(0)),
        shift_(shift) {}

  /// Column and row of the grid.
  [[nodiscard]] cv::Point2f before(int column, float disparity) const {
    const Eigen::Vector3f there = step_ * pixelOf(column) + begin_ + shift_ * disparity;
    return {cellOf(there.x() / there.z()), cellOf(there.y() / there.z())};
  }

 private:
  [[nodiscard]] float pixelOf(int cell) const {
    return (static_cast<float>(cell) + 0.5F) * reduce_ - 0.5F;
  }
  [[nodiscard]] float cellOf(float pixel) const { return (pixel + 0.5F) / reduce_ - 0.5F; }

  float reduce_;
  Eigen::Vector3f begin_, step_, shift_;
};

/// Image motion of a static scene from the previous frame to this one.
class StaticScene {
 public:
  StaticScene(const Pose& T_before_now, const StereoCamera& camera, int reduce) : reduce_(reduce) {
    Eigen::Matrix3d K;
    K << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
    turn_ = (K * T_before_now.linear() * K.inverse()).cast<float>();
    shift_ = (K * T_before_now.translation() / (camera.fx * camera.baseline_m)).cast<float>();
  }

  [[nodiscard]] StaticRow row(int row) const { return {turn_, shift_, row, reduce_}; }

 private:
  int reduce_;
  Eigen::Matrix3f turn_;
  Eigen::Vector3f shift_;
};

/// Where cells of this frame are in the frame before.
struct Warp {
  cv::Mat columns, rows;  ///< of the frame before, 32-bit, for each cell
};

/// The warp of a static scene. Holes of the disparities are filled with those of the background
/// beside them, and near objects are dilated, so that the warp does not tear at outlines.
///
/// @param disparities  32-bit, of each cell of a grid; 0 where unknown
[[nodiscard]] Warp warpOf(const cv::Mat& disparities, const StaticScene& scene);

}  // namespace headway::detect
