// SPDX-License-Identifier: BSD-3-Clause
// How objects look in a frame, by which detectors search for them in later ones.
#pragma once

#include <headway/core/detection.h>

#include <opencv2/core/mat.hpp>

namespace headway {

/// Cells of a reduced left image that belong to an object.
struct ObjectMask {
  cv::Mat cells;     ///< 8-bit, non-zero on the object; its bounding box only
  cv::Point corner;  ///< of that box in the reduced image [cells]
  int reduce = 1;    ///< pixels of the full image per cell, in each direction
};

/// Appearance and position of an object in one frame, by which detectors search for it in later
/// frames. Immutable; detections and tracks share it.
struct AppearanceTemplate {
  ObjectMask mask;                       ///< gaps between the object's cells closed
  cv::Mat patch;                         ///< grey levels of the same cells, 8-bit
  Time time = 0.0;                       ///< [s]
  Pose T_map_camera = Pose::Identity();  ///< at that time
  Box2d box2d;                           ///< [px]
  Box3d box3d;                           ///< in that camera frame
  Eigen::Matrix3d centre_covariance = Eigen::Matrix3d::Identity();  ///< in that camera frame [m^2]
  Eigen::Vector3d surface = Eigen::Vector3d::Zero();  ///< mean of the visible surface [m]
  int support = 0;                                    ///< number of measurements of the object
};

}  // namespace headway
