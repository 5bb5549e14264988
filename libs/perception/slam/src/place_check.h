// SPDX-License-Identifier: BSD-3-Clause
// Whether a frame shows the place that it was recognised as.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/stereo/stereo_match.h>

#include <optional>
#include <vector>

#include "frame_tracker.h"
#include "landmark_tracker.h"
#include "sparse_map.h"

namespace headway::slam {

/// What a frame says for a place, in cells of 1/16 of the image's width.
///
/// A cell counts for it where landmarks are found that the map has nowhere else, and against it
/// where some ought to be seen, nothing nearer stands before them, and none is found: of a place
/// that looks alike in part, the rest is missing, of a place behind people, nothing is. A floor or
/// racks that come again say nothing of the place, even if the right one is not in the map.
///
/// @param seen      the pose there with its landmarks
/// @param expected  landmarks that are seen from there
/// @param within_m  how far off the place may be, beyond which it may look the same [m]
[[nodiscard]] int evidenceOf(const TrackedPose& seen, const std::vector<LandmarkId>& expected,
                             const TrackingFrame& frame, const SparseMap& map,
                             const StereoCamera& camera, const stereo::StereoMatcher& matcher,
                             double within_m);

/// Evidence that no wrong place gives: such a place is believed at once.
inline constexpr int kPlaceProof = 40;

/// Believes a pose to which no odometry leads: at once if the frame proves it, else when the same
/// place was seen for 0.2 s with half of a proof in each frame, 2 s apart at most, each time where
/// odometry has led since, and all frames together prove it.
class PlaceCheck {
 public:
  /// Takes the pose of a frame; true if it may be believed.
  ///
  /// @param evidence    as evidenceOf(), less that of the place that is alike most
  /// @param T_odom_cam  of the same frame; it may drift, and be off by 1.5 m/s and 2 rad/s where
  ///                    most of the view moves
  [[nodiscard]] bool add(Time time, int evidence, const Pose& T_map_cam, const Pose& T_odom_cam);
  void restart() { before_.reset(); }

 private:
  struct Observation {
    Time since = 0.0;  ///< the place was seen first
    Time time = 0.0;   ///< and last
    int evidence = 0;  ///< of all its frames
    Pose T_map_odom = Pose::Identity();
  };
  /// Whether a pose is where odometry has led since the place was seen last.
  [[nodiscard]] bool agrees(Time time, const Pose& T_map_cam, const Pose& T_odom_cam) const;

  std::optional<Observation> before_;
};

}  // namespace headway::slam
