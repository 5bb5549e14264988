#pragma once

#include <headway/core/pose.h>
#include <headway/core/track.h>
#include <headway/nav/footprint_outline.h>
#include <headway/nav/predicted_places.h>
#include <headway/nav/predictive_obstacles_params.h>

#include <vector>

namespace headway::nav {

/// Whether a track is believed, moves and is made of numbers.
[[nodiscard]] bool isMovingObstacle(const Track& track);

/// A point that a planner must not drive through, map frame [m].
struct ObstaclePoint {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double bottom = 0.0;  ///< of the body it stands for, map frame [m]
  double top = 0.0;     ///< [m]
};

/// A body where it is now.
struct PresentBody {
  map::FootprintShape shape;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< map frame [m]
  double yaw = 0.0;                                  ///< [rad]
  TimeSpan when;                                     ///< how long it stays there
  double reach = 0.0;  ///< no point of it is farther from the centre [m]
};

/// Obstacles of what moves, seen from one place of the robot at one time.
///
/// For each moving track: those points of the outlines of its places, present and predicted, that
/// the robot could touch while the body is there. Tracks that stand, and tentative ones, are left
/// to the robot's own sensors.
class MovingObstacles {
 public:
  explicit MovingObstacles(const PredictiveObstaclesParams& params);

  /// @param robot  place of the robot, map frame [m]
  /// @param age_s  how long ago the tracks were like this [s]
  void update(const std::vector<Track>& tracks, const Eigen::Vector2d& robot, double age_s);

  [[nodiscard]] const std::vector<ObstaclePoint>& points() const { return points_; }
  [[nodiscard]] const std::vector<PresentBody>& present() const { return present_; }

  /// Whether a sensed point (map frame [m]) belongs to bodies that will all have left it before the
  /// robot could touch it.
  [[nodiscard]] bool willBeGone(const Eigen::Vector2d& sensed) const;

 private:
  void addTrack(const Track& track, double age_s);
  void addOutline(const Track& track, const map::FootprintShape& body, const PredictedPlace& place);
  /// Whether any point of a disc could be met; spares looking at its outline where none can.
  [[nodiscard]] bool couldMeetBody(double distance, double radius, const TimeSpan& when) const;
  [[nodiscard]] bool couldMeet(const Eigen::Vector2d& point, const TimeSpan& when) const;

  PredictiveObstaclesParams params_;
  TimeGate gate_;
  Eigen::Vector2d robot_ = Eigen::Vector2d::Zero();
  std::vector<ObstaclePoint> points_;
  std::vector<PresentBody> present_;
  std::vector<PredictedPlace> places_;    ///< of the path in hand
  std::vector<Eigen::Vector2d> outline_;  ///< of the place in hand
};

}  // namespace headway::nav
