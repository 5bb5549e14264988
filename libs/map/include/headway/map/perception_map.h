#pragma once

#include <headway/core/track.h>
#include <headway/map/moving_objects_map.h>
#include <headway/slam/map_view.h>
#include <mrpt/maps/CMultiMetricMap.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/CPointsMap.h>

#include <memory>
#include <string>
#include <vector>

namespace headway::map {

class MapQuery;

/// The one map: the still world and what moves in it, as layers of one MRPT multi-metric map.
///
/// A value whose copies are cheap: layers are replaced by update(), never changed in place, so a
/// copy is a snapshot that later updates do not touch. Copies may be read in other threads, but one
/// object is not for two threads at once while one of them updates it: see SharedMap.
///
///     PerceptionMap map;
///     map.update(slam.map());                      // after a keyframe
///     map.update(frame.time, tracks);              // every frame
///     planner.use(map.layers());                   // any MRPT code
///     if (map.at(now).occupancyAt(x, y, now + 1.0).probability > 0.2) goRound();
class PerceptionMap {
 public:
  /// A landmark layer (CSimplePointsMap) and a moving-object layer.
  PerceptionMap();

  /// The layers that an .ini names, as for any MRPT multi-metric map.
  ///
  /// @param section  the section with the `..._count` keys
  /// @throws InputError if the file cannot be read, names an unknown kind of map, or lacks a point
  ///         map or a movingObjectsMap
  [[nodiscard]] static PerceptionMap fromIni(const std::string& path,
                                             const std::string& section = "map");

  /// Takes over layers made elsewhere, such as those of a map file.
  ///
  /// @throws InputError if there is no point map or no CMovingObjectsMap among them
  explicit PerceptionMap(std::shared_ptr<mrpt::maps::CMultiMetricMap> layers);

  /// Replaces the still world. Costs about 1 ms for 100,000 landmarks.
  void update(slam::MapView static_map);

  /// Replaces what moves.
  void update(Time time, std::vector<Track> tracks);

  /// Replaces the static grid, or adds it as a layer (see buildStaticGrid); never null.
  void update(const mrpt::maps::COccupancyGridMap2D::Ptr& static_grid);

  /// Asks what is where at times to come; include map_query.h.
  ///
  /// @param now  in the map's clock [s]
  [[nodiscard]] MapQuery at(Time now) const;

  [[nodiscard]] const mrpt::maps::CMultiMetricMap& layers() const { return *layers_; }
  [[nodiscard]] const mrpt::maps::CPointsMap& landmarks() const { return *landmarks_; }
  [[nodiscard]] const CMovingObjectsMap& movingObjects() const { return *moving_objects_; }

  /// The grid of free and occupied cells; null where the map has no such layer.
  [[nodiscard]] mrpt::maps::COccupancyGridMap2D::ConstPtr staticGrid() const {
    return layers_->mapByClass<mrpt::maps::COccupancyGridMap2D>();
  }

  /// Landmarks with ids and grey values, and keyframes; never null.
  [[nodiscard]] const std::shared_ptr<const slam::MapView>& staticMap() const {
    return static_map_;
  }

 private:
  template <typename Layer>
  void replaceLayer(const std::shared_ptr<const Layer>& old_layer,
                    const std::shared_ptr<Layer>& new_layer);

  std::shared_ptr<const mrpt::maps::CMultiMetricMap> layers_;
  std::shared_ptr<const mrpt::maps::CPointsMap> landmarks_;  ///< one of layers_
  std::shared_ptr<const CMovingObjectsMap> moving_objects_;  ///< one of layers_
  std::shared_ptr<const slam::MapView> static_map_;
};

}  // namespace headway::map
