// SPDX-License-Identifier: BSD-3-Clause
// Moving objects of a frame by motion alone: clusters of points and segments, overlaps merged,
// pieces joined.
#include "moving_object_finder.h"

#include <headway/core/box_overlap.h>
#include <headway/core/statistics.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "appearance.h"
#include "object_extent.h"
#include "point_motion.h"
#include "segment_follower.h"

namespace headway::detect {
namespace {

constexpr double kMargin = 0.1;     // around the footprint [m]
constexpr double kLookAhead = 0.1;  // of motion by which the footprint is extended [s]
constexpr double kBehind = 1.0;     // depth beyond which an overlap in the image is background [m]
constexpr double kSameVelocity = 0.3;      // ratio of the difference between parts of one object
constexpr double kMinDirectedSpeed = 0.5;  // from which the direction is known [m/s]

bool moveTogether(const PointMotion& a, const PointMotion& b, double depth,
                  const Eigen::Vector3d& up, const ClusterParams& params) {
  const double reach = params.reach_m + params.reach_per_m * depth;
  if (overGround(a.point - b.point, up).norm() > reach) return false;
  const Eigen::Vector3d difference = overGround(a.velocity - b.velocity, up);
  const double size = difference.norm();
  const Eigen::Vector3d direction = difference / std::max(1e-9, size);
  const double sigma =
      std::sqrt(direction.dot((a.velocity_covariance + b.velocity_covariance) * direction));
  const double speed = 0.5 * (a.velocity.norm() + b.velocity.norm());
  return size < std::max(params.speed_difference, params.speed_ratio * speed) + 2.0 * sigma;
}

// Of a newcomer that is not known to move.
MeasuredVelocity unknownVelocity() {
  const double prior = SegmentMotionParams().speed_prior;
  return {Eigen::Vector3d::Zero(), prior * prior * Eigen::Matrix3d::Identity()};
}

// Whether it was seen in more than two frames at 10 Hz: wrong matches do not last.
bool lasts(const SegmentTrack& segment, const MotionFrame& frame) {
  if (segment.track.observations.empty()) return false;
  const Time first = frame.path.timeOf(segment.track.observations.front().frame);
  return frame.path.timeOf(frame.path.newest()) - first > SegmentMotionParams().min_flow_time_s;
}

// Disjoint sets, each named by its lowest index. cv::partition would test every pair twice.
class Sets {
 public:
  explicit Sets(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
  }
  std::size_t find(std::size_t i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) {
    a = find(a);
    b = find(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parents_;
};

// Mean of the members' velocities, each weighted by how well it is known.
void setVelocity(const std::vector<PointTrack>& points, const Eigen::Vector3d& up,
                 MotionCluster& cluster) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::size_t i : cluster.members) {
    const Eigen::Matrix3d weight =
        (points[i].motion->velocity_covariance + 0.04 * Eigen::Matrix3d::Identity()).inverse();
    information += weight;
    sum += weight * points[i].motion->velocity;
  }
  cluster.velocity_covariance = information.inverse();
  cluster.velocity = overGround(cluster.velocity_covariance * sum, up);
}

// Directive 96/53/EC: an articulated vehicle.
constexpr double kMaxLength = 16.5;      // [m]
constexpr double kMaxWidth = 2.6;        // [m]
constexpr double kWidthPerLength = 0.1;  // by an error of the direction of motion [m/m]
constexpr double kTouch = 0.5;           // greatest gap between pieces [m]
constexpr double kVelocityRatio = 0.05;  // of a speed, error common to a piece [-]

double gap(const Range& a, const Range& b) { return std::max({0.0, a.min - b.max, b.min - a.max}); }

Range both(const Range& a, const Range& b) {
  return {std::min(a.min, b.min), std::max(a.max, b.max)};
}

/// What is seen of an object, along its motion and across it.
struct Seen {
  Range along, across;
};

Seen seenOf(const std::vector<ObjectCell>& cells, const Eigen::Vector3d& front,
            const Eigen::Vector3d& up) {
  const Eigen::Vector3d side = up.cross(front);
  Seen seen;
  for (const auto& cell : cells) {
    seen.along.add(front.dot(cell.point));
    seen.across.add(side.dot(cell.point));
  }
  return seen;
}

std::vector<ObjectCell> cellsOf(const MovingObject& object, const stereo::DisparityImage& disparity,
                                const StereoCamera& camera) {
  std::vector<ObjectCell> cells;
  for (const auto& place : object.extent.cells) {
    const auto point = triangulate(
        {disparity.pixelOf(place.x), disparity.pixelOf(place.y), disparity.values.at<float>(place)},
        camera);
    if (point) cells.push_back({place, *point});
  }
  return cells;
}

bool isFastVehicle(const MovingObject& a, const MovingObject& b) {
  return a.evidence.motion && b.evidence.motion &&
         std::min(a.velocity.value.norm(), b.velocity.value.norm()) > kFastestWalker &&
         (isVehicle(a.extent.object_class) || isVehicle(b.extent.object_class));
}

bool moveAlike(const MovingObject& a, const MovingObject& b, const Eigen::Vector3d& up) {
  const Eigen::Vector3d difference = a.velocity.value - b.velocity.value;
  const double common = kVelocityRatio * std::max(a.velocity.value.norm(), b.velocity.value.norm());
  // Along the ground; velocities have no part across it.
  const Eigen::Matrix3d covariance = a.velocity.covariance + b.velocity.covariance +
                                     common * common * Eigen::Matrix3d::Identity() +
                                     up * up.transpose();
  return difference.dot(covariance.inverse() * difference) < chiSquare99(2);
}

MeasuredVelocity meanOf(const MeasuredVelocity& a, const MeasuredVelocity& b,
                        const Eigen::Vector3d& up) {
  const Eigen::Matrix3d upright = up * up.transpose();  // singular otherwise
  const Eigen::Matrix3d of_a = (a.covariance + upright).inverse();
  const Eigen::Matrix3d of_b = (b.covariance + upright).inverse();
  const Eigen::Matrix3d covariance = (of_a + of_b).inverse();
  const Eigen::Vector3d mean = covariance * (of_a * a.value + of_b * b.value);
  return {mean - up * up.dot(mean), covariance};
}

class Joiner {
 public:
  Joiner(const MotionFrame& frame, const StereoCamera& camera) : frame_(frame), camera_(camera) {}

