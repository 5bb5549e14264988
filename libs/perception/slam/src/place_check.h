// SPDX-License-Identifier: BSD-3-Clause
// Whether a frame shows the place that it was recognised as.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/slam/slam_params.h>

#include <optional>
#include <set>
#include <vector>

#include "frame_tracker.h"
#include "landmark_tracker.h"
#include "sparse_map.h"

namespace headway::slam {

/// What a frame says for a place, in cells of 1/16 of the image's width.
struct PlaceEvidence {
  /// Of each cell that counts for the place or against it, the landmarks that are found or missed.
  std::vector<std::vector<LandmarkId>> found, missed;

  /// Cells for it less those against it.
  [[nodiscard]] int sum() const {
    return static_cast<int>(found.size()) - static_cast<int>(missed.size());
  }
  /// The sum in which what is missed counts double.
  [[nodiscard]] int proof() const { return sum() - static_cast<int>(missed.size()); }
};

/// Whether a camera that rides as high over the ground as ever can have got from the nearest
/// keyframe to a place, on ground that tilts between both as it does at them: racks look the same
/// one shelf higher up.
///
/// @param up   away from the ground, camera frame
/// @param map  with a keyframe, at least
[[nodiscard]] bool standsOnGround(const Pose& T_map_cam, const Eigen::Vector3d& up,
                                  const SparseMap& map);

/// A cell counts for a place where most landmarks are found that ought to be seen and that nothing
/// nearer stands before, and some that the map has nowhere else; against it where most are not, and
/// nothing stands before any: of a place that looks alike, two thirds are missing, of a place
/// behind people, few are. A floor or racks that come again say nothing of the place, even if the
/// right one is not in the map.
///
/// @param seen      the pose there with its landmarks
/// @param among     landmarks around: those are expected that the keyframe sees which sees most of
///                  what is seen
/// @param within_m  how far off the place may be, beyond which it may look the same [m]
[[nodiscard]] PlaceEvidence evidenceOf(const TrackedPose& seen,
                                       const std::vector<LandmarkId>& among,
                                       const TrackingFrame& frame, const SparseMap& map,
                                       const StereoCamera& camera, const SlamParams& params,
                                       double within_m);

/// Evidence that no wrong place gives: such a place is accepted at once.
inline constexpr int kPlaceProof = 20;

/// Where a frame may have been taken.
struct LocatedCamera {
  TrackedPose tracked;
  KeyframeId keyframe;  ///< that it was recognised by
  PlaceEvidence evidence;
};

/// Whether odometry, which may drift, and be off by 1.5 m/s and 2 rad/s where most of the view
/// moves, allows a pose some time after the one from which it leads to another.
[[nodiscard]] bool isAllowed(const Pose& T_map_cam, const Pose& T_map_led, double seconds);

/// Accepts a pose to which no odometry leads: at once if the frame proves it, else when the same
/// place was seen for 0.2 s, 2 s apart at most, each time where odometry has led since, and all
/// frames together prove it. In their sum no landmark counts twice, because who stands and looks at
/// the same part of a place learns nothing of the rest. What is missed counts double, but once in
/// the sum of any other place, which is taken off.
class PlaceCheck {
 public:
  struct Place {
    Pose T_map_cam = Pose::Identity();
    KeyframeId keyframe;
  };
  /// Where the camera is if the place of which most has been seen is the right one.
  [[nodiscard]] std::optional<Place> likeliest(Time time, const Pose& T_odom_cam);

  /// Takes all places where a frame may have been taken; the one that is accepted, if any.
  ///
  /// @param T_odom_cam  of the same frame
  [[nodiscard]] const LocatedCamera* add(Time time, const std::vector<LocatedCamera>& places,
                                         const Pose& T_odom_cam);
  void restart() { seen_.clear(); }

 private:
  /// A place that was seen.
  struct Seen {
    Time since = 0.0;  ///< first
    Time time = 0.0;   ///< last
    Pose T_map_odom = Pose::Identity();
    KeyframeId keyframe;
    int found = 0, missed = 0;     ///< cells, of all its frames
    std::set<LandmarkId> counted;  ///< in them

    // Of a place that is alike, more is missed than found, of the right one a third at most,
    // whatever stands before it.
    [[nodiscard]] int evidence() const { return found - 2 * missed; }
    [[nodiscard]] int likeness() const { return found - missed; }
  };
  void removeOld(Time time);
  /// Adds a frame to the place that it shows; its index in seen_.
  [[nodiscard]] std::size_t addTo(Time time, const LocatedCamera& located, const Pose& T_odom_cam);

  std::vector<Seen> seen_;
};

}  // namespace headway::slam
