#include <headway/map/contact_sum.h>
#include <headway/map/map_query.h>
#include <headway/map/path_sample.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace headway::map {
namespace {

using Eigen::Vector2d;
using mrpt::maps::COccupancyGridMap2D;

constexpr double kPathStep_s = 0.05;
constexpr double kClockSlack_s = 1e-6;
constexpr double kReachSigmas = 5.0;
constexpr double kVelocityStep_s = 0.1;
constexpr double kSlowest = 0.2;  ///< below this a path does not tell the heading [m/s]
constexpr double kAsLikelyAsNot = 0.5;
constexpr double kUnseenWithin = 0.01;  ///< of 0.5: a cell that nothing saw

bool isBelieved(const Track& track) {
  return isShown(track) && track.position.allFinite() && track.size.allFinite();
}

Obstacle obstacleOf(const Track& track, const PredictedPath& path, double horizon_s) {
  Obstacle obstacle;
  obstacle.id = track.id;
  obstacle.object_class = track.object_class;
  obstacle.shape = bodyOf(track);
  obstacle.height_m = track.size.z();
  obstacle.probability = path.probability;
  const PathSample here = samplePath(track, path, horizon_s);
  obstacle.centre = here.centre;
  obstacle.covariance = here.covariance;
  obstacle.velocity =
      (samplePath(track, path, horizon_s + kVelocityStep_s).centre - here.centre) / kVelocityStep_s;
  const bool tells_heading =
      isMoving(track) && horizon_s > 0.0 && obstacle.velocity.norm() > kSlowest;
  obstacle.yaw =
      tells_heading ? std::atan2(obstacle.velocity.y(), obstacle.velocity.x()) : track.yaw;
  return obstacle;
}

/// The believed tracks' possible places; a track without predictions stays where it is.
std::vector<Obstacle> obstaclesOf(const std::vector<Track>& tracks, double horizon_s) {
  static const std::vector<PredictedPath> kStays = {PredictedPath()};
  std::vector<Obstacle> obstacles;
  for (const auto& track : tracks) {
    if (!isBelieved(track)) continue;
    for (const auto& path : track.predictions.empty() ? kStays : track.predictions) {
      const Obstacle obstacle = obstacleOf(track, path, horizon_s);
      if (obstacle.centre.allFinite() && obstacle.covariance.allFinite()) {
        obstacles.push_back(obstacle);
      }
    }
  }
  return obstacles;
}

/// The probability that a body at a place touches an obstacle that is where it may be.
double contactProbability(const BodyShape& body, const Vector2d& place, double yaw,
                          const Obstacle& obstacle) {
  const double reach = body.radius() + obstacle.shape.radius() +
                       kReachSigmas * std::sqrt(std::max(0.0, obstacle.covariance.trace()));
  const Vector2d offset = obstacle.centre - place;
  if (!(offset.norm() < reach)) return 0.0;
  return probabilityInside(contactRegion(body, yaw, obstacle.shape, obstacle.yaw), offset,
                           obstacle.covariance);
}

TimedPose poseAt(const std::vector<TimedPose>& path, Time time) {
  const auto after = std::lower_bound(path.begin(), path.end(), time,
                                      [](const TimedPose& pose, Time t) { return pose.time < t; });
  if (after == path.end()) return {time, path.back().position, path.back().yaw};
  if (after == path.begin()) return {time, after->position, after->yaw};
  const TimedPose& a = *(after - 1);
  const TimedPose& b = *after;
  const double share = (time - a.time) / (b.time - a.time);
  return {time, a.position + share * (b.position - a.position),
          a.yaw + share * wrapAngle(b.yaw - a.yaw)};
}

bool covers(const BodyShape& body, const Vector2d& local) {
  const Vector2d half(0.5 * body.length_m, 0.5 * body.width_m);
  if (!body.round) return std::abs(local.x()) <= half.x() && std::abs(local.y()) <= half.y();
  return local.cwiseQuotient(half.cwiseMax(1e-9)).squaredNorm() <= 1.0;
}

}  // namespace

std::string_view toString(Answer answer) {
  switch (answer) {
    case Answer::kKnown:
      return "known";
    case Answer::kStaleMap:
      return "stale_map";
    case Answer::kEmptyMap:
      return "empty_map";
    case Answer::kUnknownPlace:
      return "unknown_place";
    case Answer::kUnknownTime:
      return "unknown_time";
  }
  return "unknown";
}

void MapQueryParams::describe(Params::Section section) {
  section.add("max_age_s", max_age_s, 0.0, 3600.0, "s", "Age from which a map is stale");
  section.add("horizon_s", horizon_s, 0.0, 60.0, "s", "Horizon of predictions");
  section.add("min_contact_probability", min_contact_probability, 0.0, 1.0, "",
              "Minimum probability of a contact that is reported");
}

MapQuery::MapQuery(PerceptionMap snapshot, Time now, const MapQueryParams& params)
    : map_(std::move(snapshot)), grid_(map_.staticGrid()), now_(now), params_(validated(params)) {
  // Not layers().isEmpty(): a grid whose cells were set one by one calls itself empty.
  if (map_.landmarks().empty() && map_.movingObjects().isEmpty() && grid_ == nullptr) {
    answer_ = Answer::kEmptyMap;
  } else if (!(std::abs(age_s()) <= params_.max_age_s)) {
    answer_ = Answer::kStaleMap;
  } else {
    answer_ = Answer::kKnown;
  }
}

