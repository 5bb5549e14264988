// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/stereo/disparity.h>
#include <headway/stereo/ground_plane.h>

namespace headway::stereo {

/// Matches the ground of a stereo pair along its plane, on the grid of denseDisparity().
///
/// From one row of an image to the next, the disparity of the ground changes by b / h: within a
/// block it differs by pixels, so that block matching gives nothing for half of the ground, and for
/// the rest the disparity of one of the block's rows. Here the right image is sheared first, which
/// makes the plane's disparity zero everywhere; blocks are then matched within a few pixels of it.
///
/// @param ground  of the frame
/// @param to_m    maximum depth of the result [m]
/// @return        disparities [px of the full image] of what is within the plane's tolerance, else
///                0; all 0 for a depth camera, and where the ground is not in the image
/// @see  Gallup et al. 2007, "Real-time plane-sweeping stereo with multiple sweeping directions"
[[nodiscard]] DisparityImage groundDisparity(const StereoFrame& frame, const GroundPlane& ground,
                                             const DisparityParams& params, double to_m);

}  // namespace headway::stereo
