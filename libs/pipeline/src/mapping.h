// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/map/map_file.h>

#include <map>
#include <memory>
#include <string>

#include "dense_mapper.h"
#include "frame_state.h"

namespace headway::pipeline {

/// Builds the map from localised frames: landmarks and keyframes of SLAM, the occupancy grid by
/// ground scans and lasers, the dense points, and the moving objects.
class Mapping {
 public:
  /// @param camera  null without images: then there are moving objects alone
  /// @param map     with the layers to fill
  Mapping(std::shared_ptr<const StereoCamera> camera, const PerceptionParams& params,
          map::PerceptionMap map);

  /// Whether the ground of this frame, in its turn, is to be scanned.
  [[nodiscard]] bool takesTurn(const RecordedFrame& frame);
  /// Scans every n-th frame from now on; 0: none.
  void setPeriod(int every_nth_frame);

  /// Takes all that a frame tells.
  void update(const FrameState& state, StageTimes& times);

  /// Replaces the moving objects.
  void update(Time time, const std::vector<Track>& tracks) { map_.update(time, tracks); }

  /// Takes the last corrections of the static map and completes the other layers.
  void finish(const std::optional<slam::MapView>& static_map, StageTimes& times);
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
  void updateStaticMap(const slam::MapView& static_map);
  void updateGrid(const FrameState& state, StageTimes& times);
  void updateDense(const FrameState& state, StageTimes& times);
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
  std::optional<stereo::RigCapability> rig_;
  GridParams grid_params_;
  LaserParams laser_params_;
  bool is_extended_;  ///< slam.mapping
  bool is_live_;      ///< no frame may be delayed by a correction of the whole map
  map::StaticGrid grid_;
  DenseMapper dense_;
  map::PerceptionMap map_;
  std::size_t grid_frames_ = 0;  ///< frames eligible for a scan
  std::map<std::string, std::size_t> laser_counts_;
};

}  // namespace headway::pipeline
