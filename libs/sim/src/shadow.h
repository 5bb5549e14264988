#pragma once

#include <opencv2/core/mat.hpp>

#include "mesh.h"
#include "mover.h"

namespace headway::sim {

/// Soft dark spot, BGRA: what a body takes from the light of an overcast sky.
[[nodiscard]] cv::Mat drawShadow();

/// The spot on the ground below a mover, relative to `origin`.
[[nodiscard]] Mesh shadowMesh(const Mover& mover, const Eigen::Vector3d& origin);

}  // namespace headway::sim
