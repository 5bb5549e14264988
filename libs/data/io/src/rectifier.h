// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>
#include <headway/io/rawlog_sink.h>
#include <headway/io/rawlog_source.h>

#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway::io {

/// Whether both lenses are equal and free of distortion, and the right camera is displaced along
/// the left one's x axis with parallel axes.
[[nodiscard]] bool isRectified(const RawStereoCamera& camera);

/// @throws InputError if sizes or focal lengths are not positive, the baseline is zero, the cameras
///         are vertically displaced or swapped, or values are not finite
void validate(const RawStereoCamera& camera);

/// Unit-depth rays (x/z, y/z) of pixels of a lens.
[[nodiscard]] std::vector<cv::Point2d> raysOf(const std::vector<cv::Point2d>& pixels,
                                              const RawCamera& lens);

/// Rectifies recorded stereo images, with precomputed maps.
///
/// Images of a rectified pair are returned unchanged.
///
///     Rectifier rectifier(raw_camera);
///     cv::Mat left = rectifier.rectify(Rectifier::kLeft, raw_left);
class Rectifier {
 public:
  enum Side { kLeft = 0, kRight = 1 };

  /// @throws InputError as validate() does
  explicit Rectifier(const RawStereoCamera& raw);

  /// Whether the recorded pair is rectified.
  [[nodiscard]] bool passesThrough() const { return maps_[kLeft][0].empty(); }

  /// The rectified camera. Its left camera is the recorded one rotated about its centre;
  /// T_robot_cam includes the rotation.
  [[nodiscard]] const StereoCamera& camera() const { return camera_; }

  /// @param image  as recorded, any depth and number of channels
  [[nodiscard]] cv::Mat rectify(Side side, const cv::Mat& image) const;

  /// Bounding box in the rectified left image of a box of the recorded left image. Boxes that are
  /// not finite are returned unchanged.
  [[nodiscard]] Box2d rectify(const Box2d& box) const;

 private:
  StereoCamera camera_;
  std::array<std::array<cv::Mat, 2>, 2> maps_;  ///< for cv::remap; empty if already rectified
  RawCamera raw_left_;
  Eigen::Matrix3d R_rectified_raw_ = Eigen::Matrix3d::Identity();  ///< of the left camera
};

/// @throws InputError if left and right images are swapped according to the report
void requireNotSwapped(const CalibrationReport& report);

}  // namespace headway::io
