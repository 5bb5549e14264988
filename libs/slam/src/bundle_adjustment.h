#pragma once

#include <headway/core/stereo_camera.h>

#include <vector>

#include "sparse_map.h"

namespace headway::slam {

/// What a bundle adjustment did.
struct BundleSummary {
  int iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  int outliers = 0;  ///< observations that did not fit and were forgotten
};

/// Adjusts keyframes and the landmarks that they see to all their measurements.
///
/// Keyframes outside `free` that see the same landmarks take part but stay where they are; if
/// there is none, the oldest of `free` stays. Landmarks are eliminated first (Schur complement),
/// so the cost grows with the keyframes. Observations that do not fit afterwards are forgotten.
///
/// @see Triggs et al. 2000, "Bundle adjustment: a modern synthesis", sec. 6
BundleSummary adjustBundle(SparseMap& map, const std::vector<KeyframeId>& free,
                           const StereoCamera& camera, int max_iterations);

}  // namespace headway::slam
