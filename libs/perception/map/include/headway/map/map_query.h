// SPDX-License-Identifier: BSD-3-Clause
// Questions about the map at present and future times: occupancy, obstacles, time to collision.
#pragma once

#include <headway/core/params.h>
#include <headway/map/contact_probability.h>
#include <headway/map/local_layer.h>
#include <headway/map/perception_map.h>

#include <optional>
#include <string_view>
#include <vector>

namespace headway::map {

/// Status of a query's result. Only results with kKnown are safe to act on.
enum class QueryStatus {
  kKnown,         ///< from a current map, for a place and a time that it covers
  kStaleMap,      ///< the map is older than allowed, or its time is in the future
  kEmptyMap,      ///< all layers are empty
  kUnknownPlace,  ///< outside the grid, in a cell never observed, or there is no grid
  kUnknownTime,   ///< before now, or after the predictions' horizon
};

/// "known", "stale_map", "empty_map", "unknown_place", "unknown_time".
[[nodiscard]] std::string_view toString(QueryStatus status);

/// Parameters of a query, errors under the name [map_query].
struct MapQueryParams {
  double max_age_s = 0.5;                 ///< an older map is stale [s]
  double horizon_s = 3.0;                 ///< of predictions, after the map's time [s]
  double min_contact_probability = 0.05;  ///< minimum probability of a reported contact [-]
  double caution = kCaution;              ///< about what is out of view, see LocalLayer [-]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "map_query"); }  ///< @throws InputError
};

/// Occupancy of a point at one time, as probabilities in [0, 1].
struct Occupancy {
  QueryStatus status = QueryStatus::kUnknownPlace;
  double probability = 0.5;         ///< occupied by anything
  double static_probability = 0.5;  ///< by what the newest frames or the static grid show; 0.5:
                                    ///< unknown
  double moving_probability = 0.0;  ///< occupied by one of the tracks
};

/// One possible place of a track at one time.
struct Obstacle {
  TrackId id;
  ObjectClass object_class = ObjectClass::kUnknown;
  FootprintShape shape;
  double height_m = 0.0;
  double probability = 1.0;                              ///< of this one of the track's predictions
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();      ///< [m]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of the centre [m^2]
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();    ///< along this prediction [m/s]
  double yaw = 0.0;                                      ///< of the front about z [rad]
};
/// Answer to a question for obstacles.
struct Obstacles {
  QueryStatus status = QueryStatus::kEmptyMap;
  std::vector<Obstacle> items;  ///< grouped by track, the most probable prediction first
};

/// A track near a point: its most probable place.
struct NearTrack {
  Obstacle obstacle;
  double distance_m = 0.0;  ///< from the point to the edge of the footprint; 0 inside it
  double sigma_m = 0.0;     ///< standard deviation of that distance
};
/// Answer to a question for near tracks.
struct NearTracks {
  QueryStatus status = QueryStatus::kEmptyMap;
  std::vector<NearTrack> items;  ///< by ascending distance
};

/// A pose of a planned path.
struct TimedPose {
  Time time = 0.0;                                     ///< in the map's clock [s]
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< [m]
  double yaw = 0.0;                                    ///< about z [rad]
};

/// Result of checking a planned path. Times are relative to now.
struct Collision {
  QueryStatus status = QueryStatus::kEmptyMap;  ///< of the first pose that is not kKnown
  double probability = 0.0;                     ///< of a contact at the worst time
  std::optional<double> earliest_s;             ///< first time with a reported contact
  std::optional<double> likely_s;               ///< first time with probability >= 0.5
  std::optional<double> worst_s;                ///< time of the highest probability
  std::optional<TrackId> with;                  ///< at the worst time; none: the static grid
  std::optional<double> unknown_from_s;         ///< first time without a known status

