#pragma once

#include <headway/core/stereo_camera.h>

#include <vector>

#include "residual_flow.h"
#include "upright_blobs.h"

namespace headway::detect {

/// Cuts bodies out of the disparity image as uprightBlobs() does, and measures how they flow.
///
/// Besides what is clear of its surroundings, what moves differently from them is cut out: a person
/// close to a wall, or in front of others. Cells that flow to one side farther than noise makes
/// them are taken as if they were alone in the image.
///
/// @param flow  may be empty; then it is uprightBlobs()
[[nodiscard]] std::vector<UprightBlob> bodiesByFlow(const stereo::DisparityImage& disparity,
                                                    const ResidualFlow& flow,
                                                    const StereoCamera& camera,
                                                    const stereo::GroundPlane& ground,
                                                    double range_m);

}  // namespace headway::detect
