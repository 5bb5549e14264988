// SPDX-License-Identifier: BSD-3-Clause
// From recorded images to a rectified pair, and from depth images to its disparities.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/stereo_camera.h>
#include <headway/io/raw_camera.h>

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

/// @throws InputError naming what is impossible about a lens, a pose or the unit
void validate(const RawDepthCamera& camera);

/// Converts depth images to disparities of the rectified intensity image.
///
///     DepthRegistration registration(recorded, rectifier.camera());
///     frame.disparity = registration.disparities(ranges);
class DepthRegistration {
 public:
  /// @param recorded  validated
  /// @param target    rectified intensity camera, with the recorded one's axes; what is deeper than
  ///                  its depth_reach_m is not measured, unless that is 0
  DepthRegistration(const RawDepthCamera& recorded, const StereoCamera& target);

  /// @param ranges  16-bit, of the depth camera's size; 0 and 65535 are holes
  /// @return        32-bit float [px], 0 where nothing was measured, or at edges of surfaces
  [[nodiscard]] cv::Mat disparities(const cv::Mat& ranges) const;

  [[nodiscard]] cv::Size size() const { return {recorded_.depth.width, recorded_.depth.height}; }

 private:
  /// Three depth pixels whose triangle covers a pixel of the intensity image.
  struct Cover {
    int pixel;                   ///< that is covered, as all by its place in its image's rows
    std::array<int, 3> corners;  ///< depth pixels
    float of_b, of_c;            ///< weights of the second and third
  };

  [[nodiscard]] float farthest() const;
  [[nodiscard]] cv::Mat projected(const cv::Mat& ranges) const;
  void coverOnce();
  [[nodiscard]] cv::Mat disparitiesByCovers(const cv::Mat& ranges) const;

  RawDepthCamera recorded_;
  StereoCamera target_;
  cv::Mat rays_;                ///< (x/z, y/z) of each depth pixel, 32-bit
  bool is_registered_ = false;  ///< pixels are those of the rectified intensity image
  std::vector<Cover> covers_;   ///< of cameras in one place; else empty
  cv::Mat unit_disparities_;    ///< then: disparity of each depth pixel at a range of 1, 32-bit
};

}  // namespace headway::io
