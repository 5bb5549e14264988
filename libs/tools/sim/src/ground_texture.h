// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "grain.h"

namespace headway::sim {

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

}  // namespace headway::sim
