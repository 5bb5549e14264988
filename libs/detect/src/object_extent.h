#pragma once

#include <headway/core/detection.h>
#include <headway/core/stereo_camera.h>
#include <headway/detect/disparity.h>
#include <headway/detect/ground_plane.h>

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace headway::detect {

/// What dense stereo shows of one object.
struct ObjectExtent {
  Box2d box2d;                                                      ///< [px]
  Box3d box;                                                        ///< camera frame
  Eigen::Matrix3d centre_covariance = Eigen::Matrix3d::Identity();  ///< camera frame [m^2]
  ObjectClass object_class = ObjectClass::kUnknown;                 ///< as size and speed suggest
  std::vector<cv::Point> cells;                                     ///< of the disparity image
};

/// Grows an object from a few of its points over the dense disparities, and puts a box around it.
///
/// A neighbouring cell belongs to it that has nearly the same disparity, is off the ground, not
/// too high, and near to the points over the ground. The box looks along the velocity; where only
/// its near side is seen it extends behind it as far as objects of its kind do.
///
/// @param seeds     points of the object in the camera frame [m]
/// @param velocity  over the ground, camera frame [m/s]
/// @return          nullopt if the seeds lie on nothing that has a disparity, or if what they lie
///                  on floats above the ground
[[nodiscard]] std::optional<ObjectExtent> objectExtent(const std::vector<Eigen::Vector3d>& seeds,
                                                       const Eigen::Vector3d& velocity,
                                                       const DisparityImage& disparity,
                                                       const StereoCamera& camera,
                                                       const std::optional<GroundPlane>& ground);

}  // namespace headway::detect
