// SPDX-License-Identifier: BSD-3-Clause
// Extent of an object: its cells of the disparity image, its boxes and its class by size.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/stereo_camera.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/ground_plane.h>

#include <algorithm>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace headway::detect {

/// Values between a smallest and a largest one; none before the first is added.
struct Range {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();

  void add(double value) {
    min = std::min(min, value);
    max = std::max(max, value);
  }
  [[nodiscard]] double size() const { return max - min; }
};

inline constexpr double kFastestWalker = 3.2;  // [m/s]
inline constexpr double kCellSigma = 0.4;      // of the disparity of a cell [px]
/// Error of the matches of one surface that all its cells share [px].
inline constexpr double kSurfaceSigma_px = 0.3;
/// Ratio of disparities from which something is farther than an object.
inline constexpr double kFartherRatio = 0.1;
/// And by this much, at least [px].
inline constexpr double kFarther_px = 1.5;
inline constexpr double kSureSigmas = 3.0;
/// Height that a standing person exceeds, and one that nobody does [m].
inline constexpr double kMinTop = 0.9;
inline constexpr double kHeadHeight = 2.4;
inline constexpr int kMinPersonCells = 20;  // that show a person

/// A cell of the disparity image that belongs to an object.
struct ObjectCell {
  cv::Point place;        ///< column and row in the disparity image
  Eigen::Vector3d point;  ///< camera frame [m]
};

/// Extent of one object by dense stereo.
struct ObjectExtent {
  Box2d box2d;  ///< [px]
  Box3d box;    ///< camera frame
  Eigen::Vector3d surface =
      Eigen::Vector3d::Zero();  ///< centre of the visible surface, camera frame [m]
  Eigen::Matrix3d centre_covariance = Eigen::Matrix3d::Identity();  ///< camera frame [m^2]
  ObjectClass object_class = ObjectClass::kUnknown;                 ///< by size and speed
  std::vector<cv::Point> cells;                                     ///< of the disparity image
};

/// A ground half a metre below the lowest of some points, for frames without a ground plane.
[[nodiscard]] stereo::GroundPlane floorBelow(const std::vector<Eigen::Vector3d>& points,
                                             const StereoCamera& camera);

/// Grows an object from a few of its points over the dense disparities.
///
/// A neighbouring cell is added if it has nearly the same disparity, lies between two heights above
/// the ground, and is near the points over the ground.
///
/// @param seeds  points of the object in the camera frame [m]
/// @return       empty if no seed has a disparity
[[nodiscard]] std::vector<ObjectCell> growObject(const std::vector<Eigen::Vector3d>& seeds,
                                                 const stereo::DisparityImage& disparity,
                                                 const StereoCamera& camera,
                                                 const stereo::GroundPlane& ground);

/// Fits a box to an object's cells.
///
/// The box is aligned with the velocity. Where only the near side is visible it is completed to the
/// usual size of the class. Only a speed beyond its uncertainty makes a narrow object a vehicle.
///
/// @param velocity  over the ground, camera frame [m/s]
/// @return          nullopt for too few cells, or if all of them are above the ground
[[nodiscard]] std::optional<ObjectExtent> extentOf(const std::vector<ObjectCell>& cells,
                                                   const MeasuredVelocity& velocity,
                                                   const stereo::DisparityImage& disparity,
                                                   const StereoCamera& camera,
                                                   const stereo::GroundPlane& ground);

}  // namespace headway::detect
