// SPDX-License-Identifier: BSD-3-Clause
// Local mapping: where a keyframe is chosen, landmarks are created, and both are culled.
#pragma once

#include <headway/core/ids.h>
#include <headway/core/statistics.h>
#include <headway/core/stereo_camera.h>
#include <headway/slam/slam_params.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "bundle_adjustment.h"
#include "keypoints.h"
#include "landmark_tracker.h"
#include "sparse_map.h"
#include "wheel_odometry.h"

namespace headway::slam {

/// The keyframe that a tracked frame belongs to, and from which the next frame is tracked.
///
/// That is the one before as long as the frame shows most of its landmarks, about where it saw
/// them. Else it is an older keyframe that saw the place from about here, if the frame finds as
/// many landmarks as that did, be they its own or those of other times: so a place that is passed
/// again needs no new keyframes. Without mapping, where no keyframe can be made, it is the nearest
/// that there is.
///
/// @param before       keyframe that the frame before belonged to
/// @param image_width  [px]
/// @return             nullopt if the frame is to become a keyframe itself
[[nodiscard]] std::optional<KeyframeId> referenceOf(const std::vector<TrackedLandmark>& landmarks,
                                                    KeyframeId before, const SlamParams& params,
                                                    int image_width, const SparseMap& map);

/// Extends the map by keyframes and keeps its newest part adjusted and clean.
class LocalMapper {
 public:
  /// @param adjuster  must outlive the mapper
  LocalMapper(const StereoCamera& camera, const SlamParams& params, BundleAdjuster& adjuster);

  /// Makes a keyframe of a tracked frame: links what it sees, adds landmarks where the image has
  /// none, adjusts the neighbourhood, and removes landmarks that are not found again.
  ///
  /// @param submap   that the keyframe belongs to
  /// @param tracked  inliers of this frame; gets the new landmarks and loses removed ones
  /// @return         id of the keyframe, whose pose is the corrected one of the frame
  KeyframeId insert(const TrackingFrame& frame, const Pose& T_map_cam,
                    const PoseCovariance& covariance, int submap,
                    std::vector<TrackedLandmark>& tracked, SparseMap& map);

  /// Adds the motion since the frame before to the odometry that the next keyframe gets.
  void addOdometry(const MotionPrior& prior) { odometry_.add(prior); }

 private:
  void linkTracked(const TrackingFrame& frame, KeyframeId keyframe,
                   const std::vector<TrackedLandmark>& tracked, SparseMap& map) const;
  void addLandmarks(const TrackingFrame& frame, KeyframeId keyframe,
                    std::vector<TrackedLandmark>& tracked, SparseMap& map) const;
  void describeNew(const TrackingFrame& frame, KeyframeId keyframe,
                   const std::vector<TrackedLandmark>& tracked, SparseMap& map) const;

  StereoCamera camera_;
  SlamParams params_;
  BundleAdjuster& adjuster_;
  stereo::StereoMatcher matcher_;
  KeyframeOdometry odometry_;  ///< since the last keyframe
};

/// Removes landmarks around the newest keyframe that are rarely found, and those that only one
/// keyframe outside of the window observes.
///
/// @param window  newest keyframes whose landmarks may still be seen a second time
void cullLandmarks(KeyframeId newest, int window, SparseMap& map);

/// A keyframe near the newest one, but older than the `window` newest ones, that is redundant:
/// nearly all of its landmarks are observed by several others from as near.
///
/// So a place that is passed again and again keeps a bounded number of keyframes, while one that
/// is passed once keeps what it has. The first keyframe, which holds the map in place, stays.
///
/// @return nullopt if there is none
/// @see Mur-Artal & Tardos 2015, sec. VI-E (survival of the fittest)
[[nodiscard]] std::optional<KeyframeId> redundantKeyframe(KeyframeId newest, int window,
                                                          const SparseMap& map);

/// The keyframe that frames anchored to `keyframe` are reassigned to when it is removed: the one
/// that shares most landmarks with it, or else the first one.
[[nodiscard]] KeyframeId replacementKeyframe(KeyframeId keyframe, const SparseMap& map);

/// Age of the submap that was initialised last, at a predicted pose.
///
/// There is none before the first initialisation, or after relocalisation in an older submap.
class ActiveSubmap {
 public:
  void initialise(KeyframeId first) {
    first_ = first;
    frames_ = 0;
    tracked_s_ = 0.0;
  }
  /// A frame was tracked, so long after the frame before [s].
  void addTracked(double seconds) {
    ++frames_;
    tracked_s_ += seconds;
  }
  /// The camera was relocalised at a keyframe, which may belong to an older submap.
  void relocaliseAt(KeyframeId recognised) {
    if (recognised < first_) first_ = KeyframeId{};
  }

  /// First keyframe; invalid if there is no active submap.
  [[nodiscard]] KeyframeId first() const { return first_; }

  /// Whether its static landmarks may still be reassigned: for 0.8 s, in which a walking person has
  /// left their place, and two frames at least.
  [[nodiscard]] bool isNew(const FrameRate& rate) const {
    constexpr double kNew_s = 0.8;
    return first_.valid() && (frames_ < 2 || !rate.isOver(tracked_s_, kNew_s));
  }

  /// Whether the camera has been lost for so long that a new submap is initialised: longer than it
  /// was tracked in this one, since a submap lost right after its initialisation may be wrong, or
  /// than a submap that is not new may be lost; and in two frames at least.
  ///
  /// @param restart_after_s  of a submap that is not new
  [[nodiscard]] bool isOver(int lost_frames, double lost_s, double restart_after_s,
                            const FrameRate& rate) const {
    const double interval = rate.interval();
    const double max_s =
        first_.valid() ? std::min(restart_after_s, tracked_s_ + interval) : restart_after_s;
    return lost_frames > 1 && rate.isOver(lost_s, max_s + interval);
  }

 private:
  KeyframeId first_;
  int frames_ = 0;          ///< tracked ones
  double tracked_s_ = 0.0;  ///< of them
};

}  // namespace headway::slam
