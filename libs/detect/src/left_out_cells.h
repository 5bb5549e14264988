// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/moving_regions.h>
#include <headway/stereo/disparity.h>

namespace headway::detect {

/// Cells of a disparity image on regions of moving and possibly moving objects: 8-bit, non-zero.
/// Widened, because block matching widens objects by half a block.
[[nodiscard]] cv::Mat leftOutCells(const MovingRegions& moving,
                                   const stereo::DisparityImage& disparity);

}  // namespace headway::detect