  /// nullopt if the two are not pieces of one vehicle.
  [[nodiscard]] std::optional<MovingObject> joined(const MovingObject& a,
                                                   const MovingObject& b) const {
    if (!isFastVehicle(a, b) || !moveAlike(a, b, frame_.up)) return std::nullopt;
    const auto velocity = meanOf(a.velocity, b.velocity, frame_.up);
    const Eigen::Matrix3d R_cam_world = frame_.path.T_cam_world(frame_.path.newest()).linear();
    auto cells = cellsOf(a, frame_.disparity, camera_);
    const auto more = cellsOf(b, frame_.disparity, camera_);
    const Eigen::Vector3d front = (R_cam_world * velocity.value).normalized();
    const Eigen::Vector3d up = R_cam_world * frame_.up;
    const double depth = std::max(a.extent.surface.z(), b.extent.surface.z());
    if (!areOne(seenOf(cells, front, up), seenOf(more, front, up), depth)) return std::nullopt;
    cells.insert(cells.end(), more.begin(), more.end());
    auto extent = extentOf(cells, rotated(velocity, R_cam_world), frame_.disparity, camera_,
                           floorUnder(cells));
    if (!extent) return std::nullopt;
    MovingObject whole = a.points < b.points ? b : a;
    const MovingObject& other = a.points < b.points ? a : b;
    whole.extent = std::move(*extent);
    whole.velocity = velocity;
    whole.first_frame = std::min(a.first_frame, b.first_frame);
    whole.points += other.points;
    whole.members.insert(whole.members.end(), other.members.begin(), other.members.end());
    whole.segments.insert(whole.segments.end(), other.segments.begin(), other.segments.end());
    return whole;
  }

