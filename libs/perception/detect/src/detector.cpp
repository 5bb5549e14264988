// SPDX-License-Identifier: BSD-3-Clause
#include <headway/detect/detector.h>

namespace headway::detect {

Detections emptyDetections(const StereoFrame& frame) {
  Detections detections;
  detections.time = frame.time;
  detections.T_robot_sensor = frame.camera->T_robot_cam;
  detections.image_width = frame.camera->width;
  detections.image_height = frame.camera->height;
  return detections;
}

}  // namespace headway::detect
