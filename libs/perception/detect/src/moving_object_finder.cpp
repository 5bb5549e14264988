// SPDX-License-Identifier: BSD-3-Clause
#include "moving_object_finder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "appearance.h"
#include "motion_clusters.h"
#include "over_ground.h"
#include "segment_motion.h"

namespace headway::detect {
namespace {

constexpr double kMaxSegmentSpeed = 8.0;  // [m/s]

double sigmaAlong(const Eigen::Vector3d& vector, const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d direction = vector.normalized();
  return std::sqrt(direction.dot(covariance * direction));
}

}  // namespace

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
  addClusters(frame, objects);
  if (frame.ground) addSegments(frame, segments, objects);
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
    const double sigma = sigmaAlong(velocity.value, velocity.covariance);
    if (velocity.value.norm() < params_.min_speed_mps + 2.0 * sigma) continue;
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
          return isAsFast(cluster.velocity, object.velocity.value) && isPartOf(*extent, object);
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

void MovingObjectFinder::addSegments(const MotionFrame& frame, std::vector<SegmentTrack>& segments,
                                     std::vector<MovingObject>& objects) {
  for (auto& segment : segments) {
    if (segment.last_frame != frame.path.newest()) continue;
    const auto velocity = velocityOf(segment, frame);
    if (!velocity) continue;
    auto extent = plausibleExtent(segment.segment.cells, *velocity, *frame.ground, 0.0, frame);
    if (!extent) continue;
    if (repeatsAlongRows(frame.image, extent->cells)) {
      ++implausible_;
      continue;
    }
    const auto known =
        std::find_if(objects.begin(), objects.end(), [&](const MovingObject& object) {
          return isPartOf(*extent, object) && !isOpposite(velocity->value, object.velocity.value);
        });
    if (known != objects.end()) {
      known->segments.push_back(&segment);
      continue;
    }
    MovingObject object;
    object.evidence.motion = true;
    object.extent = std::move(*extent);
    object.velocity = *velocity;
    object.first_frame = frame.path.oldest();
    object.points =
        static_cast<int>(std::max(segment.track.observations.size(), segment.across.size()));
    object.segments = {&segment};
    objects.push_back(std::move(object));
  }
}

// Velocity of a moving segment; nullopt if it may be static.
std::optional<MeasuredVelocity> MovingObjectFinder::velocityOf(const SegmentTrack& segment,
                                                               const MotionFrame& frame) const {
  SegmentMotionParams params;
  params.noise_scale = frame.noise_scale;
  // A segment cut out by its flow needs flow in a second frame: the first one selected it.
  const bool chosen = segment.segment.cut_by_flow;
  if (chosen && static_cast<int>(segment.across.size()) < params.min_flows) return std::nullopt;
  const auto motion =
      segmentMotion(segment.segment, SegmentFollower::outlineMotion(segment), segment.across,
                    frame.points, frame.disparity, frame.path, camera_, frame.up, params);
  if (motion) {
    const double sigma = sigmaAlong(motion->velocity, motion->covariance);
    const double speed = motion->velocity.norm();
    const bool moves = speed > params_.min_speed_mps + sigma ||
                       motion->across > kMinAcross + 2.0 * motion->across_sigma;
    if (motion->evidence < params_.segment_significance || !moves || speed > kMaxSegmentSpeed) {
      return std::nullopt;
    }
    return MeasuredVelocity{motion->velocity, motion->covariance};
  }
  const auto& outline = segment.track.motion;
  if (!outline ||
      !SegmentFollower::moves(segment, frame.up, pointClassParams(params_), params_.window_s)) {
    return std::nullopt;
  }
  return MeasuredVelocity{overGround(outline->velocity, frame.up), outline->velocity_covariance};
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

}  // namespace headway::detect
