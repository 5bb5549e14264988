// SPDX-License-Identifier: BSD-3-Clause
// The layers of the map: static map, grid, dense points and moving objects, for each submap.
#pragma once

#include <headway/map/local_layer.h>
#include <headway/map/map_file.h>
#include <headway/pipeline/perception.h>

#include <chrono>
#include <future>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "frame_state.h"
#include "laser_evidence.h"

namespace headway::pipeline {

/// Builds the dense map in the background: depth scans are made, and in live operation fused, in
/// threads of their own.
///
/// A scan enters the map with the next frame, whenever it was ready, so that the same frames give
/// the same map. Live, the points are fused again and again, in at most a tenth of the time;
/// otherwise when publish() is called.
class DenseMapper {
 public:
  /// @param rig      nullopt without a camera: then no scans may be added
  /// @param is_live  fuse in the background, at times that depend on the machine
  DenseMapper(const map::DenseMapParams& params, const std::optional<stereo::RigCapability>& rig,
              bool is_live);

  /// Whether frames are to be scanned.
  [[nodiscard]] bool isUsed() const { return used_; }

  /// Starts the scan of a frame.
  void scan(const stereo::FrameContext& context, MovingRegions moving, const Pose& T_map_robot,
            const Pose& T_odom_robot);

  /// Removes from the scans of the last seconds what lies where moving objects were, by their
  /// tracks at a time, in the odometry frame.
  void leaveOut(const std::vector<Track>& tracks, Time now);

  /// Enters the scan of the frame before, and in live operation what has been fused: to be called
  /// once a frame.
  void update(map::PerceptionMap& map, StageTimes& times);

  /// The scans from now on are of a camera that is mounted otherwise.
  void remount(const stereo::RigCapability& rig) { rig_ = rig; }

  /// Goes on with the scans of another submap. @return those so far
  [[nodiscard]] map::DenseMap exchange(map::DenseMap other, StageTimes& times);
  /// Adds the scans of a submap that was joined with this one.
  void add(const map::DenseMap& joined) { dense_.add(joined, 0); }

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
  struct TimedFusion {
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
  map::AnchoredPose scanned_at_;            ///< pose of the scan that is being made
  Pose T_odom_scanned_ = Pose::Identity();  ///< the same in the odometry frame
  std::shared_future<Scanned> scanning_;
  std::future<TimedFusion> fusing_;
  Clock::time_point next_fusion_{};
  WorkerThread scanner_;  ///< for which the next frame waits
  WorkerThread fuser_{WorkerThread::Priority::kBackground};
};

/// Builds the map from localised frames: landmarks and keyframes of SLAM, the occupancy grid by
/// ground scans and lasers, the dense points, and the moving objects.
class Mapping {
 public:
  /// @param camera  null without images: then there are moving objects alone
  /// @param map     with the layers to fill
  Mapping(std::shared_ptr<const StereoCamera> camera, const PerceptionParams& params,
          map::PerceptionMap map);

  /// Whether the ground of this frame is to be scanned, as a period has passed.
  [[nodiscard]] bool takesTurn(const RecordedFrame& frame, const FrameRate& rate);
  /// Whether each frame is scanned for what is blocked now.
  [[nodiscard]] bool hasLocalLayer() const { return local_.has_value(); }
  /// Period of ground scans from now on; 0: none [s].
  void setPeriod(double period_s);
  /// The rate of frames as measured, on which rig() depends.
  void setRate(double rate_hz);
  /// The rotation of the right camera that is undone from now on [rad]. Scans that were measured
  /// with another yaw are as wrong as their disparities: they are discarded where that is more than
  /// a disparity's noise.
  ///
  /// @param has_moved  the camera was rotated otherwise before: older scans are right
  void setRightTurn(const Eigen::Vector3d& turn, bool has_moved, StageTimes& times);

  /// The camera is mounted otherwise: what was scanned by the old mounting is discarded.
  void remount(std::shared_ptr<const StereoCamera> camera, const PerceptionParams& params,
               StageTimes& times);

  /// Takes what the frame tells of what is blocked now: while objects are detected in it.
  void updateLocal(const FrameState& state, StageTimes& times);
  /// Takes all else that a frame tells.
  void update(const FrameState& state, StageTimes& times);

