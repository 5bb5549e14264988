// SPDX-License-Identifier: BSD-3-Clause
#include <headway/nav/moving_obstacles.h>

#include <algorithm>
#include <cmath>

namespace headway::nav {

using Eigen::Vector2d;

bool isMovingObstacle(const Track& track) {
  return isMoving(track) && isShown(track) && track.position.allFinite() && track.size.allFinite();
}

MovingObstacles::MovingObstacles(const PredictiveObstaclesParams& params)
    : params_(validated(params)), gate_(params.robot) {}

void MovingObstacles::update(const std::vector<Track>& tracks, const Vector2d& robot,
                             double age_s) {
  robot_ = robot;
  points_.clear();
  current_.clear();
  for (const auto& track : tracks) {
    if (isMovingObstacle(track)) addTrack(track, age_s);
  }
}

void MovingObstacles::addTrack(const Track& track, double age_s) {
  const map::FootprintShape footprint = map::footprintOf(track);
  const double horizon_s = params_.policy == ObstaclePolicy::kTimeGated
                               ? std::min(params_.steer_horizon_s, params_.horizon_s)
                               : params_.horizon_s;
  for (std::size_t i = 0; i < track.predictions.size(); ++i) {
    const auto& path = track.predictions[i];
    if (i > 0 && path.probability < params_.min_probability) break;  // the most probable first
    predictPlaces(track, path, age_s, horizon_s, params_.place_spacing_m, places_);
    const auto& present = places_.front();
    if (i == 0) {
      const double reach = std::hypot(0.5 * footprint.length_m + params_.object_margin_m,
                                      0.5 * footprint.width_m + params_.object_margin_m);
      current_.push_back({footprint, present.centre, present.yaw, present.when, reach});
    }
    current_.back().when.to_s = std::max(current_.back().when.to_s, present.when.to_s);
    for (const auto& place : places_) addOutline(track, footprint, place);
  }
}

void MovingObstacles::addOutline(const Track& track, const map::FootprintShape& footprint,
                                 const PredictedPlace& place) {
  const double distance = (place.centre - robot_).norm();
  if (!(distance <= params_.max_range_m)) return;
  // The growth stays clear of the robot: a planner that starts inside an obstacle finds no path.
  const double clearance = std::max(0.0, distance - footprint.radius() - params_.robot.radius_m);
  const PlaceUncertainty uncertainty{place.covariance, params_.sigmas,
                                     std::min(params_.max_growth_m, clearance)};
  if (!couldReachDisc(distance, footprint.radius() + uncertainty.max_growth_m, place.when)) return;
  outline_.clear();
  appendOutline(footprint, place.centre, place.yaw, uncertainty, params_.outline_spacing_m,
                outline_);
  const double bottom = track.position.z() - 0.5 * track.size.z();
  for (const auto& point : outline_) {
    if (!couldReach(point, place.when)) continue;
    points_.push_back({point, bottom, bottom + track.size.z()});
  }
}

bool MovingObstacles::couldReachDisc(double distance, double radius, const TimeSpan& when) const {
  if (params_.policy == ObstaclePolicy::kSweep) return true;
  const TimeSpan touched{gate_.touching(distance - radius).from_s,
                         gate_.touching(distance + radius).to_s};
  return touched.overlaps(when);
}

bool MovingObstacles::couldReach(const Vector2d& point, const TimeSpan& when) const {
  const double distance = (point - robot_).norm();
  if (!(distance > params_.robot.radius_m)) return false;  // the robot is there already
  if (params_.policy == ObstaclePolicy::kSweep) return true;
  return gate_.touching(distance).overlaps(when);
}

bool MovingObstacles::leavesInTime(const Vector2d& sensed) const {
  if (params_.policy != ObstaclePolicy::kTimeGated) return false;
  const TimeSpan touched = gate_.touching((sensed - robot_).norm());
  bool gone = false;
  for (const auto& obstacle : current_) {
    if ((sensed - obstacle.centre).squaredNorm() > obstacle.reach * obstacle.reach) continue;
    if (!covers(obstacle.shape, obstacle.centre, obstacle.yaw, params_.object_margin_m, sensed))
      continue;
    if (touched.overlaps(obstacle.when)) return false;
    gone = true;
  }
  return gone;
}

}  // namespace headway::nav
