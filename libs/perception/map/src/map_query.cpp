// SPDX-License-Identifier: BSD-3-Clause
// Questions about the map at present and future times: occupancy, obstacles, time to collision.
#include <headway/map/contact_probability.h>
#include <headway/map/map_query.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace headway::map {
namespace {

using Eigen::Vector2d;
using mrpt::maps::COccupancyGridMap2D;

constexpr double kPathStep_s = 0.05;        // as the header states
constexpr double kClockTolerance_s = 1e-6;  // of sums of doubles
constexpr double kVelocityStep_s = 0.1;     // of differences
constexpr double kMinHeadingSpeed = 0.2;    // [m/s], at which a path defines the heading
constexpr double kUnseenTolerance = 0.01;   // about 0.5: the cell has never been observed
constexpr double kSeenNow = 0.95;           // probability of what the newest frames show
constexpr double kLeaves_s = 0.3;           // after which what moves is where it is predicted
constexpr double kMoverMargin_m = 0.25;     // around its footprint, of what the frames show of it

bool isUsable(const Track& track) {
  return isShown(track) && track.position.allFinite() && track.size.allFinite();
}

Obstacle obstacleOf(const Track& track, const PredictedPath& path, double horizon_s) {
  Obstacle obstacle;
  obstacle.id = track.id;
  obstacle.object_class = track.object_class;
  obstacle.shape = footprintOf(track);
  obstacle.height_m = track.size.z();
  obstacle.probability = path.probability;
  const PathSample here = samplePath(track, path, horizon_s);
  obstacle.centre = here.centre;
  obstacle.covariance = here.covariance;
  obstacle.velocity =
      (samplePath(track, path, horizon_s + kVelocityStep_s).centre - here.centre) / kVelocityStep_s;
  const bool path_has_heading =
      isMoving(track) && horizon_s > 0.0 && obstacle.velocity.norm() > kMinHeadingSpeed;
  obstacle.yaw =
      path_has_heading ? std::atan2(obstacle.velocity.y(), obstacle.velocity.x()) : track.yaw;
  return obstacle;
}

/// The possible places of all usable tracks; a track without predictions keeps its position.
std::vector<Obstacle> obstaclesOf(const std::vector<Track>& tracks, double horizon_s) {
  static const std::vector<PredictedPath> kStays = {PredictedPath()};
  std::vector<Obstacle> obstacles;
  for (const auto& track : tracks) {
    if (!isUsable(track)) continue;
    for (const auto& path : track.predictions.empty() ? kStays : track.predictions) {
      const Obstacle obstacle = obstacleOf(track, path, horizon_s);
      if (obstacle.centre.allFinite() && obstacle.covariance.allFinite()) {
        obstacles.push_back(obstacle);
      }
    }
  }
  return obstacles;
}

/// The probability that a footprint at a place overlaps an obstacle of uncertain position.
double contactProbability(const FootprintShape& footprint, const Vector2d& place, double yaw,
                          const Obstacle& obstacle) {
  const double reach = footprint.radius() + obstacle.shape.radius() +
                       kContactSigmas * std::sqrt(std::max(0.0, obstacle.covariance.trace()));
  const Vector2d offset = obstacle.centre - place;
  if (!(offset.norm() < reach)) return 0.0;
  return probabilityInside(contactRegion(footprint, yaw, obstacle.shape, obstacle.yaw), offset,
                           obstacle.covariance);
}

TimedPose poseAt(const std::vector<TimedPose>& path, Time time) {
  const auto after = std::lower_bound(path.begin(), path.end(), time,
                                      [](const TimedPose& pose, Time t) { return pose.time < t; });
  if (after == path.end()) return {time, path.back().position, path.back().yaw};
  if (after == path.begin()) return {time, after->position, after->yaw};
  const TimedPose& a = *(after - 1);
  const TimedPose& b = *after;
  const double ratio = (time - a.time) / (b.time - a.time);
  return {time, a.position + ratio * (b.position - a.position),
          a.yaw + ratio * wrapAngle(b.yaw - a.yaw)};
}

double yawOf(const Eigen::Isometry2d& T) { return std::atan2(T(1, 0), T(0, 0)); }

Eigen::Isometry2d fromAbove(const Pose& pose) {
  return Eigen::Translation2d(pose.translation().head<2>()) *
         Eigen::Rotation2Dd(headway::yawOf(pose));
}

/// The obstacle in another frame.
Obstacle transformed(Obstacle obstacle, const Eigen::Isometry2d& T_to_from) {
  const Eigen::Matrix2d R = T_to_from.linear();
  obstacle.centre = T_to_from * obstacle.centre;
  obstacle.covariance = R * obstacle.covariance * R.transpose();
  obstacle.velocity = R * obstacle.velocity;
  obstacle.yaw = wrapAngle(obstacle.yaw + yawOf(T_to_from));
  return obstacle;
}

bool covers(const FootprintShape& footprint, const Vector2d& local) {
  const Vector2d half(0.5 * footprint.length_m, 0.5 * footprint.width_m);
  if (!footprint.round) return std::abs(local.x()) <= half.x() && std::abs(local.y()) <= half.y();
  return local.cwiseQuotient(half.cwiseMax(1e-9)).squaredNorm() <= 1.0;
}

}  // namespace

