#pragma once

#include <headway/core/detection.h>

#include <opencv2/core/mat.hpp>

namespace headway {

/// Which cells of a reduced left image show an object.
struct ObjectMask {
  cv::Mat cells;     ///< 8-bit, non-zero on the object; covers its bounding box alone
  cv::Point corner;  ///< of that box in the reduced image [cells]
  int reduce = 1;    ///< pixels of the full image to one cell, each way
};

/// What an object looked like in one frame, and where it was then: enough to search for it in a
/// later frame. Immutable once made; detections and tracks share it.
struct AppearanceTemplate {
  ObjectMask mask;                       ///< gaps between the object's cells closed
  cv::Mat patch;                         ///< grey levels of the same cells, 8-bit
  Time time = 0.0;                       ///< [s]
  Pose T_map_camera = Pose::Identity();  ///< then
  Box2d box2d;                           ///< [px]
  Box3d box3d;                           ///< camera frame then
  Eigen::Matrix3d centre_covariance = Eigen::Matrix3d::Identity();  ///< camera frame then [m^2]
  Eigen::Vector3d surface = Eigen::Vector3d::Zero();  ///< middle of what was visible [m]
  int support = 0;                                    ///< measurements that told of it then
};

}  // namespace headway
