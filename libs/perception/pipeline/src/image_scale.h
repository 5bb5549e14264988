// SPDX-License-Identifier: BSD-3-Clause
// Smaller images inside the pipeline than those of the input (camera.scale).
#pragma once

#include <headway/core/recorded_frame.h>
#include <headway/core/track.h>

#include <memory>
#include <vector>

namespace headway::pipeline {

/// Reduces camera, images and boxes at the pipeline's entrance, and enlarges the boxes of results,
/// so that no stage and no host has to know both sizes.
///
/// A pixel has integer coordinates at its centre: u becomes r (u + 0.5) - 0.5, with the ratio r of
/// the sizes in pixels. A depth camera's disparities keep their values, because their noise does
/// not depend on the size: its baseline grows instead.
class ImageScale {
 public:
  /// Images stay as they are.
  ImageScale() = default;
  /// @param given  camera of the input; null without images: boxes stay as they are
  /// @param scale  CameraParams::scale
  ImageScale(const StereoCamera* given, double scale);

  [[nodiscard]] bool isOne() const { return across_ == 1.0 && down_ == 1.0; }

  /// The camera of the reduced images; null stays null.
  [[nodiscard]] std::shared_ptr<const StereoCamera> reduced(
      const std::shared_ptr<const StereoCamera>& given) const;
  /// Images, 2D boxes and masks of a frame of the given camera; its StereoFrame::camera stays.
  [[nodiscard]] RecordedFrame reduced(RecordedFrame frame) const;

  /// Results with their boxes and masks in pixels of the input.
  [[nodiscard]] Detections enlarged(Detections detections) const;
  [[nodiscard]] std::vector<Track> enlarged(std::vector<Track> tracks) const;

 private:
  double across_ = 1.0, down_ = 1.0;  ///< size inside by size of the input
};

}  // namespace headway::pipeline
