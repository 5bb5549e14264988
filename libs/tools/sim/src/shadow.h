// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "actor.h"
#include "mesh.h"

namespace headway::sim {

/// Soft dark spot, BGRA: what a body takes from the light of an overcast sky.
[[nodiscard]] cv::Mat drawShadow();

/// The spot on the ground below an actor, relative to `origin`.
[[nodiscard]] Mesh shadowMesh(const Actor& actor, const Eigen::Vector3d& origin);

}  // namespace headway::sim
