// SPDX-License-Identifier: BSD-3-Clause
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

}  // namespace headway::stereo