std::string_view toString(QueryStatus status) {
  switch (status) {
    case QueryStatus::kKnown:
      return "known";
    case QueryStatus::kStaleMap:
      return "stale_map";
    case QueryStatus::kEmptyMap:
      return "empty_map";
    case QueryStatus::kUnknownPlace:
      return "unknown_place";
    case QueryStatus::kUnknownTime:
      return "unknown_time";
  }
  return "unknown";
}

void MapQueryParams::describe(Params::Section section) {
  section.add("max_age_s", max_age_s, 0.0, 3600.0, "s", "Age from which a map is stale");
  section.add("horizon_s", horizon_s, 0.0, 60.0, "s", "Horizon of predictions");
  section.add("min_contact_probability", min_contact_probability, 0.0, 1.0, "",
              "Minimum probability of a contact that is reported");
  section.add("caution", caution, 0.0, 1.0, "",
              "How long, and how far round it, what was seen to leave the view still blocks");
}

MapQuery::MapQuery(PerceptionMap snapshot, Time now, const MapQueryParams& params,
                   const Eigen::Isometry2d& T_map_asked)
    : map_(std::move(snapshot)),
      grid_(map_.staticGrid()),
      now_(now),
      params_(validated(params)),
      T_map_asked_(T_map_asked),
      T_odom_map_(fromAbove(map_.odometryFrame()).inverse()) {
  // layers().isEmpty() is true for a grid whose cells were set one by one.
  if (map_.landmarks().empty() && map_.movingObjects().isEmpty() && grid_ == nullptr &&
      map_.local() == nullptr) {
    status_ = QueryStatus::kEmptyMap;
  } else if (!(std::abs(age_s()) <= params_.max_age_s)) {
    status_ = QueryStatus::kStaleMap;
  } else {
    status_ = QueryStatus::kKnown;
  }
}

QueryStatus MapQuery::statusAt(Time time) const {
  if (status_ != QueryStatus::kKnown) return status_;
  const bool reached = time >= now_ - kClockTolerance_s &&
                       time <= map_.movingObjects().time() + params_.horizon_s + kClockTolerance_s;
  return reached ? QueryStatus::kKnown : QueryStatus::kUnknownTime;
}

std::optional<double> MapQuery::staticOccupancyAt(const Vector2d& place) const {
  const auto fx = static_cast<float>(place.x()), fy = static_cast<float>(place.y());
  if (grid_ == nullptr || !(fx >= grid_->getXMin() && fx < grid_->getXMax() &&
                            fy >= grid_->getYMin() && fy < grid_->getYMax())) {
    return std::nullopt;
  }
  const double occupied = 1.0 - static_cast<double>(grid_->getPos(fx, fy));
  return std::abs(occupied - 0.5) < kUnseenTolerance ? std::nullopt : std::optional(occupied);
}

bool MapQuery::isOnMover(const Vector2d& place) const {
  const auto& tracks = map_.movingObjects().tracks();
  return std::any_of(tracks.begin(), tracks.end(), [&](const Track& track) {
    if (!isUsable(track) || !isMoving(track)) return false;
    FootprintShape grown = footprintOf(track);
    grown.length_m += 2.0 * kMoverMargin_m;
    grown.width_m += 2.0 * kMoverMargin_m;
    return covers(grown, Eigen::Rotation2Dd(-track.yaw) * (place - track.position.head<2>()));
  });
}

