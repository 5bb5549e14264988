// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/moving_regions.h>
#include <headway/stereo/disparity.h>

namespace headway::detect {

/// Cells of a disparity image on regions of moving and possibly moving objects: 8-bit, non-zero.
/// Widened, because block matching widens objects by half a block.
///
/// @param focal_baseline  of the camera, to keep cells in a box that are behind its object, such as
///                        the ground between legs [px m]; 0: all cells in boxes
[[nodiscard]] cv::Mat leftOutCells(const MovingRegions& moving,
                                   const stereo::DisparityImage& disparity,
                                   double focal_baseline = 0.0);

}  // namespace headway::detect