 private:
  [[nodiscard]] bool areOne(const Seen& a, const Seen& b, double depth) const {
    const double noise = kCellSigma * depth * depth / (camera_.fx * camera_.baseline_m);
    if (std::hypot(gap(a.along, b.along), gap(a.across, b.across)) > kTouch + noise) return false;
    const double length = both(a.along, b.along).size();
    const double width = both(a.across, b.across).size();
    return length < kMaxLength && width < kMaxWidth + kWidthPerLength * length + noise;
  }

  [[nodiscard]] stereo::GroundPlane floorUnder(const std::vector<ObjectCell>& cells) const {
    if (frame_.ground) return *frame_.ground;
    std::vector<Eigen::Vector3d> points;
    for (const auto& cell : cells) points.push_back(cell.point);
    return floorBelow(points, camera_);
  }

  const MotionFrame& frame_;
  const StereoCamera& camera_;
};

}  // namespace

bool isPartOf(const ObjectExtent& part, const MovingObject& object) {
  const ObjectExtent& whole = object.extent;
  const Eigen::Vector3d off = part.box.centre - whole.box.centre;
  const double behind = 0.5 * whole.box.length + kBehind + kGatePerMetre * whole.box.centre.z();
  const bool seen_there =
      ratioInside(part.box2d, whole.box2d) > 0.5 || overlap2d(part.box2d, whole.box2d) > 0.3;
  if (seen_there && off.norm() < behind) return true;
  const double margin = kMargin + kLookAhead * object.velocity.value.norm();
  const Eigen::Vector3d front = frontOf(whole.box);
  const auto covers = [&](const Eigen::Vector3d& place) {
    const Eigen::Vector3d to = place - whole.box.centre;
    return std::abs(front.dot(to)) < 0.5 * whole.box.length + margin &&
           std::abs(front.cross(to).y()) < 0.5 * whole.box.width + margin;
  };
  // The box of a part is completed to a usual size behind what is visible, so both are tried.
  return covers(part.box.centre) || covers(part.surface);
}

bool isPartOfAny(const ObjectExtent& part, const std::vector<MovingObject>& objects) {
  return std::any_of(objects.begin(), objects.end(),
                     [&](const MovingObject& object) { return isPartOf(part, object); });
}

bool isAsFast(const Eigen::Vector3d& velocity, const Eigen::Vector3d& other) {
  return (velocity - other).norm() < kSameVelocity * std::max(velocity.norm(), other.norm());
}

bool isOpposite(const Eigen::Vector3d& velocity, const Eigen::Vector3d& other) {
  return velocity.dot(other) < 0.0 && velocity.norm() > kMinDirectedSpeed &&
         other.norm() > kMinDirectedSpeed;
}

std::vector<MotionCluster> clusterMotion(const std::vector<PointTrack>& points,
                                         const std::vector<PointClass>& classes,
                                         const CameraPath& path, const Eigen::Vector3d& up,
                                         const ClusterParams& params) {
  std::vector<std::size_t> moving;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (classes[i] == PointClass::kMoving) moving.push_back(i);
  }
  Sets sets(moving.size());
  for (std::size_t a = 0; a < moving.size(); ++a) {
    const PointMotion& motion = *points[moving[a]].motion;
    const double depth = (path.T_cam_world(path.newest()) * motion.point).z();
    for (std::size_t b = a + 1; b < moving.size(); ++b) {
      if (moveTogether(motion, *points[moving[b]].motion, depth, up, params)) sets.join(a, b);
    }
  }
  std::vector<MotionCluster> clusters(moving.size());
  for (std::size_t a = 0; a < moving.size(); ++a) {
    clusters[sets.find(a)].members.push_back(moving[a]);
  }
  std::vector<MotionCluster> accepted;
  for (auto& cluster : clusters) {
    if (static_cast<int>(cluster.members.size()) < params.min_points) continue;
    setVelocity(points, up, cluster);
    accepted.push_back(std::move(cluster));
  }
  return accepted;
}

