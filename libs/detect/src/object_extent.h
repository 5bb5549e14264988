#pragma once

#include <headway/core/detection.h>
#include <headway/core/stereo_camera.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/ground_plane.h>

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace headway::detect {

/// A cell of the disparity image that belongs to an object.
struct ObjectCell {
  cv::Point place;        ///< column and row in the disparity image
  Eigen::Vector3d point;  ///< camera frame [m]
};

/// What dense stereo shows of one object.
struct ObjectExtent {
  Box2d box2d;                                        ///< [px]
  Box3d box;                                          ///< camera frame
  Eigen::Vector3d surface = Eigen::Vector3d::Zero();  ///< middle of what is seen, camera frame [m]
  Eigen::Matrix3d centre_covariance = Eigen::Matrix3d::Identity();  ///< camera frame [m^2]
  ObjectClass object_class = ObjectClass::kUnknown;                 ///< as size and speed suggest
  std::vector<cv::Point> cells;                                     ///< of the disparity image
};

/// A ground half a metre below the lowest of some points, where none was found.
[[nodiscard]] stereo::GroundPlane floorBelow(const std::vector<Eigen::Vector3d>& points,
                                             const StereoCamera& camera);

/// Grows an object from a few of its points over the dense disparities.
///
/// A neighbouring cell belongs to it that has nearly the same disparity, is off the ground, not
/// too high, and near to the points over the ground.
///
/// @param seeds  points of the object in the camera frame [m]
/// @return       empty if the seeds lie on nothing that has a disparity
[[nodiscard]] std::vector<ObjectCell> growObject(const std::vector<Eigen::Vector3d>& seeds,
                                                 const stereo::DisparityImage& disparity,
                                                 const StereoCamera& camera,
                                                 const stereo::GroundPlane& ground);

/// Puts a box around an object's cells.
///
/// The box looks along the velocity; where only the object's near side is seen it extends behind
/// it as far as objects of its kind do.
///
/// @param velocity  over the ground, camera frame [m/s]
/// @return          nullopt for hardly any cells, or if all of them float above the ground
[[nodiscard]] std::optional<ObjectExtent> extentOf(const std::vector<ObjectCell>& cells,
                                                   const Eigen::Vector3d& velocity,
                                                   const stereo::DisparityImage& disparity,
                                                   const StereoCamera& camera,
                                                   const stereo::GroundPlane& ground);

}  // namespace headway::detect
