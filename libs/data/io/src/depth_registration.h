// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/io/depth_camera.h>
#include <headway/io/rawlog_sink.h>

#include <opencv2/core/mat.hpp>

namespace headway::io {

/// @throws InputError naming what is impossible about a lens, a pose or the unit
void validate(const RawDepthCamera& camera);

/// Converts depth images to disparities of the rectified intensity image.
///
///     DepthRegistration registration(recorded, rectifier.camera());
///     frame.disparity = registration.disparities(ranges);
class DepthRegistration {
 public:
  /// @param recorded  validated
  /// @param target    rectified intensity camera, with the recorded one's axes
  DepthRegistration(const RawDepthCamera& recorded, const StereoCamera& target);

  /// @param ranges  16-bit, of the depth camera's size; 0 and 65535 are holes
  /// @return        32-bit float [px], 0 where nothing was measured, or at edges of surfaces
  [[nodiscard]] cv::Mat disparities(const cv::Mat& ranges) const;

  [[nodiscard]] cv::Size size() const { return {recorded_.depth.width, recorded_.depth.height}; }

 private:
  [[nodiscard]] cv::Mat projected(const cv::Mat& ranges) const;

  RawDepthCamera recorded_;
  StereoCamera target_;
  cv::Mat rays_;                ///< (x/z, y/z) of each depth pixel, 32-bit
  bool is_registered_ = false;  ///< pixels are those of the rectified intensity image
};

}  // namespace headway::io