double movingRatio(const std::vector<PointTrack>& points, const std::vector<PointClass>& classes,
                   const CameraPath& path, const Box2d& outline, double nearest, double farthest) {
  const double margin = 0.3 + kGatePerMetre * farthest;
  double moving = 0.0;
  double static_points = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (classes[i] != PointClass::kMoving && classes[i] != PointClass::kStatic) continue;
    const auto& uvd = points[i].observations.back().uvd;
    const double depth = (path.T_cam_world(path.newest()) * points[i].motion->point).z();
    if (!outline.contains(uvd.x(), uvd.y()) || depth < nearest - margin ||
        depth > farthest + margin) {
      continue;
    }
    (classes[i] == PointClass::kMoving ? moving : static_points) += 1.0;
  }
  return moving + static_points > 0.0 ? moving / (moving + static_points) : 1.0;
}

PointClassParams pointClassParams(const StereoMotionParams& params) {
  PointClassParams point_class;
  point_class.significance = params.significance;
  point_class.min_speed = params.min_speed_mps;
  point_class.max_speed = params.max_speed_mps;
  return point_class;
}

std::vector<MovingObject> MovingObjectFinder::find(const MotionFrame& frame,
                                                   std::vector<SegmentTrack>& segments) {
  std::vector<MovingObject> objects;
  if (frame.ground) addSegments(frame, true, segments, objects);
  addClusters(frame, objects);
  if (frame.ground) addSegments(frame, false, segments, objects);
  return objects;
}

std::size_t MovingObjectFinder::takeImplausible() { return std::exchange(implausible_, 0); }

void MovingObjectFinder::addClusters(const MotionFrame& frame, std::vector<MovingObject>& objects) {
  ClusterParams params;
  params.reach_m = params_.max_point_distance_m;
  params.min_points = params_.min_points;
  const int now = frame.path.newest();
  const Pose& T_cam_world = frame.path.T_cam_world(now);
  for (const auto& cluster :
       clusterMotion(frame.points, frame.classes, frame.path, frame.up, params)) {
    const MeasuredVelocity velocity{cluster.velocity, cluster.velocity_covariance};
    if (!isFast(velocity, frame.points[cluster.members.front()], frame)) continue;
    std::vector<Eigen::Vector3d> seeds;
    for (const std::size_t i : cluster.members)
      seeds.push_back(T_cam_world * frame.points[i].motion->point);
    const stereo::GroundPlane floor = frame.ground.value_or(floorBelow(seeds, camera_));
    auto extent = plausibleExtent(growObject(seeds, frame.disparity, camera_, floor), velocity,
                                  floor, params_.min_moving_ratio, frame);
    if (!extent) continue;
    if (repeatsAlongRows(frame.image, extent->cells)) {
      ++implausible_;
      continue;
    }
    const auto known =
        std::find_if(objects.begin(), objects.end(), [&](const MovingObject& object) {
          return (object.evidence.change || isAsFast(cluster.velocity, object.velocity.value)) &&
                 isPartOf(*extent, object);
        });
    if (known != objects.end()) {
      known->members.insert(known->members.end(), cluster.members.begin(), cluster.members.end());
      continue;
    }
    MovingObject object;
    object.evidence.motion = true;
    object.extent = std::move(*extent);
    object.velocity = velocity;
    object.first_frame = frame.path.firstSince(frame.path.timeOf(now) - params_.window_s);
    object.points = static_cast<int>(cluster.members.size());
    object.members = cluster.members;
    objects.push_back(std::move(object));
  }
}

void MovingObjectFinder::addSegments(const MotionFrame& frame, bool newcomers,
                                     std::vector<SegmentTrack>& segments,
                                     std::vector<MovingObject>& objects) {
  for (auto& segment : segments) {
    if (segment.last_frame != frame.path.newest() || segment.segment.is_new != newcomers) continue;
    auto velocity = velocityOf(segment, frame);
    const bool moves = velocity.has_value();
    if (!moves && newcomers && lasts(segment, frame)) velocity = unknownVelocity();
    if (!velocity) continue;
    auto extent = plausibleExtent(segment.segment.cells, *velocity, *frame.ground, 0.0, frame);
    if (!extent) continue;
    if (repeatsAlongRows(frame.image, extent->cells)) {
      ++implausible_;
      continue;
    }
    const auto known =
        std::find_if(objects.begin(), objects.end(), [&](const MovingObject& object) {
          return !newcomers && isPartOf(*extent, object) &&
                 !isOpposite(velocity->value, object.velocity.value);
        });
    if (known != objects.end()) {
      known->segments.push_back(&segment);
      continue;
    }
    MovingObject object;
    object.evidence.motion = moves;
    object.evidence.change = newcomers;
    object.evidence.motion_tested = newcomers;
    object.extent = std::move(*extent);
    object.velocity = *velocity;
    object.first_frame = frame.path.oldest();
    object.points =
        static_cast<int>(std::max(segment.track.observations.size(), segment.across.size()));
    object.segments = {&segment};
    objects.push_back(std::move(object));
  }
}

