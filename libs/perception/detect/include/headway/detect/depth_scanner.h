// SPDX-License-Identifier: BSD-3-Clause
// Depth and colour of the static surfaces in a frame, on a grid.
#pragma once

#include <headway/core/moving_regions.h>
#include <headway/core/scan.h>
#include <headway/core/stereo_frame.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/rig_capability.h>

namespace headway::detect {

/// Depth and colour of the static surfaces in a frame.
///
/// Plain surfaces, of which block matching gives little, are completed by planes (PlanarDisparity).
/// Left out are regions of moving objects, depths beyond the rig's dense_to_m, and, where no plane
/// fits, the border of what stands before something farther away, or before nothing that was
/// matched: there, block matching gives the background the depth of the foreground. The grid is the
/// finest one with at most 10,000 cells, so that near surfaces do not fill the memory.
///
/// @param frame      with its camera; its colour image is used if there is one
/// @param disparity  of the frame
/// @param ground     of the frame, matched along the ground (stereo::groundDisparity): more exact
///                   where both agree, and where the other is unknown; may be empty
/// @param moving     left out, to the depth of each box; the unsure ones, too
[[nodiscard]] DepthScan scanDepth(const StereoFrame& frame, const stereo::DisparityImage& disparity,
                                  const stereo::DisparityImage& ground, const MovingRegions& moving,
                                  const stereo::RigCapability& rig);

}  // namespace headway::detect
