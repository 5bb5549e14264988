// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/moving_regions.h>
#include <headway/core/stage_times.h>
#include <headway/core/worker_thread.h>
#include <headway/map/dense_map.h>
#include <headway/map/perception_map.h>
#include <headway/stereo/frame_context.h>
#include <headway/stereo/rig_capability.h>

#include <chrono>
#include <future>
#include <optional>
#include <string>

namespace headway::pipeline {

/// Builds the dense map beside the tracking: depth scans are made, and in live operation fused, in
/// threads of their own.
///
/// A scan enters the map with the next frame, whenever it was ready, so that the same frames give
/// the same map. Live, the points are fused again and again, in at most a tenth of the time;
/// otherwise when publish() is called.
class DenseMapper {
 public:
  /// @param rig      nullopt without a camera: then no scans may be added
  /// @param is_live  fuse beside the tracking, at times that depend on the machine
  DenseMapper(const map::DenseMapParams& params, const std::optional<stereo::RigCapability>& rig,
              bool is_live);

  /// Whether frames are to be scanned.
  [[nodiscard]] bool isUsed() const { return used_; }

  /// Starts the scan of a frame.
  void scan(const stereo::FrameContext& context, MovingRegions moving, const Pose& T_map_robot);

  /// Removes from the scans of the last seconds what lies where moving objects were, by their
  /// tracks at a time.
  void leaveOut(const std::vector<Track>& tracks, Time now);

  /// Enters the scan of the frame before, and in live operation what has been fused: to be called
  /// once a frame.
  void update(map::PerceptionMap& map, StageTimes& times);

  void follow(const SharedChunks<slam::KeyframeView>& keyframes) { dense_.follow(keyframes); }

  /// Fuses all scans that were entered and updates the map's layer. The pending one is entered by
  /// update() alone, so that pictures on the way change nothing: its pose follows the keyframes of
  /// that time.
  void publish(map::PerceptionMap& map, StageTimes& times);

  /// The map of the scans that were entered: all of them after update().
  [[nodiscard]] const map::DenseMap& map() const { return dense_; }

  /// A map with the parameters of this one and no scans.
  [[nodiscard]] map::DenseMap emptyMap() const;

  /// All scans, for load().
  [[nodiscard]] ByteSource save() const;
  /// @throws InputError if the bytes are invalid
  void load(const std::string& bytes) { dense_.load(bytes); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Scanned {
    DepthScan scan;
    double elapsed_ms = 0.0;
  };
  struct FusedBeside {
    map::DenseMap::Fused fused;
    Clock::duration elapsed{};
  };
  void enterScan(StageTimes& times);
  void applyFused(map::PerceptionMap& map, StageTimes& times);

  map::DenseMapParams params_;
  bool used_;
  bool is_live_;
  std::optional<stereo::RigCapability> rig_;
  map::DenseMap dense_;
  map::AnchoredPose scanned_at_;  ///< pose of the scan that is being made
  std::shared_future<Scanned> scanning_;
  std::future<FusedBeside> fusing_;
  Clock::time_point next_fusion_{};
  WorkerThread scanner_{WorkerThread::Priority::kBackground};
  WorkerThread fuser_{WorkerThread::Priority::kBackground};
};

}  // namespace headway::pipeline
