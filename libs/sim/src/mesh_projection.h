#pragma once

#include <headway/core/stereo_camera.h>

#include <array>
#include <vector>

#include "mesh.h"

namespace headway::sim {

/// A triangle in the image: (u, v) [px] and inverse depth [1/m], which is linear over the image.
using ImageTriangle = std::array<Eigen::Vector3f, 3>;

/// Where nearer things begin not to be drawn [m].
inline constexpr float kNearPlane = 0.3F;

/// The mesh's triangles as the left camera sees them, cut at the near plane.
[[nodiscard]] std::vector<ImageTriangle> projectMesh(const Mesh& mesh,
                                                     const Eigen::Isometry3f& T_cam_mesh,
                                                     const StereoCamera& camera);

}  // namespace headway::sim
