// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace headway::stereo {

/// Where a turned right camera sees the points that an exactly mounted one sees.
///
/// A rotation about the projection centre moves pixels independently of depth (Hartley & Zisserman
/// 2004, Sec. 8.4.2), so images of a turned camera can be turned back without knowing the scene.
///
/// @param right   pixel of the exact right camera [px]
/// @param angles  rotation vector from the exact to the turned camera: pitch, yaw, roll along x, y,
///                z of the right camera [rad]
/// @return        pixel of the turned camera [px]
[[nodiscard]] Eigen::Vector2d turnedPixel(const Eigen::Vector2d& right,
                                          const Eigen::Vector3d& angles,
                                          const StereoCamera& camera);

/// The disparity by another estimate of the right camera's turn.
///
/// @param uv         left pixel [px]
/// @param disparity  measured in right images that were turned back by `from` [px]
/// @param from, to   as the angles of turnedPixel() [rad]
/// @return           the disparity in images turned back by `to` [px]
[[nodiscard]] double turnedDisparity(const Eigen::Vector2d& uv, double disparity,
                                     const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                     const StereoCamera& camera);

/// Turns the images of a turned right camera back to those of an exactly mounted one.
class RightTurn {
 public:
  /// No turn: images stay as they are.
  RightTurn() = default;
  /// @param angles  as those of turnedPixel(); zero: images stay as they are [rad]
  RightTurn(const Eigen::Vector3d& angles, const StereoCamera& camera);

  [[nodiscard]] const Eigen::Vector3d& angles() const { return angles_; }

  /// Bicubic, because a linear interpolation blurs the right image alone. Pixels that the camera
  /// does not see repeat those of the border.
  ///
  /// @param right  8-bit grey, of the camera's size
  [[nodiscard]] cv::Mat undone(const cv::Mat& right) const;

 private:
  Eigen::Vector3d angles_ = Eigen::Vector3d::Zero();
  cv::Mat places_, fractions_;  ///< of each pixel in the turned image; empty: no turn
};

}  // namespace headway::stereo
