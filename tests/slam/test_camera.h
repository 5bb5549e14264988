// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

namespace headway::slam {

/// 640x480 px, focal length 500 px, baseline 0.5 m; the robot's frame is the camera's.
inline StereoCamera testCamera() {
  StereoCamera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 500.0;
  camera.cx = 320.0;
  camera.cy = 240.0;
  camera.baseline_m = 0.5;
  return camera;
}

}  // namespace headway::slam
