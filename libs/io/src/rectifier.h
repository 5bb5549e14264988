#pragma once

#include <headway/core/detection.h>
#include <headway/io/rawlog_sink.h>

#include <array>
#include <opencv2/core/mat.hpp>

namespace headway::io {

/// Whether both lenses are free of distortion and of one kind, and the right one stands beside the
/// left one with parallel axes: then rows coincide as they are.
[[nodiscard]] bool isRectified(const RawStereoCamera& camera);

/// Throws InputError naming what no stereo pair can have: sizes or focal lengths that are not
/// positive, no baseline, one camera above the other, left and right swapped, values not finite.
void validate(const RawStereoCamera& camera);

/// Turns recorded stereo images into rectified ones, with maps computed once.
///
/// Images of a pair that is rectified already come out as they went in, pixel for pixel.
///
///     Rectifier rectifier(raw_camera);
///     cv::Mat left = rectifier.rectify(Rectifier::kLeft, raw_left);
class Rectifier {
 public:
  enum Side { kLeft = 0, kRight = 1 };

  /// @throws InputError as validate() does
  explicit Rectifier(const RawStereoCamera& raw);

  /// Whether there is nothing to do.
  [[nodiscard]] bool passesThrough() const { return maps_[kLeft][0].empty(); }

  /// The rectified pair. Its left camera is the recorded one turned about its centre: T_robot_cam
  /// holds that turn.
  [[nodiscard]] const StereoCamera& camera() const { return camera_; }

  /// @param image  as recorded, any depth and number of channels
  [[nodiscard]] cv::Mat rectify(Side side, const cv::Mat& image) const;

  /// The upright box around a box of the recorded left image, in the rectified left image.
  /// Boxes that are not finite stay as they are.
  [[nodiscard]] Box2d rectify(const Box2d& box) const;

 private:
  StereoCamera camera_;
  std::array<std::array<cv::Mat, 2>, 2> maps_;  ///< for cv::remap; empty: nothing to do
  RawCamera raw_left_;
  Eigen::Matrix3d R_rectified_raw_ = Eigen::Matrix3d::Identity();  ///< of the left camera
};

}  // namespace headway::io
