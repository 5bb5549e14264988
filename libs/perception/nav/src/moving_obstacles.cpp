// SPDX-License-Identifier: BSD-3-Clause
// Where moving objects will be, which of those places the robot could meet, and the parameters of
// section [nav].
#include <headway/map/contact_probability.h>
#include <headway/nav/moving_obstacles.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace headway::nav {

const std::vector<std::pair<std::string, ObstaclePolicy>>& obstaclePolicies() {
  static const std::vector<std::pair<std::string, ObstaclePolicy>> policies = {
      {"static", ObstaclePolicy::kStatic},
      {"sweep", ObstaclePolicy::kSweep},
      {"time_gated", ObstaclePolicy::kTimeGated}};
  return policies;
}

void RobotMotionParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("robot_radius_m", radius_m, 0.05, 5.0, "m",
           "Radius of the circle about the robot's origin that holds it");
  user.add("robot_length_m", length_m, 0.0, 10.0, "m", "Length of the robot, about its origin");
  user.add("robot_width_m", width_m, 0.0, 10.0, "m", "Width of the robot");
  user.add("robot_max_speed_mps", max_speed_mps, 0.05, 30.0, "m/s", "The robot's maximum speed");
  section.add("robot_acceleration_mps2", acceleration_mps2, 0.05, 20.0, "m/s^2",
              "The robot's greatest acceleration");
  user.add("robot_deceleration_mps2", deceleration_mps2, 0.05, 20.0, "m/s^2",
           "The robot's deceleration when it brakes");
  section.add("robot_slow_ratio", slow_ratio, 0.05, 1.0, "",
              "Lowest speed assumed on the way to a place, relative to the maximum speed");
  section.add("early_slack_s", early_slack_s, 0.0, 5.0, "s",
              "Time by which the robot may reach a place earlier");
  section.add("late_slack_s", late_slack_s, 0.0, 5.0, "s",
              "Time by which the robot may reach a place later");
}

void GovernorParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("govern_speed", enabled, "Slow the robot where that avoids contacts");
  user.add("contact_margin_m", margin_m, 0.0, 2.0, "m", "Distance below which there is contact");
  user.add("robot_lag_s", lag_s, 0.0, 5.0, "s", "Time constant of the robot's speed control");
  section.add("govern_horizon_s", horizon_s, 0.2, 10.0, "s", "Horizon of the speed governor");
  section.add("contact_cost", contact_cost, 0.0, 1000.0, "",
              "Cost of a certain contact, relative to that of standing now");
  section.add("standing_ratio", standing_ratio, 0.0, 1.0, "",
              "Ratio of that cost for a contact with the standing robot");
  section.add("patience_s", patience_s, 0.1, 100.0, "s",
              "Decay time of a contact's cost with the time until it");
}

void PredictiveObstaclesParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("policy", policy, obstaclePolicies(),
           "Obstacles made of moving objects: their present points (static), everywhere they may "
           "be within the horizon (sweep), or only where they may meet the robot (time_gated)");
  user.add("horizon_s", horizon_s, 0.1, 10.0, "s", "Horizon of the predictions that are used");
  user.add("max_age_s", max_age_s, 0.05, 60.0, "s",
           "Age of the map from which sensing fails, so that the robot stops");
  section.add("map_frame", map_frame, "Name of the map's frame, in which the robot is asked for");
  section.add(
      "odom_frame", odom_frame,
      "Name of headway's odometry frame, in which a robot's pose may be, too; empty: in none. "
      "It is not that of the wheels");
  section.add("steer_horizon_s", steer_horizon_s, 0.1, 10.0, "s",
              "time_gated: horizon of obstacles; later contacts only slow the robot");
  section.add("min_probability", min_probability, 0.0, 1.0, "",
              "Minimum probability of a predicted path");
  section.add("sigmas", sigmas, 0.0, 5.0, "",
              "Standard deviations of its position by which an outline grows");
  section.add("max_growth_m", max_growth_m, 0.0, 5.0, "m", "Maximum growth of an outline");
  section.add("object_margin_m", object_margin_m, 0.0, 2.0, "m",
              "Distance from a moving object within which sensed points belong to it");
  section.add("place_spacing_m", place_spacing_m, 0.05, 2.0, "m",
              "Distance between predicted positions of one object");
  section.add("outline_spacing_m", outline_spacing_m, 0.05, 2.0, "m",
              "Distance between points of one outline");
  section.add("layer_spacing_m", layer_spacing_m, 0.1, 10.0, "m",
              "Distance between the heights at which an outline has points");
  section.add("use_static_grid", use_static_grid,
              "Occupied cells of the map's grid are obstacles, too");
  user.add(
      "caution", caution, 0.0, 1.0, "",
      "How long, and how far round it, what was seen to leave the view still blocks: 0 to 6 s, "
      "at 0 to 1.5 m/s");
  section.add("max_range_m", max_range_m, 1.0, 200.0, "m", "Maximum distance from the robot");
  robot.describe(section);
  governor.describe(section);
}

