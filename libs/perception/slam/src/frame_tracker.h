// SPDX-License-Identifier: BSD-3-Clause
// A frame's pose in the local map, from what is static in it.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/slam/slam_params.h>
#include <headway/stereo/pose_refiner.h>

#include <optional>
#include <vector>

#include "landmark_tracker.h"
#include "sparse_map.h"

namespace headway::slam {

/// A frame's pose and its inlier landmarks.
struct TrackedPose {
  Pose T_map_cam = Pose::Identity();
  PoseCovariance covariance = PoseCovariance::Identity();  ///< given the local map
  std::vector<TrackedLandmark> landmarks;                  ///< inliers, each once
  std::vector<TrackedLandmark> dynamic_outliers;  ///< of a new map: tracked, but moving otherwise
};

/// Finds the pose of a frame in the local map.
class FrameTracker {
 public:
  FrameTracker(const StereoCamera& camera, const SlamParams& params)
      : camera_(camera), params_(params), tracker_(camera, params) {}

  /// From one frame to the next [s]; 0.1 before the first call. A landmark is verified static when
  /// it has agreed with the camera's motion for 0.2 s, and in two frames at least.
  void setInterval(double interval_s);

  /// Tracks the previous frame's landmarks, unless a pose is proposed, then measures the local map.
  ///
  /// @param proposed       by visual odometry; used if the landmarks that are verified static agree
  /// @param initial_poses  most likely first; each is tried until one succeeds
  /// @param local          landmarks that may be in view, ascending
  /// @param new_map        the submap is new: its static landmarks are not verified yet
  /// @return               nullopt if no initial pose leads to enough inliers
  [[nodiscard]] std::optional<TrackedPose> track(const TrackingFrame& previous,
                                                 const std::vector<TrackedLandmark>& seen_before,
                                                 const TrackingFrame& current,
                                                 const std::optional<Pose>& proposed,
                                                 const std::vector<Pose>& initial_poses,
                                                 const std::vector<LandmarkId>& local, bool new_map,
                                                 SparseMap& map) const;

  /// The pose that measurements of landmarks give where the landmarks are now.
  ///
  /// @param initial  good to a few pixels
  /// @return         nullopt if too few agree
  [[nodiscard]] std::optional<Pose> poseOf(const std::vector<TrackedLandmark>& seen,
                                           const Pose& initial, const SparseMap& map) const;

  /// Measures the local map from a pose that is right to a few pixels.
  ///
  /// @return  nullopt if fewer landmarks than `min_inliers` agree on a pose
  [[nodiscard]] std::optional<TrackedPose> measureLocalMap(const TrackingFrame& current,
                                                           const Pose& T_map_cam,
                                                           const std::vector<LandmarkId>& local,
                                                           SparseMap& map, int min_inliers) const;

  /// The landmarks of the previous frame that are followed into the current one: at most 160,
  /// verified static ones first, then others, each spread evenly over those seen; all where few are
  /// verified, so that the camera's motion can be found by consensus.
  [[nodiscard]] std::vector<TrackedLandmark> selectLandmarksToFollow(
      const std::vector<TrackedLandmark>& seen_before, bool new_map, const SparseMap& map) const;

 private:
  /// Whether most landmarks of the previous frame that are verified static were found again.
  [[nodiscard]] bool findsStatic(const TrackedPose& tracked,
                                 const std::vector<TrackedLandmark>& seen_before,
                                 const TrackingFrame& current, const SparseMap& map) const;
  /// A pose good to a few pixels.
  struct CoarsePose {
    Pose T_map_cam = Pose::Identity();
    std::vector<LandmarkId> static_inliers;  ///< ascending; empty: those verified static
  };

  /// Whether landmarks that contradict the camera's motion are rejected.
  [[nodiscard]] bool rejectsByGeometry() const;
  /// Whether a landmark may constrain the pose.
  [[nodiscard]] bool isStatic(const Landmark& landmark) const;
  [[nodiscard]] std::vector<bool> staticMask(const std::vector<TrackedLandmark>& landmarks,
                                             const SparseMap& map) const;
  [[nodiscard]] std::optional<CoarsePose> coarsePose(const Pose& predicted,
                                                     const std::vector<TrackedLandmark>& followed,
                                                     const TrackingFrame& current, bool new_map,
                                                     const SparseMap& map) const;
  [[nodiscard]] std::optional<CoarsePose> coarsePoseByRigidMotions(
      const Pose& predicted, const std::vector<TrackedLandmark>& followed,
      const TrackingFrame& current, bool new_map, const SparseMap& map) const;
  [[nodiscard]] std::vector<TrackedLandmark> outsideSuspectRegions(
      const std::vector<TrackedLandmark>& followed, const TrackingFrame& current) const;
  [[nodiscard]] std::optional<TrackedPose> measureFrom(const CoarsePose& coarse,
                                                       const TrackingFrame& current,
                                                       const std::vector<LandmarkId>& local,
                                                       SparseMap& map, int min_inliers) const;
  [[nodiscard]] std::optional<stereo::RefinedPose> refineByStaticInliers(
      const Pose& predicted, std::vector<stereo::PoseConstraint>& constraints,
      const std::vector<bool>& is_static) const;
  [[nodiscard]] std::vector<stereo::PoseConstraint> constraintsOf(
      const std::vector<TrackedLandmark>& landmarks, const SparseMap& map) const;

  StereoCamera camera_;
  SlamParams params_;
  LandmarkTracker tracker_;
  static constexpr int kMinFramesToVerify = 2;  ///< one observation confirms nothing
  int frames_to_verify_ = kMinFramesToVerify;
};

}  // namespace headway::slam
