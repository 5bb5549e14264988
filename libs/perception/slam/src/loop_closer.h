// SPDX-License-Identifier: BSD-3-Clause
// Loop closing: search for places seen before, verification, and correction of the map.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/core/worker_thread.h>
#include <headway/slam/slam_params.h>
#include <headway/slam/stereo_slam.h>

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <vector>

#include "bundle_adjustment.h"
#include "frame_tracker.h"
#include "keypoints.h"
#include "landmark_tracker.h"
#include "place_check.h"
#include "place_recognition.h"
#include "pose_graph.h"
#include "sparse_map.h"

namespace headway::slam {

/// Disjoint sets of the numbers 0 to size - 1.
///
/// @see Tarjan 1975, "Efficiency of a good but not linear set union algorithm"
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  /// A number that all members of one set have in common.
  [[nodiscard]] std::size_t of(std::size_t at) {
    while (parent_[at] != at) at = parent_[at] = parent_[parent_[at]];
    return at;
  }
  void join(std::size_t a, std::size_t b) { parent_[of(b)] = of(a); }

 private:
  std::vector<std::size_t> parent_;
};

inline constexpr double kMaxDrift = 0.05;  ///< of a path that is closed, over its length [-]

/// A verified loop: the newest keyframe as an old one's surroundings see it.
struct ClosedLoop {
  KeyframeId newest;
  KeyframeId old;
  Pose T_old_newest = Pose::Identity();  ///< cameras
  std::vector<TrackedLandmark>
      landmarks;  ///< of the old one's surroundings, as the newest sees them
};

/// Edges of the map as it is: from each keyframe to the one before (where both share nothing
/// because the camera was lost between them, with the uncertainty of wheel odometry, or a weak one)
/// and to those that share many landmarks.
[[nodiscard]] std::vector<PoseGraphEdge> edgesOf(const std::map<KeyframeId, Keyframe>& keyframes);

/// Poses of all keyframes after loops were distributed over the pose graph; the loops' landmarks
/// are not used.
[[nodiscard]] std::map<KeyframeId, Pose> posesWithLoops(
    const std::map<KeyframeId, Keyframe>& keyframes, const std::vector<ClosedLoop>& loops,
    const StopCondition& stop = neverStop);

/// Replaces poses of keyframes and moves the landmarks of which they are the reference.
void applyCorrection(const std::map<KeyframeId, Pose>& corrected, SparseMap& map);

/// An old keyframe that may show the same place as the newest one, with what it is verified by.
struct LoopCandidate {
  LoopAttempt attempt;
  Pose T_map_newest = Pose::Identity();  ///< camera
  Pose T_map_old = Pose::Identity();     ///< camera
  std::vector<LandmarkId> among;  ///< landmarks of the old keyframe's surroundings, ascending
  double offset_allowed_m = 0.0;  ///< maximum drift between both
  double unique_within_m = 0.0;   ///< where landmarks must not repeat
};

/// Result of the background search that ended before a frame.
struct LoopProgress {
  std::vector<LoopAttempt> attempts;  ///< candidates with their outcomes
  std::optional<Pose> correction;     ///< motion of the newest keyframe, if the map was corrected
};

/// Detects loops and relocalises lost cameras, and corrects the map at loops.
///
/// close() does all of it at once. search() and advance() do it in the background: descriptors,
/// verification and pose graph run in another thread, on copies, and take several frames; only the
/// tracking thread reads and changes the map, between two frames.
class LoopCloser {
 public:
  /// @param adjuster  must outlive the closer
  LoopCloser(const StereoCamera& camera, const SlamParams& params, BundleAdjuster& adjuster);
  ~LoopCloser();
  LoopCloser(const LoopCloser&) = delete;
  LoopCloser& operator=(const LoopCloser&) = delete;

  /// Makes a keyframe findable (again).
  void index(KeyframeId keyframe, const SparseMap& map);
  void remove(KeyframeId keyframe) { index_.remove(keyframe); }

  /// Where in the whole map a frame may have been taken, without a predicted pose: places 1 m or
  /// 26 degrees apart, the most evident first; PlaceCheck accepts one or none.
  ///
  /// @param turn  tries a few keyframes only, those that are most alike in turn 0, others in the
  ///              next ones, because what stands before the camera may be like any place
  [[nodiscard]] std::vector<LocatedCamera> locate(const TrackingFrame& frame,
                                                  std::optional<int> turn,
                                                  const SparseMap& map) const;