  /// Whether the whole path is known to be free of contacts; the condition for driving on.
  [[nodiscard]] bool isFree() const {
    return status == QueryStatus::kKnown && !earliest_s && !unknown_from_s;
  }
};

/// Queries of one snapshot of the map, at one time, about points and times in the future.
///
/// What the newest frames show around the robot (see LocalLayer) takes precedence over the static
/// grid, whatever that says: what is blocked now is an obstacle, what is in view and not seen to be
/// free is unknown. The place of a track that moves is judged by its predictions from 0.3 s on.
///
/// Places are in the map, or in the odometry frame (see PerceptionMap::inOdometryAt()). Every
/// result has a status: a stale or empty map, an unobserved place and a time after the
/// predictions' horizon are distinguished. Tentative tracks are ignored. A value: it shares
/// ownership of the snapshot and may be used in any thread.
///
///     const MapQuery query = shared_map.snapshot().at(now);
///     if (!query.timeToCollision(footprint, plan).isFree()) brake();
class MapQuery {
 public:
  /// @param now        in the map's clock [s]
  /// @param T_map_asked  from the frame of questions and answers to the map, seen from above
  /// @throws           InputError if a parameter is out of range
  MapQuery(PerceptionMap snapshot, Time now, const MapQueryParams& params = {},
           const Eigen::Isometry2d& T_map_asked = Eigen::Isometry2d::Identity());

  /// Whether the map as a whole may be used now: kKnown, kStaleMap or kEmptyMap.
  [[nodiscard]] QueryStatus status() const { return status_; }
  [[nodiscard]] double age_s() const { return now_ - map_.movingObjects().time(); }

  /// @param x, y  [m]
  /// @param time  in the map's clock, not before now [s]
  [[nodiscard]] Occupancy occupancyAt(double x, double y, Time time) const;

  /// All tracks, static ones too, at their possible places. The static grid is a separate layer,
  /// see PerceptionMap::staticGrid().
  [[nodiscard]] Obstacles obstaclesAt(Time time) const;

  /// Tracks whose footprints are within a radius of a point at a time.
  ///
  /// @param place     [m]
  /// @param radius_m  from the point to the edge of the footprint
  [[nodiscard]] NearTracks tracksNear(const Eigen::Vector2d& place, double radius_m,
                                      Time time) const;

  /// What the newest frames say about a place [m]; kNotInView if none was scanned for it.
  ///
  /// @param within_s  kEntered, too, where what left the view may be by then [s]
  [[nodiscard]] LocalState localAt(const Eigen::Vector2d& place, double within_s = 0.0) const;
  /// Whether the newest frames say that a place is free [m], by what was seen of it after a time.
  [[nodiscard]] bool wasSeenFree(const Eigen::Vector2d& place, Time since) const;
  /// What the newest frames say about the ground; where they say nothing, kFree if the static grid
  /// does. kUnknown of a map that cannot be asked.
  [[nodiscard]] LocalState groundNow(const Eigen::Vector2d& place, double within_s = 0.0) const;
  /// Where something stands by the newest frames: centres of cells [m].
  [[nodiscard]] std::vector<Eigen::Vector2d> blockedNow() const;

  /// Checks the path from now to its end or to the end of predictions, in steps of 0.05 s.
  ///
  /// The probabilities refer to single times; they are correlated, so that the probability for the
  /// whole path is at least the highest of them. Before its first pose the robot is at that pose.
  ///
  /// @param footprint  of the robot, centred at its pose
  /// @param path       ascending in time; empty: no contact
  [[nodiscard]] Collision timeToCollision(const FootprintShape& footprint,
                                          const std::vector<TimedPose>& path) const;

 private:
  [[nodiscard]] QueryStatus statusAt(Time time) const;

  /// The static grid's cells under a footprint.
  struct StaticContact {
    double occupied = 0.0;  ///< highest probability of the cells
    bool unknown = false;   ///< one of the cells was never observed
  };

  [[nodiscard]] std::optional<double> staticOccupancyAt(const Eigen::Vector2d& place) const;
  /// Of the ground at a time: by the local layer where it knows, else by the static grid; nullopt
  /// if unknown. @param place  in the map
  [[nodiscard]] std::optional<double> groundAt(const Eigen::Vector2d& place, Time time) const;
  [[nodiscard]] bool isOnMover(const Eigen::Vector2d& place) const;
  [[nodiscard]] StaticContact staticContact(const TimedPose& pose,
                                            const FootprintShape& footprint) const;
  void checkPose(const TimedPose& pose, const FootprintShape& footprint,
                 Collision& collision) const;

  PerceptionMap map_;
  mrpt::maps::COccupancyGridMap2D::ConstPtr grid_;
  Time now_;
  MapQueryParams params_;
  Eigen::Isometry2d T_map_asked_;
  Eigen::Isometry2d T_odom_map_;
  QueryStatus status_;
};

}  // namespace headway::map
