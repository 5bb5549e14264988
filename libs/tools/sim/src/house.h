// SPDX-License-Identifier: BSD-3-Clause
// Houses: their meshes and painted facades.
#pragma once

#include <opencv2/core/mat.hpp>

#include "grain.h"
#include "mesh.h"
#include "occlusion.h"

namespace headway::sim {

/// One house, to be painted.
struct FacadePlan {
  double width_m = 10.0;
  double side_m = 8.0;  ///< depth of the house
  double height_m = 10.0;
  bool shop = false;  ///< shop window on the ground floor
};

inline constexpr int kFacadeTextureWidth = 1024;  ///< [px]
inline constexpr int kFacadeTextureHeight = 512;  ///< [px]
/// Where the front, the gable and the roof are in the picture.
[[nodiscard]] UvRect facadeFront();
[[nodiscard]] UvRect facadeGable();
[[nodiscard]] UvRect facadeRoof();

/// Picture of a house: its front, a side wall and a strip of its roof. No two are alike.
[[nodiscard]] cv::Mat drawFacade(const FacadePlan& plan, const Grain& grain, Random& random);

struct HousePlan {
  FacadePlan facade;
  double ridge_m = 0.0;  ///< height of the roof above the walls; 0: flat
};

/// The walls of a house as a block.
[[nodiscard]] Block houseBlock(const HousePlan& plan, const Eigen::Vector3f& foot, float yaw);

/// A house whose front's foot has its middle at `foot`; the front faces to the right of `yaw`.
[[nodiscard]] Mesh houseMesh(const HousePlan& plan, const Eigen::Vector3f& foot, float yaw);

}  // namespace headway::sim
