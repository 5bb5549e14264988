// SPDX-License-Identifier: BSD-3-Clause
// The picture that all vehicles and people wear.
#pragma once

#include <opencv2/core/mat.hpp>

#include "actor.h"
#include "grain.h"
#include "mesh.h"

namespace headway::sim {

/// Where the faces of one vehicle are in the atlas.
struct VehicleSkin {
  UvRect side, top, front, rear;
  UvRect dark;  ///< tyres, underside
};

/// Where the parts of one person are in the atlas.
struct PersonSkin {
  UvRect torso, trousers, skin, shoes, head, bag;
};

[[nodiscard]] VehicleSkin vehicleSkin(ActorKind kind, int look);
[[nodiscard]] PersonSkin personSkin(int look);

/// One picture with the paint of all vehicles and the clothes of all people.
[[nodiscard]] cv::Mat drawActorAtlas(const Grain& grain, Random& random);

}  // namespace headway::sim
