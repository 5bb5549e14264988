#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/slam/slam_params.h>
#include <headway/slam/stereo_slam.h>

#include <optional>
#include <vector>

#include "bundle_adjuster.h"
#include "frame_tracker.h"
#include "place_index.h"
#include "pose_graph.h"
#include "sparse_map.h"

namespace headway::slam {

/// Detects loops and relocalises lost cameras, and corrects the map at loops.
class LoopCloser {
 public:
  /// @param adjuster  must outlive the closer
  LoopCloser(const StereoCamera& camera, const SlamParams& params, BundleAdjuster& adjuster)
      : camera_(camera), params_(params), adjuster_(adjuster), tracker_(camera, params) {}

  /// Makes a keyframe findable (again).
  void index(KeyframeId keyframe, const SparseMap& map);
  void remove(KeyframeId keyframe) { index_.remove(keyframe); }

  /// Relocalises a frame in the whole map, without a predicted pose.
  ///
  /// @param keyframe  set to the keyframe that it was recognised by
  [[nodiscard]] std::optional<TrackedPose> locate(const TrackingFrame& frame, SparseMap& map,
                                                  KeyframeId* keyframe) const;

  /// Searches for a loop at a new keyframe and, where one is verified, corrects the whole map.
  ///
  /// The place must be out of the keyframe's neighbourhood, not farther off than drift explains (of
  /// a part of the map that nothing ties to this one, any distance is believed), recognised by
  /// descriptors, and confirmed by patches of its landmarks measured in this frame. Pose graph
  /// first, then a bundle adjustment of the whole map.
  ///
  /// @return the candidates with their outcomes; none if no old keyframe is near
  [[nodiscard]] std::vector<LoopAttempt> close(const TrackingFrame& frame, KeyframeId newest,
                                               SparseMap& map) const;

 private:
  /// Old keyframes within drift distance of the newest one or of unknown distance, ascending.
  [[nodiscard]] std::vector<KeyframeId> findLoopCandidates(KeyframeId newest,
                                                           const SparseMap& map) const;
  /// The new keyframe's pose as the candidate's surroundings see it, if they pass every test;
  /// says in `attempt` which was passed last, with what was needed and what there was.
  [[nodiscard]] std::optional<TrackedPose> verify(const TrackingFrame& frame,
                                                  const std::vector<DescribedPoint>& points,
                                                  LoopAttempt& attempt, SparseMap& map) const;
  void measureOffset(const TrackedPose& seen_from, const SparseMap& map,
                     LoopAttempt& attempt) const;
  void correct(KeyframeId newest, KeyframeId old, const TrackedPose& seen_from,
               SparseMap& map) const;

  StereoCamera camera_;
  SlamParams params_;
  BundleAdjuster& adjuster_;
  FrameTracker tracker_;
  PlaceIndex index_;
};

/// Replaces the keyframes' poses and moves landmarks with their reference keyframes.
void applyCorrection(const std::map<KeyframeId, Pose>& corrected, SparseMap& map);

/// Edges of the map as it is: from each keyframe to the one before (a weak one, where both share
/// nothing because the camera was lost between them) and to those that share many landmarks.
[[nodiscard]] std::vector<PoseGraphEdge> edgesOf(const SparseMap& map);

}  // namespace headway::slam