  /// Where the camera is expected, by somebody who knows: keyframes near it that look the same way
  /// are tried first, others only if none of them fits.
  void expect(const std::optional<Pose>& T_map_cam) { expected_ = T_map_cam; }

  /// Whether a frame was taken where a place leads that was seen before, near a keyframe, which
  /// may have left the map since.
  [[nodiscard]] std::optional<LocatedCamera> locateAt(const PlaceCheck::Place& place,
                                                      const TrackingFrame& frame,
                                                      const SparseMap& map) const;

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

  /// Starts the same in the background, unless a search is running.
  void search(const TrackingFrame& frame, KeyframeId newest, const SparseMap& map);

  /// close(), or search() if the parameters demand background operation.
  std::vector<LoopAttempt> closeOrSearch(const TrackingFrame& frame, KeyframeId newest,
                                         SparseMap& map);

  /// Continues the running search if its present step is done; to be called before each frame.
  [[nodiscard]] LoopProgress advance(SparseMap& map);

  /// Waits for the running search and applies its result.
  [[nodiscard]] LoopProgress finish(SparseMap& map);

  /// Cancels the running search, because the map has moved.
  void abandon();

 private:
  static constexpr int kCorners = 1000;  ///< of a frame that is to be recognised
  static constexpr int kSpacing = 3;     ///< keyframes between two searches for a loop
  struct Search;

  [[nodiscard]] static std::vector<DescribedPoint> describe(const TrackingFrame& frame);
  /// The keyframes that are most alike, each with a view of its own, or those of a turn.
  [[nodiscard]] std::vector<KeyframeId> candidates(const std::vector<DescribedPoint>& points,
                                                   const std::function<bool(KeyframeId)>& wanted,
                                                   std::optional<int> turn,
                                                   const SparseMap& map) const;
  /// As locate(), by some keyframes; the first that is proven ends a turn.
  [[nodiscard]] std::vector<LocatedCamera> placesAmong(
      const std::function<bool(KeyframeId)>& wanted, std::optional<int> turn,
      const TrackingFrame& frame, const std::vector<DescribedPoint>& points, double within_m,
      const SparseMap& map) const;
  [[nodiscard]] std::optional<LocatedCamera> placeAt(KeyframeId keyframe,
                                                     const TrackingFrame& frame,
                                                     const std::vector<DescribedPoint>& points,
                                                     double within_m, const SparseMap& map) const;
  /// The landmarks around a keyframe as a frame measures them from a pose there.
  [[nodiscard]] std::optional<LocatedCamera> confirmed(const Pose& T_map_cam, KeyframeId keyframe,
                                                       const std::vector<LandmarkId>& among,
                                                       const TrackingFrame& frame, double within_m,
                                                       const SparseMap& map) const;
  /// Old keyframes within drift distance of the newest one or of unknown distance, ascending.
  [[nodiscard]] std::vector<KeyframeId> findLoopCandidates(KeyframeId newest,
                                                           const SparseMap& map) const;
  [[nodiscard]] bool isNearExpected(KeyframeId keyframe, const SparseMap& map) const;
  /// The keyframes that share most descriptors, best first; those near the expected place before
  /// all others.
  [[nodiscard]] std::vector<KeyframeId> mostAlike(const std::vector<DescribedPoint>& points,
                                                  const std::vector<KeyframeId>& among,
                                                  const SparseMap& map) const;
  [[nodiscard]] LoopCandidate candidateOf(KeyframeId newest, KeyframeId old,
                                          const SparseMap& map) const;
  [[nodiscard]] double allowedOffset(KeyframeId newest, KeyframeId old, const SparseMap& map) const;
  /// The loop, if the candidate passes every test; its attempt states the last test with the
  /// required and the measured value. Uses no members that change.
  [[nodiscard]] std::optional<ClosedLoop> verify(const TrackingFrame& frame,
                                                 const std::vector<DescribedPoint>& points,
                                                 LoopCandidate& candidate, SparseMap& map) const;
  void adjustAll(const ClosedLoop& loop, SparseMap& map) const;
  [[nodiscard]] bool verifyNext(const SparseMap& map);
  void startCorrection(const SparseMap& map);
  [[nodiscard]] Pose correct(SparseMap& map);
  void endSearch();

  StereoCamera camera_;
  SlamParams params_;
  BundleAdjuster& adjuster_;
  FrameTracker tracker_;
  PlaceIndex index_;
  std::optional<Pose> expected_;
  std::unique_ptr<Search> search_;
  /// Last, because its work uses the other members.
  WorkerThread worker_{WorkerThread::Priority::kBackground};
};

}  // namespace headway::slam
