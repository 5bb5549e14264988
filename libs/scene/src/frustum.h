#pragma once

#include <headway/core/stereo_camera.h>

#include <array>
#include <utility>

namespace headway::scene {

using Edge = std::pair<Eigen::Vector3d, Eigen::Vector3d>;

/// What the left camera sees, cut off 1.8 m before it: four edges of the far end, then four that
/// run from the camera to its corners [m, map frame].
[[nodiscard]] inline std::array<Edge, 8> frustumEdges(const StereoCamera& camera,
                                                      const Pose& T_map_robot) {
  constexpr double kDepthM = 1.8;
  const Pose T_map_cam = T_map_robot * camera.T_robot_cam;
  const auto corner = [&](double u, double v) {
    return Eigen::Vector3d(T_map_cam * (kDepthM * ray({u, v}, camera)));
  };
  const std::array<Eigen::Vector3d, 4> corners = {corner(0, 0), corner(camera.width, 0),
                                                  corner(camera.width, camera.height),
                                                  corner(0, camera.height)};
  std::array<Edge, 8> edges;
  for (std::size_t i = 0; i < 4; ++i) {
    edges[i] = {corners[i], corners[(i + 1) % 4]};
    edges[4 + i] = {T_map_cam.translation(), corners[i]};
  }
  return edges;
}

}  // namespace headway::scene
