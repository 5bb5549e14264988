// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_frame.h>
#include <headway/core/warnings.h>

#include <opencv2/core/mat.hpp>

namespace headway::pipeline {

/// Recognises a camera that delivers the same images again, or images without light or overexposed.
///
/// Identical images appear as a camera at rest, although noise never repeats. Rows at a fixed
/// distance are compared, so that the cost is negligible.
class CameraCheck {
 public:
  /// Adds "camera_dark" or "camera_bright" if an image contains no structure and hardly any light,
  /// or nothing else, and "camera_frozen" if both contain structure and equal those of the frame
  /// before.
  ///
  /// @return whether the camera is frozen
  bool add(const StereoFrame& frame, Warnings& warnings);

 private:
  /// @return  whether both images contain structure
  static bool warnOfExposure(const StereoFrame& frame, Warnings& warnings);

  cv::Mat left_;  ///< of the frame before; empty in the first
  cv::Mat right_;
};

}  // namespace headway::pipeline
