// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/slam/slam_params.h>

#include <vector>

#include "bundle_adjuster.h"
#include "keyframe_odometry.h"
#include "keypoints.h"
#include "landmark_tracker.h"
#include "sparse_map.h"

namespace headway::slam {

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

}  // namespace headway::slam
