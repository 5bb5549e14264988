#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/slam/slam_params.h>

#include <optional>
#include <vector>

#include "landmark_tracker.h"
#include "pose_refiner.h"
#include "sparse_map.h"

namespace headway::slam {

/// A frame's pose and the landmarks that it rests on.
struct TrackedPose {
  Pose T_map_cam = Pose::Identity();
  PoseCovariance covariance = PoseCovariance::Identity();  ///< given the local map
  std::vector<TrackedLandmark> landmarks;                  ///< inliers, each once
};

/// Finds the pose of a frame in the local map.
class FrameTracker {
 public:
  FrameTracker(const StereoCamera& camera, const SlamParams& params)
      : camera_(camera), params_(params), tracker_(camera, params) {}

  /// Follows the previous frame's landmarks, then measures the local map.
  ///
  /// @param guesses  poses to begin from, the likeliest first; each is tried until one works
  /// @param local    landmarks that may be in view, ascending
  /// @return         nullopt if no guess leads to a pose that enough landmarks agree on
  [[nodiscard]] std::optional<TrackedPose> track(const TrackingFrame& previous,
                                                 const std::vector<TrackedLandmark>& seen_before,
                                                 const TrackingFrame& current,
                                                 const std::vector<Pose>& guesses,
                                                 const std::vector<LandmarkId>& local,
                                                 SparseMap& map) const;

  /// Measures the local map from a pose that is right to a few pixels.
  [[nodiscard]] std::optional<TrackedPose> settle(const TrackingFrame& current,
                                                  const Pose& T_map_cam,
                                                  const std::vector<LandmarkId>& local,
                                                  SparseMap& map) const;

 private:
  [[nodiscard]] std::vector<PoseConstraint> constraintsOf(
      const std::vector<TrackedLandmark>& landmarks, const SparseMap& map) const;
  [[nodiscard]] std::optional<RefinedPose> refineBySeniority(
      const Pose& guess, const std::vector<TrackedLandmark>& landmarks,
      std::vector<PoseConstraint>& constraints, const PoseRefinerOptions& options,
      const SparseMap& map) const;
  [[nodiscard]] std::optional<Pose> poseFromFollowed(const Pose& guess,
                                                     const std::vector<TrackedLandmark>& followed,
                                                     const SparseMap& map) const;

  StereoCamera camera_;
  SlamParams params_;
  LandmarkTracker tracker_;
};

/// A pose from landmarks of which many may be wrong, without a guess.
///
/// RANSAC with a fixed seed over three-point solutions, left image alone.
///
/// @param max_error_px  farthest that an agreeing landmark may lie from where it was seen
/// @return nullopt if fewer than `min_inliers` landmarks agree on any pose
/// @see Fischler & Bolles 1981; Lepetit et al. 2009 (EPnP)
[[nodiscard]] std::optional<Pose> poseByConsensus(const std::vector<PoseConstraint>& constraints,
                                                  const StereoCamera& camera, int min_inliers,
                                                  double max_error_px);

}  // namespace headway::slam
