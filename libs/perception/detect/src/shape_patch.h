// SPDX-License-Identifier: BSD-3-Clause
// What the disparities show of whatever stands at one place, as a classifier of shapes sees it.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/ground_plane.h>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway::detect {

/// Size of a patch: an upright rectangle on the ground, 1.3 m wide and 2.2 m high.
struct ShapePatchLayout {
  int columns = 16;
  int rows = 28;
  double cell_m = 0.08;
  double depth_m = 0.5;  ///< in front of and behind the place, that counts as seen there [m]
  /// What a cell shows, each 0 to 255: mean depth (0 the nearest, 128 that of the place); ratios of
  /// it that are at the place, nearer, farther, and beside the image. The rest is unknown.
  int channels = 5;

  [[nodiscard]] int values() const { return channels * rows * columns; }
};
inline constexpr ShapePatchLayout kShapePatch{};

/// Places on the ground at which something stands: maxima of the visible area above them, 0.2 m
/// apart at least, smoothed by 0.12 m.
///
/// @param range_m  maximum distance [m]
/// @return         on the ground plane, camera frame, from near to far [m]
[[nodiscard]] std::vector<Eigen::Vector3d> standingPlaces(const stereo::DisparityImage& disparity,
                                                          const StereoCamera& camera,
                                                          const stereo::GroundPlane& ground,
                                                          double range_m);

/// Level directions of a patch at a place, unit length, camera frame.
struct ShapePatchAxes {
  Eigen::Vector3d across;  ///< to the right, level
  Eigen::Vector3d away;    ///< from the camera, level
};

/// @param place  not below or above the camera; (0, 0, 1): the axes of the camera itself
[[nodiscard]] ShapePatchAxes axesAt(const Eigen::Vector3d& place,
                                    const stereo::GroundPlane& ground);

/// What stands at a place: an upright rectangle that faces the camera, of kShapePatch.
///
/// @param place  in the middle of the lower edge: on the ground, camera frame [m]
/// @return       8-bit: channels below each other, each of rows from the top to the ground
[[nodiscard]] cv::Mat shapePatch(const Eigen::Vector3d& place,
                                 const stereo::DisparityImage& disparity,
                                 const StereoCamera& camera, const stereo::GroundPlane& ground);

}  // namespace headway::detect
