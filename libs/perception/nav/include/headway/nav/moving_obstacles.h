// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>
#include <headway/core/track.h>
#include <headway/nav/footprint_outline.h>
#include <headway/nav/predicted_places.h>
#include <headway/nav/predictive_obstacles_params.h>

#include <vector>

namespace headway::nav {

/// Whether a track is shown, moving, and finite.
[[nodiscard]] bool isMovingObstacle(const Track& track);

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