using Eigen::Vector2d;

TimeGate::TimeGate(const RobotMotionParams& robot) : robot_(validated(robot)) {}

TimeSpan TimeGate::touching(double distance_m) const {
  const double slowest = robot_.max_speed_mps * robot_.slow_ratio;
  const double free_way = std::max(0.0, distance_m - robot_.radius_m);
  return {free_way / robot_.max_speed_mps - robot_.early_slack_s,
          (distance_m + robot_.radius_m) / slowest + robot_.late_slack_s};
}

namespace {

constexpr double kStepBeyond_s = 0.1;  ///< between samples beyond the prediction

PredictedPlace placeAt(const map::PathSample& sample, double from_now_s, double yaw) {
  return {sample.centre, yaw, sample.covariance, {from_now_s, from_now_s}};
}

/// Makes each place last from when its predecessor is left to when its successor is reached.
void joinTimes(std::vector<PredictedPlace>& places, double end_s) {
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    places[i].when.to_s = places[i + 1].when.from_s;
  }
  for (std::size_t i = places.size() - 1; i > 0; --i) {
    places[i].when.from_s = places[i - 1].when.from_s;
  }
  places.back().when.to_s =
      places.size() == 1 ? std::numeric_limits<double>::infinity() : std::max(0.0, end_s);
}

/// The farthest point of the covariance ellipse along a normal, in the map's axes.
Vector2d growth(const PlaceUncertainty& uncertainty, const Vector2d& normal) {
  const Vector2d carried = uncertainty.covariance * normal;
  const double variance = normal.dot(carried);
  if (!(variance > 0.0) || !(uncertainty.max_growth_m > 0.0)) return Vector2d::Zero();
  const Vector2d offset = uncertainty.sigmas / std::sqrt(variance) * carried;
  const double length = offset.norm();
  return length > uncertainty.max_growth_m ? Vector2d(offset * (uncertainty.max_growth_m / length))
                                           : offset;
}

/// Appends the way from one point to the next, without the first one.
void appendSegment(const Vector2d& from, const Vector2d& to, double spacing,
                   std::vector<Vector2d>& out) {
  const double length = (to - from).norm();
  const int pieces = std::max(1, static_cast<int>(std::ceil(length / spacing - 0.5)));
  for (int i = 1; i <= pieces; ++i) out.push_back(from + (to - from) * i / pieces);
}

}  // namespace

void predictPlaces(const Track& track, const PredictedPath& path, double age_s, double horizon_s,
                   double spacing_m, std::vector<PredictedPlace>& out) {
  out.clear();
  const double last_s = path.points.empty() ? 0.0 : path.points.back().horizon_s;
  out.push_back(placeAt(map::samplePath(track, path, std::min(age_s, last_s)), 0.0, track.yaw));
  double end_s = 0.0;
  const auto walkTo = [&](const map::PathSample& sample, double time_s) {
    if (!(time_s > age_s) || !(time_s <= horizon_s + 1e-9)) return;
    end_s = time_s - age_s;
    const Vector2d step = sample.centre - out.back().centre;
    if (!(step.squaredNorm() >= spacing_m * spacing_m)) return;
    out.push_back(placeAt(sample, end_s, std::atan2(step.y(), step.x())));
  };
  for (const auto& point : path.points) {
    walkTo({point.position.head<2>(), point.covariance}, point.horizon_s);
  }
  for (int i = 1; last_s > 0.0 && last_s + i * kStepBeyond_s <= horizon_s + 1e-9; ++i) {
    const double time_s = last_s + i * kStepBeyond_s;
    walkTo(map::samplePath(track, path, time_s), time_s);
  }
  joinTimes(out, end_s);
}

