// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>
#include <vector>

#include "camera_path.h"
#include "point_motion.h"

namespace headway::test {}

namespace headway::detect::test {

using namespace headway::test;

constexpr double kFrameStep = 0.1;          ///< between frames [s]
const Eigen::Vector3d kUp(0.0, -1.0, 0.0);  ///< of a level camera

inline StereoCamera testCamera() {
  StereoCamera camera;
  camera.width = 1240;
  camera.height = 376;
  camera.fx = camera.fy = 718.0;
  camera.cx = 620.0;
  camera.cy = 188.0;
  camera.baseline_m = 0.54;
  return camera;
}

/// A camera that drives forward, and what it sees of a point.
struct Drive {
  StereoCamera camera = testCamera();
  CameraPath path{camera, 0.5};
  std::mt19937 random{3};

  std::vector<Observation> see(const Eigen::Vector3d& start, const Eigen::Vector3d& velocity,
                               double noise_px, double offset_px = 0.0, double speed = 10.0,
                               const Eigen::Vector3d& acceleration = Eigen::Vector3d::Zero()) {
    std::normal_distribution<double> noise;
    std::vector<Observation> observations;
    for (int i = 0; i < 7; ++i) {
      Pose T_map_cam = Pose::Identity();
      T_map_cam.translation().z() = speed * kFrameStep * i;
      if (path.newest() < i) path.advance(kFrameStep * i, T_map_cam);
      const double t = kFrameStep * i;
      const Eigen::Vector3d point = start + t * velocity + 0.5 * t * t * acceleration;
      Eigen::Vector3d uvd = *project(T_map_cam.inverse() * point, camera);
      for (int k = 0; k < 3; ++k) uvd[k] += noise_px * noise(random);
      uvd.z() += offset_px;
      observations.push_back({i, uvd});
    }
    return observations;
  }
};

}  // namespace headway::detect::test
