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

/// Recognises places seen long before and pulls the map together there.
class LoopCloser {
 public:
  /// @param adjuster  must outlive the closer
  LoopCloser(const StereoCamera& camera, const SlamParams& params, BundleAdjuster& adjuster)
      : camera_(camera), params_(params), adjuster_(adjuster), tracker_(camera, params) {}

  /// Makes a keyframe findable (again).
  void index(KeyframeId keyframe, const SparseMap& map);
  void remove(KeyframeId keyframe) { index_.remove(keyframe); }

  /// Where a frame without any guess of its pose is, over the whole map.
  ///
  /// @param keyframe  set to the keyframe that it was recognised by
  [[nodiscard]] std::optional<TrackedPose> locate(const TrackingFrame& frame, SparseMap& map,
                                                  KeyframeId* keyframe) const;

  /// Looks whether a new keyframe shows a place of old, and if so corrects the whole map.
  ///
  /// The place must be out of the keyframe's neighbourhood, not farther off than drift explains (of
  /// a part of the map that nothing ties to this one, any distance is believed), recognised by
  /// descriptors, and confirmed by patches of its landmarks measured in this frame. Pose graph
  /// first, then a bundle adjustment of the whole map.
  ///
  /// @return what was looked at and why it was or was not taken; none if no old place is near
  [[nodiscard]] std::vector<LoopAttempt> close(const TrackingFrame& frame, KeyframeId newest,
                                               SparseMap& map) const;

 private:
  /// Keyframes of old that may show the same place, going by where they are if that is known,
  /// ascending.
  [[nodiscard]] std::vector<KeyframeId> withinDrift(KeyframeId newest, const SparseMap& map) const;
  /// The new keyframe's pose as the candidate's surroundings see it, if they pass every test;
  /// says in `attempt` which was passed last, with what was needed and what there was.
  [[nodiscard]] std::optional<TrackedPose> look(const TrackingFrame& frame,
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

/// Every keyframe's pose changes, and landmarks go with their reference keyframes.
void applyCorrection(const std::map<KeyframeId, Pose>& corrected, SparseMap& map);

/// Edges of the map as it is: from each keyframe to the one before (a weak one, where both share
/// nothing because the camera was lost between them) and to those that share many landmarks.
[[nodiscard]] std::vector<PoseGraphEdge> edgesOf(const SparseMap& map);

}  // namespace headway::slam