Answer MapQuery::answerAt(Time time) const {
  if (answer_ != Answer::kKnown) return answer_;
  const bool reached = time >= now_ - kClockSlack_s &&
                       time <= map_.movingObjects().time() + params_.horizon_s + kClockSlack_s;
  return reached ? Answer::kKnown : Answer::kUnknownTime;
}

std::optional<double> MapQuery::stillAt(double x, double y) const {
  const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
  if (grid_ == nullptr || !(fx >= grid_->getXMin() && fx < grid_->getXMax() &&
                            fy >= grid_->getYMin() && fy < grid_->getYMax())) {
    return std::nullopt;
  }
  const double occupied = 1.0 - static_cast<double>(grid_->getPos(fx, fy));
  return std::abs(occupied - 0.5) < kUnseenWithin ? std::nullopt : std::optional(occupied);
}

Occupancy MapQuery::occupancyAt(double x, double y, Time time) const {
  Occupancy occupancy;
  occupancy.answer = answerAt(time);
  const auto still = stillAt(x, y);
  if (still) {
    occupancy.still = *still;
  } else if (occupancy.answer == Answer::kKnown) {
    occupancy.answer = Answer::kUnknownPlace;
  }
  ContactSum contacts;
  for (const auto& obstacle :
       obstaclesOf(map_.movingObjects().tracks(), time - map_.movingObjects().time())) {
    contacts.add(obstacle.id, obstacle.probability,
                 contactProbability(BodyShape(), {x, y}, 0.0, obstacle));
  }
  occupancy.moving = contacts.total();
  occupancy.probability = 1.0 - (1.0 - occupancy.still) * (1.0 - occupancy.moving);
  return occupancy;
}

Obstacles MapQuery::obstaclesAt(Time time) const {
  return {answerAt(time),
          obstaclesOf(map_.movingObjects().tracks(), time - map_.movingObjects().time())};
}

NearTracks MapQuery::tracksNear(const Vector2d& place, double radius_m, Time time) const {
  NearTracks near;
  near.answer = answerAt(time);
  std::optional<TrackId> last;
  for (const auto& obstacle : obstaclesAt(time).items) {
    if (last && *last == obstacle.id) continue;  // a less probable future
    last = obstacle.id;
    const Vector2d local = Eigen::Rotation2Dd(-obstacle.yaw) * (place - obstacle.centre);
    const BodyShape& body = obstacle.shape;
    const Vector2d half(0.5 * body.length_m, 0.5 * body.width_m);
    const Vector2d direction = local.norm() > 0.0 ? Vector2d(local.normalized()) : Vector2d(1, 0);
    const double distance =
        body.round ? std::max(0.0, local.norm() - direction.dot(body.supportPoint(direction)))
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

MapQuery::StillContact MapQuery::stillUnder(const TimedPose& pose, const BodyShape& body) const {
  if (grid_ == nullptr) return {0.0, true};
  StillContact contact;
  const double cell = static_cast<double>(grid_->getResolution());
  const int reach = static_cast<int>(std::ceil(body.radius() / cell));
  const Eigen::Rotation2Dd turn(pose.yaw);
  for (int i = -reach; i <= reach; ++i) {
    for (int j = -reach; j <= reach; ++j) {
      const Vector2d local(i * cell, j * cell);
      if ((i != 0 || j != 0) && !covers(body, local)) continue;
      const Vector2d place = pose.position + turn * local;
      const auto occupied = stillAt(place.x(), place.y());
      if (occupied) contact.occupied = std::max(contact.occupied, *occupied);
      if (!occupied) contact.unknown = true;
    }
  }
  return contact;
}

void MapQuery::lookAt(const TimedPose& pose, const BodyShape& body, Collision& collision) const {
  const double from_now = pose.time - now_;
  const StillContact still = stillUnder(pose, body);
  Answer answer = answerAt(pose.time);
  if (answer == Answer::kKnown && still.unknown) answer = Answer::kUnknownPlace;
  if (answer != Answer::kKnown && !collision.unknown_from_s) {
    collision.unknown_from_s = from_now;
    collision.answer = answer;
  }
  ContactSum contacts;
  for (const auto& obstacle :
       obstaclesOf(map_.movingObjects().tracks(), pose.time - map_.movingObjects().time())) {
    contacts.add(obstacle.id, obstacle.probability,
                 contactProbability(body, pose.position, pose.yaw, obstacle));
  }
  const double moving = contacts.total();
  // Cells less occupied than not are the grid's own noise, not something to meet.
  const double blocked = still.occupied > kAsLikelyAsNot ? still.occupied : 0.0;
  const double probability = 1.0 - (1.0 - moving) * (1.0 - blocked);
  if (probability >= params_.min_contact_probability && !collision.earliest_s) {
    collision.earliest_s = from_now;
  }
  if (probability >= kAsLikelyAsNot && !collision.likely_s) collision.likely_s = from_now;
  if (probability <= collision.probability) return;
  collision.probability = probability;
  collision.worst_s = from_now;
  collision.with = moving >= blocked ? contacts.mostProbable() : std::nullopt;
}

Collision MapQuery::timeToCollision(const BodyShape& body,
                                    const std::vector<TimedPose>& path) const {
  Collision collision;
  collision.answer = answer_;
  if (path.empty()) return collision;
  const Time end = path.back().time;
  for (int i = 0;; ++i) {
    const Time time = now_ + i * kPathStep_s;
    lookAt(poseAt(path, time), body, collision);
    if (!(time < end) || answerAt(time) != Answer::kKnown) return collision;
  }
}

MapQuery PerceptionMap::at(Time now) const { return {*this, now}; }

}  // namespace headway::map