void appendOutline(const map::FootprintShape& footprint, const Vector2d& centre, double yaw,
                   const PlaceUncertainty& uncertainty, double spacing,
                   std::vector<Vector2d>& out) {
  const Eigen::Rotation2Dd turn(yaw);
  const double perimeter = 2.0 * M_PI * footprint.radius();
  const int normals = std::clamp(static_cast<int>(std::ceil(perimeter / spacing)), 8, 24);
  Vector2d previous = Vector2d::Zero();
  for (int i = 0; i <= normals; ++i) {
    // Half a step off the axes, where a box's support point is not unique.
    const double angle = 2.0 * M_PI * (i + 0.5) / normals;
    const Vector2d normal(std::cos(angle), std::sin(angle));
    const Vector2d point =
        centre + turn * footprint.supportPoint(normal) + growth(uncertainty, turn * normal);
    if (i > 0) appendSegment(previous, point, spacing, out);
    previous = point;
  }
}

bool covers(const map::FootprintShape& footprint, const Vector2d& centre, double yaw, double margin,
            const Vector2d& point) {
  const Vector2d local = Eigen::Rotation2Dd(-yaw) * (point - centre);
  return std::abs(local.x()) <= 0.5 * footprint.length_m + margin &&
         std::abs(local.y()) <= 0.5 * footprint.width_m + margin;
}

bool isMovingObstacle(const Track& track) {
  return isMoving(track) && isShown(track) && track.position.allFinite() && track.size.allFinite();
}

/// The track as it was predicted for a later time; nullopt beyond its predictions.
static std::optional<Track> advanced(const Track& track, double age_s) {
  if (track.predictions.empty()) return std::nullopt;
  const auto& likeliest = track.predictions.front().points;
  if (likeliest.empty() || !(age_s < likeliest.back().horizon_s)) return std::nullopt;
  Track later = track;
  const auto now = map::samplePath(track, track.predictions.front(), age_s);
  later.position.head<2>() = now.centre;
  later.position_covariance.topLeftCorner<2, 2>() = now.covariance;
  for (auto& path : later.predictions) {
    auto& points = path.points;
    points.erase(std::remove_if(points.begin(), points.end(),
                                [&](const auto& point) { return !(point.horizon_s > age_s); }),
                 points.end());
    for (auto& point : points) point.horizon_s -= age_s;
  }
  return later;
}

/// Whether a remembered track is seen to be gone: its place is free, and nothing is or may be
/// within its size of it, where its prediction may be wrong.
static bool isSeenGone(const Track& track, Time since, const map::MapQuery& query) {
  const Vector2d place = track.position.head<2>();
  if (!query.wasSeenFree(place, since)) return false;
  std::vector<Vector2d> around;
  appendOutline(map::footprintOf(track), place, track.yaw, {}, track.size.x(), around);
  return std::none_of(around.begin(), around.end(), [&](const Vector2d& beside) {
    const map::LocalState state = query.localAt(beside);
    return state == map::LocalState::kBlocked || state == map::LocalState::kEntered;
  });
}

std::vector<Track> TrackMemory::with(const std::vector<Track>& tracks, Time time,
                                     const Pose& T_map_odom, const map::MapQuery& query) {
  const Pose T_odom_map = T_map_odom.inverse(Eigen::Isometry);
  if (time < time_) remembered_.clear();  // the clock was set back
  time_ = time;
  const auto goes_on = [&](const Remembered& one) -> std::optional<Track> {
    const bool is_known = std::any_of(tracks.begin(), tracks.end(), [&](const Track& track) {
      return isShown(track) && track.id == one.track.id;
    });
    if (is_known || !(time - one.time <= hold_s_)) return std::nullopt;
    const auto later = advanced(one.track, time - one.time);
    if (!later) return std::nullopt;
    Track in_map = transformed(*later, T_map_odom);
    const Vector2d place = in_map.position.head<2>();
    if (isSeenGone(in_map, one.time, query)) return std::nullopt;
    const bool is_other = std::any_of(tracks.begin(), tracks.end(), [&](const Track& track) {
      return isShown(track) && (track.position.head<2>() - place).norm() < in_map.size.x();
    });
    return is_other ? std::nullopt : std::optional(in_map);
  };
  std::vector<Remembered> kept;
  std::vector<Track> all = tracks;
  for (const Remembered& one : remembered_) {
    auto later = goes_on(one);
    if (!later) continue;
    kept.push_back(one);
    all.push_back(std::move(*later));
  }
  for (const Track& track : tracks) {
    if (isMovingObstacle(track)) kept.push_back({transformed(track, T_odom_map), time});
  }
  remembered_ = std::move(kept);
  return all;
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
