// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <future>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bundle_adjustment.h"
#include "sparse_map.h"

namespace headway::slam {

/// Runs bundle adjustments, at once or in a thread of its own beside the tracking.
///
/// Only the solver runs in that thread, on copies: the map is read and written by the calling
/// thread alone. At once is deterministic; in the background results depend on timing.
class BundleAdjuster {
 public:
  /// @param stop  ends adjustments early
  BundleAdjuster(const StereoCamera& camera, bool in_background, StopCondition stop = neverStop)
      : camera_(camera), in_background_(in_background), stop_(std::move(stop)) {}

  /// Adjusts a neighbourhood. In the background, where one is still being adjusted, this one is
  /// left out: the next keyframe's covers most of it.
  void adjust(SparseMap& map, const std::vector<KeyframeId>& free, int max_iterations);

  /// What the latest adjustment tells about the disparities' offset, once; nullopt: nothing new.
  [[nodiscard]] std::optional<stereo::OffsetEstimate> takeFreeOffset() {
    return std::exchange(free_offset_, std::nullopt);
  }

  /// While held, background adjustments are left out, because the map must not move.
  void hold(bool held) { held_ = held; }

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
    std::future<void> solved;  ///< waits for its end when destroyed, so it is destroyed first
    Job(const SparseMap& map, const std::vector<KeyframeId>& free, const StereoCamera& camera)
        : bundle(map, free, camera) {}
    ~Job() { bundle.stop(); }
    [[nodiscard]] bool finished() const;
  };

  StereoCamera camera_;
  bool in_background_ = false;
  StopCondition stop_;
  bool held_ = false;
  std::optional<stereo::OffsetEstimate> free_offset_;
  std::unique_ptr<Job> job_;
  std::vector<std::unique_ptr<Job>> abandoned_;  ///< cancelled, still in their last iteration
};

}  // namespace headway::slam