std::optional<double> MapQuery::groundAt(const Vector2d& place, Time time) const {
  if (map_.local() == nullptr) return staticOccupancyAt(place);
  switch (map_.local()->at(T_odom_map_ * place, now_, params_.caution)) {
    case LocalState::kBlocked:
      if (time - now_ >= kLeaves_s && isOnMover(place)) return staticOccupancyAt(place);
      return kSeenNow;
    case LocalState::kFree:
      return 1.0 - kSeenNow;
    case LocalState::kUnknown:
    case LocalState::kEntered:
      return std::nullopt;
    case LocalState::kNotInView:
      break;
  }
  return staticOccupancyAt(place);
}

LocalState MapQuery::localAt(const Vector2d& place, double within_s) const {
  if (map_.local() == nullptr) return LocalState::kNotInView;
  return map_.local()->at(T_odom_map_ * (T_map_asked_ * place), now_, params_.caution, within_s);
}

bool MapQuery::wasSeenFree(const Vector2d& place, Time since) const {
  return map_.local() != nullptr && map_.local()->wasSeenFree(T_odom_map_ * (T_map_asked_ * place),
                                                              since, now_, params_.caution);
}

LocalState MapQuery::groundNow(const Vector2d& place, double within_s) const {
  if (status_ != QueryStatus::kKnown) return LocalState::kUnknown;
  const LocalState now = localAt(place, within_s);
  if (now != LocalState::kNotInView) return now;
  const auto occupied = staticOccupancyAt(T_map_asked_ * place);
  return occupied && *occupied < 0.5 ? LocalState::kFree : now;
}

std::vector<Vector2d> MapQuery::blockedNow() const {
  if (map_.local() == nullptr) return {};
  auto places = map_.local()->blocked(now_, params_.caution);
  const Eigen::Isometry2d T_asked_odom = (T_odom_map_ * T_map_asked_).inverse();
  for (Vector2d& place : places) place = T_asked_odom * place;
  return places;
}

Occupancy MapQuery::occupancyAt(double x, double y, Time time) const {
  Occupancy occupancy;
  occupancy.status = statusAt(time);
  const Vector2d place = T_map_asked_ * Vector2d(x, y);
  const auto occupied = groundAt(place, time);
  if (occupied) {
    occupancy.static_probability = *occupied;
  } else if (occupancy.status == QueryStatus::kKnown) {
    occupancy.status = QueryStatus::kUnknownPlace;
  }
  ContactSum contacts;
  for (const auto& obstacle :
       obstaclesOf(map_.movingObjects().tracks(), time - map_.movingObjects().time())) {
    contacts.add(obstacle.id, obstacle.probability,
                 contactProbability(FootprintShape(), place, 0.0, obstacle));
  }
  occupancy.moving_probability = contacts.total();
  occupancy.probability =
      1.0 - (1.0 - occupancy.static_probability) * (1.0 - occupancy.moving_probability);
  return occupancy;
}

Obstacles MapQuery::obstaclesAt(Time time) const {
  Obstacles obstacles{statusAt(time), obstaclesOf(map_.movingObjects().tracks(),
                                                  time - map_.movingObjects().time())};
  const Eigen::Isometry2d T_asked_map = T_map_asked_.inverse();
  for (Obstacle& obstacle : obstacles.items) obstacle = transformed(obstacle, T_asked_map);
  return obstacles;
}

