// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <vector>

#include "residual_flow.h"
#include "upright_segments.h"

namespace headway::detect {

/// Segments the disparity image as uprightSegments() does and measures the flow of each segment.
///
/// Cells that flow to one side significantly are segmented once more without the others, so that
/// a person close to a wall, or in front of others, becomes a segment of its own.
///
/// @param flow  may be empty: uprightSegments() alone
[[nodiscard]] std::vector<UprightSegment> segmentsByFlow(const stereo::DisparityImage& disparity,
                                                         const ResidualFlow& flow,
                                                         const StereoCamera& camera,
                                                         const stereo::GroundPlane& ground,
                                                         double range_m);

}  // namespace headway::detect
