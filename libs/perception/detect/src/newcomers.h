// SPDX-License-Identifier: BSD-3-Clause
// People and things that stand where space was empty, each as one segment.
#pragma once

#include <headway/stereo/ground_plane.h>

#include <vector>

#include "upright_segments.h"

namespace headway::detect {

/// Groups cells by where they stand: a person's parts are near each other over the ground, though
/// limbs do not touch in the disparity image, and people who do touch there seldom stand closer.
///
/// The density of visible surface over the ground, smoothed by the size of a person, has a maximum
/// for each one; each cell belongs to the nearest. What shows too little surface is left out, and
/// what is low though nothing hides its upper part.
///
/// @param is_new  8-bit, cells of EmptySpace
/// @see  Comaniciu & Meer 2002, "Mean shift" (modes of a density)
[[nodiscard]] std::vector<UprightSegment> newcomers(const cv::Mat& is_new,
                                                    const StandingCells& standing,
                                                    const stereo::DisparityImage& disparity,
                                                    const StereoCamera& camera,
                                                    const stereo::GroundPlane& ground);

}  // namespace headway::detect