NearTracks MapQuery::tracksNear(const Vector2d& place, double radius_m, Time time) const {
  NearTracks near;
  near.status = statusAt(time);
  std::optional<TrackId> last;
  for (const auto& obstacle : obstaclesAt(time).items) {
    if (last && *last == obstacle.id) continue;  // a less probable path
    last = obstacle.id;
    const Vector2d local = Eigen::Rotation2Dd(-obstacle.yaw) * (place - obstacle.centre);
    const FootprintShape& footprint = obstacle.shape;
    const Vector2d half(0.5 * footprint.length_m, 0.5 * footprint.width_m);
    const Vector2d direction = local.norm() > 0.0 ? Vector2d(local.normalized()) : Vector2d(1, 0);
    const double distance =
        footprint.round
            ? std::max(0.0, local.norm() - direction.dot(footprint.supportPoint(direction)))
            : (local.cwiseAbs() - half).cwiseMax(0.0).norm();
    if (!(distance <= radius_m)) continue;
    const Vector2d along = Eigen::Rotation2Dd(obstacle.yaw) * direction;
    near.items.push_back(
        {obstacle, distance, std::sqrt(std::max(0.0, along.dot(obstacle.covariance * along)))});
  }
  std::stable_sort(
      near.items.begin(), near.items.end(),
      [](const NearTrack& a, const NearTrack& b) { return a.distance_m < b.distance_m; });
  return near;
}

MapQuery::StaticContact MapQuery::staticContact(const TimedPose& pose,
                                                const FootprintShape& footprint) const {
  const auto& newest = map_.local();
  if (grid_ == nullptr && newest == nullptr) return {0.0, true};
  StaticContact contact;
  const double cell =
      newest != nullptr ? newest->cell_m() : static_cast<double>(grid_->getResolution());
  const int reach = static_cast<int>(std::ceil(footprint.radius() / cell));
  const Eigen::Rotation2Dd rotation(pose.yaw);
  for (int i = -reach; i <= reach; ++i) {
    for (int j = -reach; j <= reach; ++j) {
      const Vector2d local(i * cell, j * cell);
      if ((i != 0 || j != 0) && !covers(footprint, local)) continue;
      const Vector2d place = pose.position + rotation * local;
      const auto occupied = groundAt(place, pose.time);
      if (occupied) contact.occupied = std::max(contact.occupied, *occupied);
      if (!occupied) contact.unknown = true;
    }
  }
  return contact;
}

void MapQuery::checkPose(const TimedPose& pose, const FootprintShape& footprint,
                         Collision& collision) const {
  const double from_now = pose.time - now_;
  const StaticContact under = staticContact(pose, footprint);
  QueryStatus status = statusAt(pose.time);
  if (status == QueryStatus::kKnown && under.unknown) status = QueryStatus::kUnknownPlace;
  if (status != QueryStatus::kKnown && !collision.unknown_from_s) {
    collision.unknown_from_s = from_now;
    collision.status = status;
  }
  ContactSum contacts;
  for (const auto& obstacle :
       obstaclesOf(map_.movingObjects().tracks(), pose.time - map_.movingObjects().time())) {
    contacts.add(obstacle.id, obstacle.probability,
                 contactProbability(footprint, pose.position, pose.yaw, obstacle));
  }
  const double moving = contacts.total();
  // Cells below 0.5 are noise of the grid, not obstacles.
  const double blocked = under.occupied > 0.5 ? under.occupied : 0.0;
  const double probability = 1.0 - (1.0 - moving) * (1.0 - blocked);
  if (probability >= params_.min_contact_probability && !collision.earliest_s) {
    collision.earliest_s = from_now;
  }
  if (probability >= 0.5 && !collision.likely_s) collision.likely_s = from_now;
  if (probability <= collision.probability) return;
  collision.probability = probability;
  collision.worst_s = from_now;
  collision.with = moving >= blocked ? contacts.mostProbable() : std::nullopt;
}

Collision MapQuery::timeToCollision(const FootprintShape& footprint,
                                    const std::vector<TimedPose>& path) const {
  Collision collision;
  collision.status = status_;
  if (path.empty()) return collision;
  std::vector<TimedPose> in_map = path;
  for (TimedPose& pose : in_map) {
    pose.position = T_map_asked_ * pose.position;
    pose.yaw += yawOf(T_map_asked_);
  }
  const Time end = path.back().time;
  for (int i = 0;; ++i) {
    const Time time = now_ + i * kPathStep_s;
    checkPose(poseAt(in_map, time), footprint, collision);
    if (!(time < end) || statusAt(time) != QueryStatus::kKnown) return collision;
  }
}

MapQuery PerceptionMap::at(Time now) const { return {*this, now}; }

MapQuery PerceptionMap::inOdometryAt(Time now) const {
  return {*this, now, {}, fromAbove(T_map_odom_)};
}

}  // namespace headway::map
