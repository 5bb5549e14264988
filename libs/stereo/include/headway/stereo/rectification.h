// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace headway::stereo {

/// A point matched between left and right image without the condition that rows are equal.
struct RowMatch {
  Eigen::Vector2d right = Eigen::Vector2d::Zero();  ///< in the right image [px]
  double rows = 0.0;  ///< row in the right image minus row in the left one [px]
};

/// Rotation of the right camera against its calibration, by the rows of matched points.
struct RectificationError {
  /// Pitch, yaw and roll: rotation vector along the right camera's x, y and z axis [rad].
  Eigen::Vector3d angles = Eigen::Vector3d::Zero();
  Eigen::Vector3d sigmas = Eigen::Vector3d::Zero();  ///< [rad]
  double offset_px = 0.0;  ///< of the rows at the principal point, right minus left
  double offset_sigma_px = 0.0;
  double rows_rms_px = 0.0;  ///< of the row differences that pitch and roll cause, over the image
};

/// Estimates the rotation of the right camera from the rows of stereo matches over many frames.
///
/// For a point at (x, y) in the right camera's normalised image, a small rotation (pitch, yaw,
/// roll) shifts the row by f * (pitch * (1 + y^2) - yaw * x * y - roll * x). A translation along
/// the rows is not told apart from pitch, which is exact for distant points. Rows tell yaw only by
/// a second-order term that residual lens distortion has as well (0.4 degrees in KITTI's rectified
/// images): it is estimated for the sake of the others and never significant.
///
/// @see  Hartley & Zisserman 2004, Sec. 9.3; Dang, Hoffmann & Stiller 2009, "Continuous stereo
///       self-calibration by camera parameter tracking"
class RectificationEstimator {
 public:
  explicit RectificationEstimator(const StereoCamera& camera) : camera_(camera) {}

  /// Adds the matches of one frame; robust against wrong ones.
  void add(const std::vector<RowMatch>& matches);

  /// The estimate so far; nullopt with too few matches.
  [[nodiscard]] std::optional<RectificationError> error() const;

 private:
  StereoCamera camera_;
  Eigen::Matrix3d information_ = Eigen::Matrix3d::Zero();  ///< of pitch, yaw, roll [1/rad^2]
  Eigen::Vector3d gradient_ = Eigen::Vector3d::Zero();     ///< information times angles
  std::size_t matches_ = 0;
};

/// The angles of pitch and roll that are significant and shift rows by a visible amount; 0 the
/// others [rad].
[[nodiscard]] Eigen::Vector3d significantAngles(const RectificationError& error,
                                                const StereoCamera& camera);

/// One line: offset of the rows and angles with their uncertainties, and the axes that are
/// significantly off.
[[nodiscard]] std::string describe(const RectificationError& error, const StereoCamera& camera);

}  // namespace headway::stereo
