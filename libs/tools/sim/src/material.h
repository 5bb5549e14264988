// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "grain.h"

namespace headway::sim {

/// What surfaces of a site are made of; each has one picture that repeats over the surface.
enum class Material {
  kLinoleum,
  kCarpet,
  kConcrete,
  kAsphalt,
  kPaving,
  kGrass,
  kPlaster,
  kColouredPlaster,
  kBrick,
  kSheetMetal,
  kCeiling,
  kLamp,
  kWood,
  kDarkWood,
  kPallet,
  kCardboard,
  kFabric,
  kSteel,
  kBlueSteel,
  kOrangeSteel,
  kBlackPlastic,
  kWhiteboard,
  kBooks,
  kNotices,
  kScreen,
  kHazardStripes,
  kWhitePaint,
  kYellowPaint,
  kSoil
};

/// Length of surface that one picture of the material covers in either direction [m].
[[nodiscard]] double pictureSize(Material material);

/// @return  8-bit BGR, square, sides a power of two
[[nodiscard]] cv::Mat drawMaterial(Material material, const Grain& grain, Random& random);

}  // namespace headway::sim