  /// Replaces the moving objects, which are in the map.
  void update(Time time, std::vector<Track> tracks, const Pose& T_map_odom) {
    map_.update(time, std::move(tracks), T_map_odom);
  }

  /// Number of the submap whose layers are in the map.
  [[nodiscard]] int submap() const { return submap_; }
  /// Goes on with the layers of a submap as it is now, after the last frame.
  void show(int submap, const slam::StereoSlam& slam, StageTimes& times);
  /// The static layers of all other submaps.
  [[nodiscard]] std::vector<Submap> others(const slam::StereoSlam& slam);

  /// Completes the layers that were made in the background.
  void finish(StageTimes& times);
  /// Fuses the depth scans so far.
  void updateDensePoints(StageTimes& times) { dense_.publish(map_, times); }

  /// Continues in a stored map. @throws InputError if its scans are damaged
  void load(const map::StoredMap& stored, slam::MapView static_map);
  /// The map without attachments, with the latest corrections.
  [[nodiscard]] map::StoredMap stored() const;
  /// The scans by which load() continues.
  void attachScans(map::StoredMap& stored) const;

  [[nodiscard]] const map::PerceptionMap& map() const { return map_; }
  [[nodiscard]] const map::StaticGrid& grid() const { return grid_; }
  [[nodiscard]] const DenseMapper& dense() const { return dense_; }
  [[nodiscard]] const map::StaticGridParams& gridParams() const { return grid_params_.map; }
  [[nodiscard]] const std::optional<stereo::RigCapability>& rig() const { return rig_; }
  [[nodiscard]] const std::map<std::string, std::size_t>& laserCounts() const {
    return laser_counts_;
  }

 private:
  /// Layers of one submap.
  struct Layers {
    map::StaticGrid grid;
    map::DenseMap dense;
  };
  void enterSubmap(int submap, StageTimes& times);
  void joinSubmaps(const std::vector<int>& existing, const slam::MapView& static_map,
                   bool are_joined);
  [[nodiscard]] Layers& layersOf(int submap);
  void discardScans(StageTimes& times);
  void updateStaticMap(const slam::MapView& static_map);
  void updateGrid(const FrameState& state, StageTimes& times);
  void updateDense(const FrameState& state, StageTimes& times);
  /// The robot among the frame's laser scans; nullopt while the ground is unknown.
  [[nodiscard]] std::optional<LaserScene> laserScene(const FrameState& state) const;
  /// Adds the frame's laser scans to the ground scan, or counts why they are not used.
  void addLaser(const FrameState& state, std::optional<GroundScan>& scan);
  /// The free ground and the obstacles of a frame that is tracked; nullopt without ground.
  [[nodiscard]] std::optional<GroundScan> scanGround(const FrameState& state) const;
  /// Regions of moving and possibly moving objects, which the grid leaves out.
  [[nodiscard]] MovingRegions leftOutOfGrid(const FrameState& state) const;
  /// The same and all that may move later, which the dense map leaves out: people who stand still
  /// are obstacles of the grid, but no part of the world that is shown.
  [[nodiscard]] MovingRegions leftOutOfDenseMap(const FrameState& state) const;

  std::shared_ptr<const StereoCamera> camera_;
  stereo::RigAssumptions assumptions_;  ///< with the configured values
  std::optional<stereo::RigCapability> rig_;
  GridParams grid_params_;
  LaserParams laser_params_;
  bool is_extended_;  ///< slam.mapping
  bool is_live_;      ///< no frame may be delayed by a correction of the whole map
  int submap_ = 0;
  std::optional<map::LocalLayer> local_;  ///< nullopt: not asked for
  map::StaticGrid grid_;
  DenseMapper dense_;
  std::map<int, Layers> others_;  ///< of the other submaps
  map::PerceptionMap map_;
  std::optional<Time> last_scan_;
  double yaw_of_scans_ = 0.0;  ///< of the right camera, undone in their images [rad]
  std::map<std::string, std::size_t> laser_counts_;
};

}  // namespace headway::pipeline
