// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>
#include <headway/core/stereo_frame.h>

namespace headway::detect {

/// Finds objects in single stereo frames, without the camera's pose.
///
/// Deterministic: the same frames give the same detections, on any number of cores.
class Detector {
 public:
  virtual ~Detector() = default;

  /// @return  boxes in the left image, and in 3D (frame of the left camera) where the detector
  ///          finds those; their evidence is that of a classifier
  [[nodiscard]] virtual Detections detect(const StereoFrame& frame) = 0;
};

/// Detections of a frame without items, boxes in the left camera's frame.
[[nodiscard]] Detections emptyDetections(const StereoFrame& frame);

}  // namespace headway::detect
