// SPDX-License-Identifier: BSD-3-Clause
// What every detector does.
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
[[nodiscard]] inline Detections emptyDetections(const StereoFrame& frame) {
  Detections detections;
  detections.time = frame.time;
  detections.T_robot_sensor = frame.camera->T_robot_cam;
  detections.image_width = frame.camera->width;
  detections.image_height = frame.camera->height;
  return detections;
}

}  // namespace headway::detect
