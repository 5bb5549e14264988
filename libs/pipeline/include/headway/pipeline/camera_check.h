#pragma once

#include <headway/core/stereo_frame.h>
#include <headway/core/warnings.h>

#include <opencv2/core/mat.hpp>

namespace headway::pipeline {

/// Recognises a camera that delivers the same images again or that is dark.
///
/// Identical images appear as a camera at rest, although noise never repeats. Rows at a fixed
/// distance are compared, so that the cost is negligible.
class CameraCheck {
 public:
  /// Adds "camera_dark" if the left image contains no structure and hardly any light, and
  /// "camera_frozen" if it contains structure and both images equal those of the frame before.
  ///
  /// @return whether the camera is frozen
  bool add(const StereoFrame& frame, Warnings& warnings);

 private:
  cv::Mat left_;  ///< of the frame before; empty in the first
  cv::Mat right_;
};

}  // namespace headway::pipeline
