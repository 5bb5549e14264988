// SPDX-License-Identifier: BSD-3-Clause
// Disparities of single points, by matching or from a depth camera.
#pragma once

#include <headway/stereo/image_pyramid.h>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <utility>

namespace headway::stereo {

/// What tells the disparities of points of the left image: the right image, or a depth camera.
struct SecondView {
  SecondView() = default;
  SecondView(ImagePyramid right)
      : image(std::move(right)) {}  // NOLINT(google-explicit-constructor)

  ImagePyramid image;   ///< of a stereo camera
  cv::Mat disparities;  ///< of a depth camera, as StereoFrame::disparity

  [[nodiscard]] bool isDepth() const { return !disparities.empty(); }
};

/// Disparity that a depth camera gives at a point: that of the plane through its surroundings.
///
/// Disparities of a plane are linear in the image, and the mean of 25 pixels has less noise than
/// one of them.
///
/// @param disparities  as StereoFrame::disparity
/// @param uv           [px]
/// @return             nullopt outside, in holes, and at edges, where depth cameras err
[[nodiscard]] std::optional<double> givenDisparity(const cv::Mat& disparities,
                                                   const Eigen::Vector2d& uv);

/// Finds points of the left image in the right one, along the row, to a fraction of a pixel.
///
/// A search over all disparities at half resolution (zero-mean squared differences, with a
/// uniqueness test and a check from right to left) is followed by an alignment at full
/// resolution. Returns disparities [px] at level 0, positive. Those of a depth camera are given:
/// nothing is searched, and predictions and levels have no effect.
///
/// @see Hirschmueller & Scharstein 2009, "Evaluation of stereo matching costs"
class StereoMatcher {
 public:
  /// @param max_disparity  largest disparity searched [px], level 0
  /// @param min_zncc       correlation that a match needs
  StereoMatcher(int max_disparity, double min_zncc)
      : max_disparity_(max_disparity), min_zncc_(min_zncc) {}

  /// Disparity of a point without prediction; nullopt if there is no unique match.
  [[nodiscard]] std::optional<double> search(const ImagePyramid& left, const SecondView& second,
                                             const Eigen::Vector2d& uv) const;

  /// Disparity of a point near an expected one, compared at one pyramid level.
  ///
  /// @param expected  [px], level 0
  [[nodiscard]] std::optional<double> refine(const ImagePyramid& left, const SecondView& second,
                                             const Eigen::Vector2d& uv, double expected,
                                             int level) const;

 private:
  int max_disparity_ = 0;
  double min_zncc_ = 0.0;
};

}  // namespace headway::stereo
