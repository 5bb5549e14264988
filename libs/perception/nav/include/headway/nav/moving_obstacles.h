// SPDX-License-Identifier: BSD-3-Clause
// Where moving objects will be, which of those places the robot could meet, and the parameters of
// section [nav].
#pragma once

#include <headway/core/params.h>
#include <headway/core/pose.h>
#include <headway/core/track.h>
#include <headway/map/contact_probability.h>
#include <headway/map/local_layer.h>
#include <headway/map/map_query.h>

#include <string>
#include <utility>
#include <vector>

namespace headway::nav {

/// Which obstacles a planner receives of moving objects.
enum class ObstaclePolicy {
  kStatic,     ///< the robot's own sensor points only; the map is not read
  kSweep,      ///< and all predicted places within the horizon
  kTimeGated,  ///< and the predicted places that the robot could reach at that time
};

/// Names in command lines and files: "static", "sweep", "time_gated".
[[nodiscard]] const std::vector<std::pair<std::string, ObstaclePolicy>>& obstaclePolicies();

/// The robot as a disc with a range of speeds, and as a rectangle for contacts.
struct RobotMotionParams {
  double radius_m = 0.35;          ///< of the smallest circle about its origin that encloses it [m]
  double length_m = 0.5;           ///< centred at the origin [m]
  double width_m = 0.45;           ///< [m]
  double max_speed_mps = 1.0;      ///< forward [m/s]
  double acceleration_mps2 = 5.0;  ///< at most [m/s^2]
  double deceleration_mps2 = 1.0;  ///< of braking [m/s^2]
  double slow_ratio = 0.8;         ///< lowest assumed speed over max_speed_mps [-]
  double early_slack_s = 0.0;      ///< by which the robot may be earlier [s]
  double late_slack_s = 0.3;       ///< by which it may be later, for acceleration [s]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "nav"); }  ///< @throws InputError
};

/// Speed governor among moving objects.
struct GovernorParams {
  bool enabled = true;
  double horizon_s = 2.5;       ///< of the predicted contacts [s]
  double contact_cost = 40.0;   ///< of a certain contact; stopping now costs 1 [-]
  double standing_ratio = 0.5;  ///< factor of that cost if the robot is at rest by then [-]
  double patience_s = 2.0;      ///< decay time of a contact's cost with the time until it [s]
  double margin_m = 0.1;        ///< distance below which there is contact [m]
  double lag_s = 0.15;          ///< time constant of the robot's speed control [s]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "nav"); }  ///< @throws InputError
};

/// Obstacles from tracks, section "nav".
struct PredictiveObstaclesParams {
  ObstaclePolicy policy = ObstaclePolicy::kTimeGated;
  double max_age_s = 0.5;         ///< of the map; sensing fails with an older one [s]
  std::string map_frame = "map";  ///< name of the map's frame, in which the robot is asked for
  /// Name of headway's odometry frame, in which a robot's pose may be, too; empty: in none. It is
  /// not that of the wheels.
  std::string odom_frame;
  double horizon_s = 3.0;          ///< of the predictions that are used [s]
  double steer_horizon_s = 1.5;    ///< kTimeGated: later contacts only slow the robot [s]
  double min_probability = 0.1;    ///< of a predicted path that is used [-]
  double sigmas = 1.0;             ///< of the position by which outlines grow [standard deviations]
  double max_growth_m = 0.4;       ///< limit of that growth [m]
  double object_margin_m = 0.25;   ///< sensed points within belong to the object [m]
  double place_spacing_m = 0.25;   ///< between predicted places of one object [m]
  double outline_spacing_m = 0.2;  ///< between points of one outline [m]
  double layer_spacing_m = 0.6;    ///< between the heights of points, for 3D robots [m]
  double max_range_m = 12.0;       ///< of places from the robot [m]
  bool use_static_grid = true;     ///< occupied cells of the map's grid are obstacles, too
  double caution = map::kCaution;  ///< about what is out of view, see map::LocalLayer [-]
  RobotMotionParams robot;
  GovernorParams governor;

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "nav"); }  ///< @throws InputError
};

/// A span of time, relative to now [s].
struct TimeSpan {
  double from_s = 0.0;
  double to_s = 0.0;

  [[nodiscard]] bool overlaps(const TimeSpan& other) const {
    return from_s <= other.to_s && other.from_s <= to_s;
  }
};

/// Time span in which the robot could touch a point.
///
/// The robot is assumed to drive straight to the point at any speed between its lowest and its
/// maximum speed: it touches the point at the earliest after the free distance at maximum speed,
/// and has passed it at the latest after the distance beyond it at the lowest speed. Laws: a
/// farther point is touched later; a wider range of speeds, or more slack, gives a longer span; a
/// point under the robot is touched now. Points suffice, because two shapes first touch at points
/// of their edges.
class TimeGate {
 public:
  /// @throws InputError if a parameter is out of range
  explicit TimeGate(const RobotMotionParams& robot);

  /// @param distance_m  from the robot's origin to the point
  [[nodiscard]] TimeSpan touching(double distance_m) const;

 private:
  RobotMotionParams robot_;
};

/// A predicted position of an object, with the time span for which it is valid.
struct PredictedPlace {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();      ///< map frame [m]
  double yaw = 0.0;                                      ///< direction of motion [rad]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of the centre [m^2]
  TimeSpan when;                                         ///< relative to now
};

