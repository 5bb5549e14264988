// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/core/worker_thread.h>
#include <headway/stereo/disparity_offset.h>

#include <memory>
#include <optional>
#include <vector>

#include "sparse_map.h"

namespace headway::slam {

/// What a bundle adjustment did.
struct BundleSummary {
  int iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  std::optional<stereo::OffsetEstimate> free_offset;  ///< as of BundleSolution
  int outliers = 0;                    ///< observations that did not fit and were removed
  Pose correction = Pose::Identity();  ///< by which the newest part of the map was moved
};

/// A bundle adjustment on copies of poses and landmarks, so that it can run in another thread while
/// the map is used and extended.
class DetachedBundle {
 public:
  /// @param free  keyframes to adjust, ascending; see adjustBundle
  DetachedBundle(const SparseMap& map, const std::vector<KeyframeId>& free,
                 const StereoCamera& camera);
  ~DetachedBundle();

  /// Touches nothing outside of this object.
  ///
  /// @param stop  as stop()
  void solve(int max_iterations, const StopCondition& stop = neverStop);

  /// Cancels the solve after its present iteration; callable from any thread.
  void stop();

  /// Applies the solution to the map and removes outlier observations. Keyframes added meanwhile
  /// are moved with the newest one that took part.
  BundleSummary writeBack(SparseMap& map) const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Adjusts keyframes and the landmarks that they see to all their measurements.
///
/// Keyframes outside `free` that see the same landmarks take part but stay where they are; if
/// there is none, the oldest of `free` stays. Landmarks are eliminated first (Schur complement),
/// so the cost grows with the keyframes. Outlier observations are removed afterwards.
///
/// @param stop  ends it early without a correction
/// @see Triggs et al. 2000, "Bundle adjustment: a modern synthesis", sec. 6
BundleSummary adjustBundle(SparseMap& map, const std::vector<KeyframeId>& free,
                           const StereoCamera& camera, int max_iterations,
                           const StopCondition& stop = neverStop);

}  // namespace headway::slam
