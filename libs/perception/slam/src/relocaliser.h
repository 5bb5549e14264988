// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <optional>
#include <vector>

#include "descriptor.h"
#include "frame_tracker.h"
#include "sparse_map.h"

namespace headway::slam {

/// Result of recognising a frame by its descriptors.
struct Recognition {
  std::optional<Pose> T_map_cam;  ///< good to a few pixels; nullopt if too few agree
  int inliers = 0;                ///< descriptors that agree on a pose
};

/// The pose of a frame of which nothing is known but its image: corners are recognised by their
/// descriptors among the given landmarks, and a consensus of them gives the pose.
///
/// @param points       corners of the frame
/// @param among        landmarks to search for, ascending
/// @param min_inliers  landmarks that must agree
[[nodiscard]] Recognition relocalise(const std::vector<DescribedPoint>& points,
                                     const std::vector<LandmarkId>& among, const SparseMap& map,
                                     const StereoCamera& camera, int min_inliers);

}  // namespace headway::slam
