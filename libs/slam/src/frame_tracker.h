#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/slam/slam_params.h>
#include <headway/stereo/pose_refiner.h>

#include <optional>
#include <vector>

#include "landmark_tracker.h"
#include "sparse_map.h"

namespace headway::slam {

/// A frame's pose and the landmarks that it rests on.
struct TrackedPose {
  Pose T_map_cam = Pose::Identity();
  PoseCovariance covariance = PoseCovariance::Identity();  ///< given the local map
  std::vector<TrackedLandmark> landmarks;                  ///< inliers, each once
  std::vector<TrackedLandmark> dissenters;  ///< of a young map: followed, but moved otherwise
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
  /// @param young    the map has just begun: what stands still in it is not yet settled
  /// @return         nullopt if no guess leads to a pose that enough landmarks agree on
  [[nodiscard]] std::optional<TrackedPose> track(const TrackingFrame& previous,
                                                 const std::vector<TrackedLandmark>& seen_before,
                                                 const TrackingFrame& current,
                                                 const std::vector<Pose>& guesses,
                                                 const std::vector<LandmarkId>& local, bool young,
                                                 SparseMap& map) const;

  /// Measures the local map from a pose that is right to a few pixels.
  ///
  /// @return  nullopt if fewer landmarks than `min_inliers` agree on a pose
  [[nodiscard]] std::optional<TrackedPose> settle(const TrackingFrame& current,
                                                  const Pose& T_map_cam,
                                                  const std::vector<LandmarkId>& local,
                                                  SparseMap& map, int min_inliers) const;

 private:
  /// A pose good to a few pixels.
  struct CoarsePose {
    Pose T_map_cam = Pose::Identity();
    std::vector<LandmarkId> witnesses;  ///< that it rests on, ascending; none: what proved still
  };

  /// Whether what contradicts the camera's motion is kept out.
  [[nodiscard]] bool testsMotion() const;
  /// Whether a landmark may have a say in the camera's motion.
  [[nodiscard]] bool vouches(const Landmark& landmark) const;
  [[nodiscard]] std::vector<bool> provedStill(const std::vector<TrackedLandmark>& landmarks,
                                              const SparseMap& map) const;
  [[nodiscard]] std::vector<TrackedLandmark> worthFollowing(
      const std::vector<TrackedLandmark>& seen_before, bool young, const SparseMap& map) const;
  [[nodiscard]] std::optional<CoarsePose> coarsePose(const Pose& guess,
                                                     const std::vector<TrackedLandmark>& followed,
                                                     const TrackingFrame& current, bool young,
                                                     const SparseMap& map) const;
  [[nodiscard]] std::optional<CoarsePose> stillMotion(const Pose& guess,
                                                      const std::vector<TrackedLandmark>& followed,
                                                      const TrackingFrame& current, bool young,
                                                      const SparseMap& map) const;
  [[nodiscard]] std::vector<TrackedLandmark> withoutSuspects(
      const std::vector<TrackedLandmark>& followed, const TrackingFrame& current) const;
  [[nodiscard]] std::optional<TrackedPose> measureFrom(const CoarsePose& coarse,
                                                       const TrackingFrame& current,
                                                       const std::vector<LandmarkId>& local,
                                                       SparseMap& map, int min_inliers) const;
  [[nodiscard]] std::optional<stereo::RefinedPose> refineByWitnesses(
      const Pose& guess, std::vector<stereo::PoseConstraint>& constraints,
      const std::vector<bool>& is_witness) const;
  [[nodiscard]] std::vector<stereo::PoseConstraint> constraintsOf(
      const std::vector<TrackedLandmark>& landmarks, const SparseMap& map) const;

  StereoCamera camera_;
  SlamParams params_;
  LandmarkTracker tracker_;
};

}  // namespace headway::slam