bool MovingObjectFinder::isFast(const MeasuredVelocity& velocity, const PointTrack& at,
                                const MotionFrame& frame) const {
  const Eigen::Matrix3d drift = frame.drift.velocityCovariance(
      at.observations.back().uvd, params_.window_s, frame.path, camera_);
  const double sigma = sigmaAlong(velocity.value, velocity.covariance + drift);
  return velocity.value.norm() >= params_.min_speed_mps + 2.0 * sigma;
}

// Velocity of a moving segment; nullopt if it may be static.
std::optional<MeasuredVelocity> MovingObjectFinder::velocityOf(const SegmentTrack& segment,
                                                               const MotionFrame& frame) const {
  SegmentMotionParams params;
  params.noise_scale = frame.noise_scale;
  params.drift_px = frame.drift.at(segment.segment.uvd.z());
  // A segment cut out by its flow needs flow in a second frame: the first one selected it.
  const bool chosen = segment.segment.cut_by_flow;
  if (chosen && !areEnough(segment.across, params)) return std::nullopt;
  const auto motion =
      segmentMotion(segment.segment, SegmentFollower::outlineMotion(segment), segment.across,
                    frame.points, frame.disparity, frame.path, camera_, frame.up, params);
  if (!motion) return std::nullopt;
  const double sigma = sigmaAlong(motion->velocity, motion->covariance);
  const double speed = motion->velocity.norm();
  const bool moves = speed > params_.min_speed_mps + sigma ||
                     motion->across > kMinAcross + 2.0 * motion->across_sigma;
  if (motion->evidence < params_.segment_significance || !moves || speed > kMaxSegmentSpeed) {
    return std::nullopt;
  }
  return MeasuredVelocity{motion->velocity, motion->covariance, 0.5 * motion->span_s};
}

// The box around the cells, if enough of the points inside it are moving.
std::optional<ObjectExtent> MovingObjectFinder::plausibleExtent(
    const std::vector<ObjectCell>& cells, const MeasuredVelocity& velocity,
    const stereo::GroundPlane& floor, double min_ratio, const MotionFrame& frame) {
  const Pose& T_cam_world = frame.path.T_cam_world(frame.path.newest());
  auto extent =
      extentOf(cells, rotated(velocity, T_cam_world.linear()), frame.disparity, camera_, floor);
  if (extent) {
    const auto [nearest, farthest] = std::minmax_element(
        cells.begin(), cells.end(), [](auto& a, auto& b) { return a.point.z() < b.point.z(); });
    const double ratio = movingRatio(frame.points, frame.classes, frame.path, extent->box2d,
                                     nearest->point.z(), farthest->point.z());
    if (ratio >= min_ratio) return extent;
  }
  ++implausible_;
  return std::nullopt;
}

void joinPieces(const MotionFrame& frame, const StereoCamera& camera,
                std::vector<MovingObject>& objects) {
  const Joiner joiner(frame, camera);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (std::size_t j = i + 1; j < objects.size();) {
      auto whole = joiner.joined(objects[i], objects[j]);
      if (!whole) {
        ++j;
        continue;
      }
      objects[i] = std::move(*whole);
      objects.erase(objects.begin() + static_cast<std::ptrdiff_t>(j));
      j = i + 1;  // the whole may touch what its pieces did not
    }
  }
}

}  // namespace headway::detect
