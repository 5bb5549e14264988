// SPDX-License-Identifier: BSD-3-Clause
// Trees, lamps, signs and the like along streets and paths.
#pragma once

#include <opencv2/core/mat.hpp>

#include "grain.h"
#include "mesh.h"

namespace headway::sim {

/// One picture for trees, lamps, bins, signs, hedges and benches.
[[nodiscard]] cv::Mat drawFurnitureAtlas(const Grain& grain, Random& random);

// All stand on the ground at the origin, z up [m]; places and shapes come from `random`.

/// Trunk and an irregular crown of opaque leaf masses (see-through leaves would spoil the depth).
void addTree(Mesh& mesh, const Eigen::Vector3f& foot, Random& random);
/// Leaf masses without a trunk.
void addShrub(Mesh& mesh, const Eigen::Vector3f& foot, float height, Random& random);
/// Street lamp whose arm reaches to the direction `yaw`.
void addLamp(Mesh& mesh, const Eigen::Vector3f& foot, float yaw, Random& random);
/// Traffic sign facing against `yaw`.
void addSign(Mesh& mesh, const Eigen::Vector3f& foot, float yaw, Random& random);
/// Bin, bollard, box or bench.
void addSmallThing(Mesh& mesh, const Eigen::Vector3f& foot, float yaw, Random& random);
/// Hedge or garden wall between two points.
void addHedge(Mesh& mesh, const Eigen::Vector3f& from, const Eigen::Vector3f& to, Random& random);

/// Picket fence or railing between two points: upright bars on two rails.
void addFence(Mesh& mesh, const Eigen::Vector3f& from, const Eigen::Vector3f& to, Random& random);

}  // namespace headway::sim
