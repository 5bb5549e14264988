// SPDX-License-Identifier: BSD-3-Clause
// Checks of each image: light, the same one again, one of the two without use, and why the camera
// is lost.
#pragma once

#include <headway/core/stereo_frame.h>
#include <headway/pipeline/perception_update.h>

#include <array>
#include <optional>
#include <string>

namespace headway::pipeline {

/// Tells what is wrong with a camera's images: the same ones again, without light, overexposed; and
/// why nothing could be tracked in them.
///
/// Identical images appear as a camera at rest, although noise never repeats. Rows at a fixed
/// distance are compared, so that the cost is negligible.
class CameraCheck {
 public:
  CameraCheck();

  /// Takes the images of each frame.
  ///
  /// @return "camera_dark" or "camera_bright" if an image contains no structure and hardly any
  ///         light, or nothing else; "camera_frozen" if both contain structure and equal those of
  ///         the frame before; "one_image" if one of both does, contains no structure where the
  ///         other does, or is the other one
  [[nodiscard]] Findings add(const StereoFrame& frame);
  /// Whether one of the newest images is of no use.
  [[nodiscard]] bool isOneMissing() const { return is_one_missing_; }
  /// Whether the newest images came before.
  [[nodiscard]] bool isFrozen() const { return is_frozen_; }

  /// Measures the image of a tracked frame.
  ///
  /// @param landmarks  that were tracked in it
  /// @return  "blurred" if its edges are wider than usual and less than half of the usual landmarks
  ///          are tracked
  [[nodiscard]] std::optional<Finding> addTracked(const StereoFrame& frame, int landmarks);
  /// Why the camera is lost, by its image and those of tracked frames: "lost_too_dark",
  /// "lost_covered" (even grey: a lens cover, a wall, fog), "lost_blurred" (by motion or focus),
  /// "lost_few_features" (a sharp image of surfaces without texture) or "lost_moved_too_fast" (a
  /// usable image of another view than before).
  [[nodiscard]] Finding lossOf(const StereoFrame& frame) const;

 private:
  cv::Mat left_;  ///< of the frame before; empty in the first
  cv::Mat right_;
  bool is_frozen_ = false;
  bool is_one_missing_ = false;
  bool were_two_ = false;  ///< images that differ, in a pair before
  /// Says how blurred an image with edges of these widths is, along rows and columns [px]; empty if
  /// it is not.
  [[nodiscard]] std::string blurOf(const std::array<double, 2>& widths) const;

  std::array<double, 2> sharpest_;   ///< widths of edges in tracked frames, recently [px]
  std::optional<Time> measured_;     ///< time of the last measurement
  std::optional<double> landmarks_;  ///< usual ones of sharp frames
};

}  // namespace headway::pipeline
