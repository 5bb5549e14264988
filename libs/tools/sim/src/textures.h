// SPDX-License-Identifier: BSD-3-Clause
// Painted pictures of materials, the ground and the sky.
#pragma once

#include <opencv2/core/mat.hpp>

#include "grain.h"
#include "mesh.h"

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

/// What is painted on one stretch of street.
struct GroundMarks {
  double length_m = 24.0;
  bool centre_line = true;
  bool crossing = false;     ///< zebra crossing in the middle of the stretch
  double crossing_at = 0.5;  ///< ratio of the length
};

inline constexpr int kGroundTexture = 1024;  ///< width and height [px]

/// Ratio of the texture's height at `left` metres from the street's middle (left is up).
[[nodiscard]] float groundTextureV(double left);

/// Picture of a stretch of street from above: u along the street, v from its left to its right.
///
/// Holds carriageway, kerb tops and both pavements; every stretch has its own cracks, patches,
/// covers, stains and leaves.
[[nodiscard]] cv::Mat drawGround(const GroundMarks& marks, const Grain& grain, Random& random);

/// Picture of unpaved ground (grass, gravel) for what lies beyond the streets.
[[nodiscard]] cv::Mat drawMeadow(const Grain& grain, Random& random);

/// Overcast sky with clouds, and hills and roofs along the horizon: u around, v down.
[[nodiscard]] cv::Mat drawSky(Random& random);

/// A drum around the camera that carries the sky's picture.
///
/// @param radius  [m]; far enough that nothing is behind it
[[nodiscard]] Mesh skyMesh(float radius);

}  // namespace headway::sim
