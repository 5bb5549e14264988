#pragma once

#include <headway/core/params.h>
#include <headway/map/body_shape.h>
#include <headway/map/perception_map.h>

#include <optional>
#include <string_view>
#include <vector>

namespace headway::map {

/// Whether an answer may be acted on. Only kKnown is safe.
enum class Answer {
  kKnown,         ///< from a fresh map, about a place and a time that it knows
  kStaleMap,      ///< the map is older than allowed, or from the future
  kEmptyMap,      ///< no layer holds anything
  kUnknownPlace,  ///< outside the grid, in a cell that nothing saw, or there is no grid
  kUnknownTime,   ///< before now, or farther ahead than predictions reach
};

/// "known", "stale_map", "empty_map", "unknown_place", "unknown_time".
[[nodiscard]] std::string_view toString(Answer answer);

/// Parameters of a query, errors under the name [map_query].
struct MapQueryParams {
  double max_age_s = 0.5;                 ///< an older map is stale [s]
  double horizon_s = 3.0;                 ///< of predictions, beyond the map's time [s]
  double min_contact_probability = 0.05;  ///< from which a contact is reported [-]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "map_query"); }  ///< @throws InputError
};

/// What stands or moves at a place. The probabilities are the doubt.
struct Occupancy {
  Answer answer = Answer::kUnknownPlace;
  double probability = 0.5;  ///< that anything is there
  double still = 0.5;        ///< that the still world is; 0.5: nothing saw it
  double moving = 0.0;       ///< that one of the tracks is
};

/// One possible place of a track at one time.
struct Obstacle {
  TrackId id;
  ObjectClass object_class = ObjectClass::kUnknown;
  BodyShape shape;
  double height_m = 0.0;
  double probability = 1.0;                              ///< of this one of the track's futures
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();      ///< map frame [m]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of the centre [m^2]
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();    ///< along this future [m/s]
  double yaw = 0.0;                                      ///< of the front about map z [rad]
};

struct Obstacles {
  Answer answer = Answer::kEmptyMap;
  std::vector<Obstacle> items;  ///< by track, the most probable future of each first
};

/// A track's most probable place near another place.
struct NearTrack {
  Obstacle obstacle;
  double distance_m = 0.0;  ///< from the place to the edge of the body; 0 within it
  double sigma_m = 0.0;     ///< of that distance
};

struct NearTracks {
  Answer answer = Answer::kEmptyMap;
  std::vector<NearTrack> items;  ///< the nearest first
};

/// Where the robot means to be, and when.
struct TimedPose {
  Time time = 0.0;                                     ///< in the map's clock [s]
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< map frame [m]
  double yaw = 0.0;                                    ///< [rad]
};

/// Whether a planned path meets something.
struct Collision {
  Answer answer = Answer::kEmptyMap;     ///< of the least known part of the path
  double probability = 0.0;              ///< of a contact at the worst moment
  std::optional<double> earliest_s;      ///< from now until a contact is worth telling
  std::optional<double> likely_s;        ///< from now until it is as likely as not
  std::optional<double> worst_s;         ///< from now until the worst moment
  std::optional<TrackId> with;           ///< at the worst moment; none: the still world
  std::optional<double> unknown_from_s;  ///< from now until the path leaves what is known
};

/// Asks one snapshot of the map, at one time, about places and times to come.
///
/// Every answer says whether it may be acted on: a stale or empty map, a place that nothing saw
/// and a time that no prediction reaches are told apart, never passed over. Tracks that are not
/// believed yet do not count. A value: keeps the snapshot alive and may be used in any thread.
///
///     const MapQuery ask = shared_map.snapshot().at(now);
///     if (ask.timeToCollision(body, plan).earliest_s) brake();
class MapQuery {
 public:
  /// @param now  in the map's clock [s]
  MapQuery(PerceptionMap snapshot, Time now, const MapQueryParams& params = {});

  /// Whether the map as a whole may be used now: kKnown, kStaleMap or kEmptyMap.
  [[nodiscard]] Answer answer() const { return answer_; }
  [[nodiscard]] double age_s() const { return now_ - map_.movingObjects().time(); }

  /// @param x, y  map frame [m]
  /// @param time  in the map's clock, from now on [s]
  [[nodiscard]] Occupancy occupancyAt(double x, double y, Time time) const;

  /// All tracks, standing ones too, as they may be at a time; the still world is a layer of its
  /// own, see PerceptionMap::staticGrid().
  [[nodiscard]] Obstacles obstaclesAt(Time time) const;

  /// Tracks whose bodies are within a radius of a place at a time.
  [[nodiscard]] NearTracks tracksNear(const Eigen::Vector2d& place, double radius_m,
                                      Time time) const;

  /// Follows the path from now to its end or to where predictions end, in steps of 0.05 s.
  ///
  /// The probabilities are those of single moments; these depend on each other, so the whole
  /// path's is at least that of the worst. Before its first pose the robot stands there.
  ///
  /// @param path  ascending in time; empty: nothing is met
  [[nodiscard]] Collision timeToCollision(const BodyShape& body,
                                          const std::vector<TimedPose>& path) const;

 private:
  [[nodiscard]] Answer answerAt(Time time) const;
  /// What of the still world is under a body.
  struct StillContact {
    double occupied = 0.0;  ///< the most occupied cell's probability
    bool unknown = false;   ///< nothing saw one of the cells
  };

  [[nodiscard]] std::optional<double> stillAt(double x, double y) const;
  [[nodiscard]] StillContact stillUnder(const TimedPose& pose, const BodyShape& body) const;
  void lookAt(const TimedPose& pose, const BodyShape& body, Collision& collision) const;

  PerceptionMap map_;
  mrpt::maps::COccupancyGridMap2D::ConstPtr grid_;
  Time now_;
  MapQueryParams params_;
  Answer answer_;
};

}  // namespace headway::map
