// SPDX-License-Identifier: BSD-3-Clause
// The map as a snapshot of MRPT layers, static ones and moving objects.
#pragma once

#include <headway/core/track.h>
#include <headway/map/moving_objects_map.h>
#include <headway/slam/map_view.h>
#include <mrpt/maps/CColouredPointsMap.h>
#include <mrpt/maps/CMultiMetricMap.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/CPointsMap.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace headway::map {

class LocalLayer;
class MapQuery;

/// The map: static layers and moving objects as layers of one MRPT multi-metric map.
///
/// A value that is cheap to copy: update() replaces layers and never modifies them, so that a copy
/// is a snapshot. Copies may be read in other threads; one object must not be accessed while
/// another thread updates it, see SharedMap.
///
///     PerceptionMap map;
///     map.update(slam.map());                      // after a keyframe
///     map.update(frame.time, tracks);              // every frame
///     planner.use(map.layers());                   // any MRPT code
///     if (map.at(now).occupancyAt(x, y, now + 1.0).probability > 0.2) replan();
class PerceptionMap {
 public:
  /// A landmark layer (CSimplePointsMap) and a moving-object layer.
  PerceptionMap();

  /// Layers as configured in an .ini, as for any MRPT multi-metric map.
  ///
  /// @param section  the section with the `..._count` keys
  /// @throws InputError if the file cannot be read, names an unknown kind of map, or lacks a point
  ///         map or a movingObjectsMap
  [[nodiscard]] static PerceptionMap fromIni(const std::string& path,
                                             const std::string& section = "map");

  /// Uses existing layers, such as those of a map file.
  ///
  /// @throws InputError if there is no point map or no CMovingObjectsMap among them
  explicit PerceptionMap(std::shared_ptr<mrpt::maps::CMultiMetricMap> layers);

  /// Replaces landmarks and keyframes. Takes about 1 ms for 100,000 landmarks.
  void update(slam::MapView static_map);

  /// Removes occupancy grid and dense points: the camera is in a submap that has none so far.
  void removeStaticLayers();

  /// Replaces the moving objects.
  ///
  /// @param time        of the tracks [s]
  /// @param tracks      in the map
  /// @param T_map_odom  at that time
  void update(Time time, std::vector<Track> tracks, const Pose& T_map_odom = Pose::Identity());

  /// T_map_odom at the time of the moving objects: by it a place in the odometry frame is one in
  /// the map (see MapQuery).
  [[nodiscard]] const Pose& odometryFrame() const { return T_map_odom_; }

  /// Replaces what is blocked now, in the odometry frame; it is no layer of the multi-metric map.
  void update(std::shared_ptr<const LocalLayer> local) { local_ = std::move(local); }

  /// Replaces the occupancy grid, or adds it as a layer (see StaticGrid). Must not be null.
  void update(const mrpt::maps::COccupancyGridMap2D::Ptr& static_grid);

  /// Replaces the dense coloured points, or adds them as a layer (see DenseMap). Must not be null.
  /// A CColouredOctoMap among the layers, as an .ini may ask for, gets the same points as voxels,
  /// which takes about 1 us for each of them.
  void update(const mrpt::maps::CColouredPointsMap::Ptr& dense);

  /// Queries of the map at current and future times; include map_query.h.
  ///
  /// @param now  in the map's clock [s]
  [[nodiscard]] MapQuery at(Time now) const;
  /// The same with places, headings and velocities of questions and answers in the odometry frame,
  /// in which what is kept from one frame to the next does not move.
  [[nodiscard]] MapQuery inOdometryAt(Time now) const;

  [[nodiscard]] const mrpt::maps::CMultiMetricMap& layers() const { return *layers_; }
  [[nodiscard]] const mrpt::maps::CPointsMap& landmarks() const { return *landmarks_; }
  [[nodiscard]] const CMovingObjectsMap& movingObjects() const { return *moving_objects_; }

  /// The occupancy grid; null if the map has no such layer.
  [[nodiscard]] mrpt::maps::COccupancyGridMap2D::ConstPtr staticGrid() const {
    return layers_->mapByClass<mrpt::maps::COccupancyGridMap2D>();
  }

  /// What is blocked now; null if no frame has been scanned for it. Include local_layer.h.
  [[nodiscard]] const std::shared_ptr<const LocalLayer>& local() const { return local_; }

  /// Dense coloured points of the static world; null if the map has no such layer.
  [[nodiscard]] const mrpt::maps::CColouredPointsMap::ConstPtr& dense() const { return dense_; }

  /// Landmarks with ids and grey values, and keyframes; never null.
  [[nodiscard]] const std::shared_ptr<const slam::MapView>& staticMap() const {
    return static_map_;
  }

 private:
  template <typename Layer>
  void replaceLayer(const std::shared_ptr<const Layer>& old_layer,
                    const std::shared_ptr<Layer>& new_layer);

  std::shared_ptr<const mrpt::maps::CMultiMetricMap> layers_;
  std::shared_ptr<const mrpt::maps::CPointsMap> landmarks_;     ///< one of layers_
  std::shared_ptr<const mrpt::maps::CPointsMap> no_landmarks_;  ///< its class and options
  std::shared_ptr<const CMovingObjectsMap> moving_objects_;     ///< one of layers_
  mrpt::maps::CColouredPointsMap::ConstPtr dense_;              ///< one of layers_, or null
  std::shared_ptr<const slam::MapView> static_map_;
  std::shared_ptr<const LocalLayer> local_;
  Pose T_map_odom_ = Pose::Identity();
};

}  // namespace headway::map
