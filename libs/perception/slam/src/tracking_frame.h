// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/moving_regions.h>
#include <headway/slam/slam_params.h>
#include <headway/stereo/frame_context.h>

#include "keypoints.h"

namespace headway::slam {

/// One frame, prepared for tracking.
struct TrackingFrame {
  std::size_t index = 0;
  Time time = 0.0;  ///< [s]
  stereo::ImagePyramid left;
  stereo::SecondView right;
  cv::Mat excluded;  ///< 8-bit, non-zero where nothing may be measured; may be empty
  cv::Mat suspect;   ///< 8-bit, non-zero where landmarks must be verified first; may be empty
  FeatureGrid grid;  ///< about params.features cells outside of the excluded regions
};

/// Pyramids of both images, contrast-stretched in poor light, and the masks.
///
/// @throws InputError if an image is not 8-bit grey and of the camera's size, or the regions' mask
///         is not
[[nodiscard]] TrackingFrame makeTrackingFrame(const stereo::FrameContext& context,
                                              const MovingRegions& moving,
                                              const StereoCamera& camera, const SlamParams& params);

}  // namespace headway::slam
