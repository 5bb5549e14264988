// SPDX-License-Identifier: BSD-3-Clause
// Bundle adjustment: which keyframes and landmarks take part, in the tracking thread or in the
// background, and how the solution enters the map.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/core/worker_thread.h>
#include <headway/stereo/rectification.h>

#include <future>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "sparse_map.h"

namespace headway::slam {

/// What a bundle adjustment did.
struct BundleSummary {
  int iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  std::optional<stereo::OffsetEstimate> free_offset;  ///< as of BundleSolution
  int outliers = 0;                    ///< observations that did not fit and were removed
  Pose correction = Pose::Identity();  ///< by which the newest part of the map was moved
};

/// A bundle adjustment on copies of poses and landmarks, so that it can run in another thread while
/// the map is used and extended.
class DetachedBundle {
 public:
  /// @param free  keyframes to adjust, ascending; see adjustBundle
  DetachedBundle(const SparseMap& map, const std::vector<KeyframeId>& free,
                 const StereoCamera& camera);
  ~DetachedBundle();

  /// Touches nothing outside of this object.
  ///
  /// @param stop  as stop()
  void solve(int max_iterations, const StopCondition& stop = neverStop);

  /// Cancels the solve after its present iteration; callable from any thread.
  void stop();

  /// Applies the solution to the map and removes outlier observations. Keyframes added meanwhile
  /// are moved with the newest one that took part.
  BundleSummary writeBack(SparseMap& map) const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Adjusts keyframes and the landmarks that they see to all their measurements.
///
/// Keyframes outside `free` that see the same landmarks take part but stay where they are; if
/// there is none, the oldest of `free` stays. Landmarks are eliminated first (Schur complement),
/// so the cost grows with the keyframes. Outlier observations are removed afterwards.
///
/// @param stop  ends it early without a correction
/// @see Triggs et al. 2000, "Bundle adjustment: a modern synthesis", sec. 6
BundleSummary adjustBundle(SparseMap& map, const std::vector<KeyframeId>& free,
                           const StereoCamera& camera, int max_iterations,
                           const StopCondition& stop = neverStop);

/// Runs bundle adjustments, at once or in a thread of its own, on what frames leave of the
/// processors.
///
/// Only the solver runs in that thread, on copies: the map is read and written by the calling
/// thread alone. At once is deterministic; in the background results depend on timing.
class BundleAdjuster {
 public:
  /// @param stop  ends adjustments early
  BundleAdjuster(const StereoCamera& camera, bool in_background, StopCondition stop = neverStop)
      : camera_(camera), in_background_(in_background), stop_(std::move(stop)) {}
  ~BundleAdjuster() { abandon(); }

  /// Adjusts a neighbourhood. In the background, where one is still being adjusted, this one is
  /// left out: the next keyframe's covers most of it.
  void adjust(SparseMap& map, const std::vector<KeyframeId>& free, int max_iterations);

  /// What the latest adjustment tells about the disparities' offset, once; nullopt: nothing new.
  [[nodiscard]] std::optional<stereo::OffsetEstimate> takeFreeOffset() {
    return std::exchange(free_offset_, std::nullopt);
  }

  /// While held, background adjustments are left out, because the map must not move.
  void hold(bool held) { held_ = held; }

  /// The camera is mounted otherwise; after abandon().
  void remount(const Pose& T_robot_cam) { camera_.T_robot_cam = T_robot_cam; }

  /// Cancels the running adjustment, because the map has changed.
  void abandon();

  /// Applies a finished background adjustment to the map.
  ///
  /// @return  the motion of the newest keyframe; nullopt if no adjustment has finished
  std::optional<Pose> applyFinished(SparseMap& map);

  /// The same after waiting for what is under way.
  std::optional<Pose> finish(SparseMap& map);

 private:
  struct Job {
    DetachedBundle bundle;
    std::future<void> solved;
    Job(const SparseMap& map, const std::vector<KeyframeId>& free, const StereoCamera& camera)
        : bundle(map, free, camera) {}
  };

  StereoCamera camera_;
  bool in_background_ = false;
  StopCondition stop_;
  bool held_ = false;
  std::optional<stereo::OffsetEstimate> free_offset_;
  std::unique_ptr<Job> job_;
  std::vector<std::unique_ptr<Job>> abandoned_;  ///< cancelled, not yet ended
  WorkerThread solver_{WorkerThread::Priority::kBackground};  ///< last, because it uses the jobs
};

}  // namespace headway::slam
