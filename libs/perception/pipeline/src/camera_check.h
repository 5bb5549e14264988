// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_frame.h>
#include <headway/pipeline/perception_update.h>

namespace headway::pipeline {

/// Tells what is wrong with a camera's images: the same ones again, without light, overexposed; and
/// why nothing could be tracked in them.
///
/// Identical images appear as a camera at rest, although noise never repeats. Rows at a fixed
/// distance are compared, so that the cost is negligible.
class CameraCheck {
 public:
  /// Takes the images of each frame.
  ///
  /// @return "camera_dark" or "camera_bright" if an image contains no structure and hardly any
  ///         light, or nothing else; "camera_frozen" if both contain structure and equal those of
  ///         the frame before
  [[nodiscard]] Findings add(const StereoFrame& frame);
  /// Whether the newest images came before.
  [[nodiscard]] bool isFrozen() const { return is_frozen_; }

  /// Measures the image of a tracked frame, every tenth one.
  void addTracked(const StereoFrame& frame);
  /// Why the camera is lost, by its image and those of tracked frames: "lost_too_dark",
  /// "lost_covered" (even grey: a lens cover, a wall, fog), "lost_blurred" (by motion or focus),
  /// "lost_few_features" (a sharp image of surfaces without texture) or "lost_moved_too_fast" (a
  /// usable image of another view than before).
  [[nodiscard]] Finding lossOf(const StereoFrame& frame) const;

 private:
  cv::Mat left_;  ///< of the frame before; empty in the first
  cv::Mat right_;
  bool is_frozen_ = false;
  std::optional<double> sharpness_;  ///< usual one of tracked frames
  int tracked_ = 0;                  ///< frames
};

}  // namespace headway::pipeline
