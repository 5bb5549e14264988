// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/moving_regions.h>
#include <headway/slam/slam_params.h>

#include <opencv2/core/mat.hpp>

namespace headway::slam {

/// Where nothing may be measured: the moving regions as a mask, boxes drawn full.
///
/// Unsure regions are excluded only in the mode without a geometric test.
///
/// @return  8-bit, non-zero inside a region; empty where the mode ignores regions or there is none
/// @throws  InputError if the regions' mask is not 8-bit or not of the image's size
[[nodiscard]] cv::Mat excludedMask(const MovingRegions& moving, DynamicRejection mode,
                                   const cv::Size& image_size);

/// Where landmarks must be verified static before they constrain the pose: the unsure regions, in
/// the mode with both tests.
///
/// @return  8-bit, non-zero inside a region; empty where there is none
[[nodiscard]] cv::Mat suspectMask(const MovingRegions& moving, DynamicRejection mode,
                                  const cv::Size& image_size);

}  // namespace headway::slam