/// Samples one predicted path from now on, the current place first, at a distance of spacing_m.
///
/// The time spans of neighbouring places overlap, so that every instant is covered. If there is
/// one place only, of a static object, its time span is unlimited.
///
/// @param age_s      age of the track: sampling starts at this horizon of the path [s]
/// @param horizon_s  sampling ends at this horizon of the path [s]
/// @param spacing_m  minimum distance of neighbouring places
/// @param out        overwritten; its memory is reused
void predictPlaces(const Track& track, const PredictedPath& path, double age_s, double horizon_s,
                   double spacing_m, std::vector<PredictedPlace>& out);

/// Uncertainty of a position, by which a footprint is enlarged.
struct PlaceUncertainty {
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of the centre [m^2]
  double sigmas = 1.0;                                   ///< standard deviations of the growth [-]
  double max_growth_m = 0.4;                             ///< limit of the growth [m]
};

/// Points along the edge of a footprint, enlarged by the uncertainty of its position.
///
/// The Minkowski sum of the footprint and the covariance ellipse: the point with outward normal n
/// is the footprint's support point plus sigmas * C n / sqrt(n' C n), of at most max_growth_m.
/// Laws: the outline encloses the footprint; the outline of a larger covariance encloses that of a
/// smaller one; rotating footprint and covariance rotates the outline.
///
/// @param centre   map frame [m]
/// @param yaw      of the footprint's front [rad]
/// @param spacing  approximate maximum distance of neighbouring points [m]
/// @param out      points are appended to it, map frame [m]
void appendOutline(const map::FootprintShape& footprint, const Eigen::Vector2d& centre, double yaw,
                   const PlaceUncertainty& uncertainty, double spacing,
                   std::vector<Eigen::Vector2d>& out);

/// Whether a point lies in the footprint, as a rectangle and enlarged by a margin on all sides.
///
/// @param centre, point  map frame [m]
/// @param yaw            of the footprint's front [rad]
/// @param margin         [m]
[[nodiscard]] bool covers(const map::FootprintShape& footprint, const Eigen::Vector2d& centre,
                          double yaw, double margin, const Eigen::Vector2d& point);

/// Whether a track is shown, moving, and finite.
[[nodiscard]] bool isMovingObstacle(const Track& track);

/// Moving tracks that ended where nobody could be seen any more, beside the robot, too near, or
/// hidden: they go on as they were predicted, until the place is seen to be free, somebody else is
/// tracked there, or the time is over.
class TrackMemory {
 public:
  /// @param hold_s  that a track goes on, at most as long as it was predicted [s]
  explicit TrackMemory(double hold_s) : hold_s_(hold_s) {}

  /// Takes the tracks of a time, and adds those that are remembered, as they are predicted for it.
  ///
  /// @param tracks  map frame; of one time as often as it is asked for
  /// @param query   the map of that time, which says what is seen to be free
  [[nodiscard]] std::vector<Track> with(const std::vector<Track>& tracks, Time time,
                                        const Pose& T_map_odom, const map::MapQuery& query);

 private:
  struct Remembered {
    Track track;  ///< odometry frame
    Time time = 0.0;
  };
  double hold_s_;
  std::vector<Remembered> remembered_;
  Time time_ = 0.0;  ///< of the newest tracks
};

/// An obstacle point for the planner, map frame [m].
struct ObstaclePoint {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double bottom = 0.0;  ///< z of the object's lower face [m]
  double top = 0.0;     ///< z of its upper face [m]
};

/// A moving object at its current position.
struct CurrentObstacle {
  map::FootprintShape shape;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< map frame [m]
  double yaw = 0.0;                                  ///< [rad]
  TimeSpan when;                                     ///< time until it leaves the position
  double reach = 0.0;  ///< radius about the centre that encloses it, with margin [m]
};

/// Obstacle points of the moving tracks, for one position of the robot at one time.
///
/// For each moving track: the points of its current and predicted outlines that the robot could
/// reach while the object is there. Static and tentative tracks are ignored, since the robot's own
/// sensors detect them.
class MovingObstacles {
 public:
  /// @throws InputError if a parameter is out of range
  explicit MovingObstacles(const PredictiveObstaclesParams& params);

  /// @param robot  position of the robot, map frame [m]
  /// @param age_s  age of the tracks [s]
  void update(const std::vector<Track>& tracks, const Eigen::Vector2d& robot, double age_s);

  [[nodiscard]] const std::vector<ObstaclePoint>& points() const { return points_; }
  [[nodiscard]] const std::vector<CurrentObstacle>& current() const { return current_; }

  /// Whether a sensed point (map frame [m]) belongs to moving objects only, all of which leave it
  /// before the robot could reach it.
  [[nodiscard]] bool leavesInTime(const Eigen::Vector2d& sensed) const;

 private:
  void addTrack(const Track& track, double age_s);
  void addOutline(const Track& track, const map::FootprintShape& footprint,
                  const PredictedPlace& place);
  /// Whether any point of a disc could be reached: a cheap test before that of its outline.
  [[nodiscard]] bool couldReachDisc(double distance, double radius, const TimeSpan& when) const;
  [[nodiscard]] bool couldReach(const Eigen::Vector2d& point, const TimeSpan& when) const;

  PredictiveObstaclesParams params_;
  TimeGate gate_;
  Eigen::Vector2d robot_ = Eigen::Vector2d::Zero();
  std::vector<ObstaclePoint> points_;
  std::vector<CurrentObstacle> current_;
  std::vector<PredictedPlace> places_;    ///< buffer: places of one path
  std::vector<Eigen::Vector2d> outline_;  ///< buffer: outline of one place
};

}  // namespace headway::nav
