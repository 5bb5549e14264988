#pragma once

#include <headway/core/stereo_camera.h>

#include <optional>
#include <vector>

#include "descriptor.h"
#include "frame_tracker.h"
#include "sparse_map.h"

namespace headway::slam {

/// The pose of a frame of which nothing is known but its image: corners are recognised by their
/// descriptors among the given landmarks, and a consensus of them gives the pose.
///
/// @param points       corners of the frame
/// @param among        landmarks to look for, ascending
/// @param min_inliers  landmarks that must agree
/// @return             pose good to a few pixels; nullopt if too few landmarks agree
[[nodiscard]] std::optional<Pose> relocalise(const std::vector<DescribedPoint>& points,
                                             const std::vector<LandmarkId>& among,
                                             const SparseMap& map, const StereoCamera& camera,
                                             int min_inliers);

}  // namespace headway::slam
