#include "mover_finder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "body_motion.h"
#include "motion_clusters.h"
#include "over_ground.h"

namespace headway::detect {
namespace {

constexpr double kFastestBody = 8.0;  // of a person's size [m/s]

double sigmaAlong(const Eigen::Vector3d& vector, const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d direction = vector.normalized();
  return std::sqrt(direction.dot(covariance * direction));
}

}  // namespace

VerdictParams verdictParamsOf(const StereoMotionParams& params) {
  VerdictParams verdict;
  verdict.significance = params.significance;
  verdict.least_speed = params.min_speed_mps;
  verdict.most_speed = params.max_speed_mps;
  return verdict;
}

std::vector<Mover> MoverFinder::find(const LookedAt& frame, std::vector<BlobTrack>& bodies) {
  std::vector<Mover> movers;
  addClusters(frame, movers);
  if (frame.ground) addBodies(frame, bodies, movers);
  return movers;
}

std::size_t MoverFinder::takeImplausible() { return std::exchange(implausible_, 0); }

void MoverFinder::addClusters(const LookedAt& frame, std::vector<Mover>& movers) {
  ClusterParams params;
  params.reach_m = params_.max_point_distance_m;
  params.least_points = params_.min_points;
  const Pose& T_cam_world = frame.path.T_cam_world(frame.path.newest());
  const int first =
      frame.path.firstSince(frame.path.timeOf(frame.path.newest()) - params_.window_s);
  for (const auto& cluster :
       clusterMotion(frame.points, frame.verdicts, frame.path, frame.up, params)) {
    const double sigma = sigmaAlong(cluster.velocity, cluster.velocity_covariance);
    if (cluster.velocity.norm() < params_.min_speed_mps + 2.0 * sigma) continue;
    std::vector<Eigen::Vector3d> seeds;
    for (const std::size_t i : cluster.members) {
      seeds.push_back(T_cam_world * frame.points[i].motion->point);
    }
    const stereo::GroundPlane floor = frame.ground.value_or(floorBelow(seeds, camera_));
    auto extent = plausibleExtent(growObject(seeds, frame.disparity, camera_, floor),
                                  cluster.velocity, floor, params_.min_moving_ratio, frame);
    if (!extent) continue;
    const auto known = std::find_if(movers.begin(), movers.end(), [&](const Mover& mover) {
      return isAsFast(cluster.velocity, mover.velocity.value) && isPartOf(*extent, mover);
    });
    if (known != movers.end()) {
      known->members.insert(known->members.end(), cluster.members.begin(), cluster.members.end());
      continue;
    }
    Mover mover;
    mover.extent = std::move(*extent);
    mover.velocity = {cluster.velocity, cluster.velocity_covariance};
    mover.first_frame = first;
    mover.points = static_cast<int>(cluster.members.size());
    mover.members = cluster.members;
    movers.push_back(std::move(mover));
  }
}

void MoverFinder::addBodies(const LookedAt& frame, std::vector<BlobTrack>& bodies,
                            std::vector<Mover>& movers) {
  for (auto& body : bodies) {
    if (body.last_frame != frame.path.newest()) continue;
    const auto velocity = velocityOf(body, frame);
    if (!velocity) continue;
    auto extent = plausibleExtent(body.blob.cells, velocity->value, *frame.ground, 0.0, frame);
    if (!extent) continue;
    const auto known = std::find_if(movers.begin(), movers.end(), [&](const Mover& mover) {
      return isPartOf(*extent, mover) && !isOpposite(velocity->value, mover.velocity.value);
    });
    if (known != movers.end()) {
      known->bodies.push_back(&body);
      continue;
    }
    Mover mover;
    mover.extent = std::move(*extent);
    mover.velocity = *velocity;
    mover.first_frame = frame.path.oldest();
    mover.points = static_cast<int>(std::max(body.track.sightings.size(), body.across.size()));
    mover.bodies = {&body};
    movers.push_back(std::move(mover));
  }
}

// Of a body that moves; nullopt if it may as well stand.
std::optional<MeasuredVelocity> MoverFinder::velocityOf(const BlobTrack& body,
                                                        const LookedAt& frame) const {
  BodyParams params;
  params.noise_scale = frame.noise_scale;
  // What was chosen by how it flows is no evidence that it does: it must go on doing so.
  const bool chosen = body.blob.cut_by_flow;
  if (chosen && static_cast<int>(body.across.size()) < params.least_flows) return std::nullopt;
  const auto motion =
      bodyMotion(body.blob, BlobFollower::outlineMotion(body), body.across, frame.points,
                 frame.disparity, frame.path, camera_, frame.up, params);
  if (motion) {
    const double sigma = sigmaAlong(motion->velocity, motion->covariance);
    const double speed = motion->velocity.norm();
    const bool moves = speed > params_.min_speed_mps + sigma ||
                       motion->across > kLeastAcross + 2.0 * motion->across_sigma;
    if (motion->evidence < params_.segment_significance || !moves || speed > kFastestBody) {
      return std::nullopt;
    }
    return MeasuredVelocity{motion->velocity, motion->covariance};
  }
  const auto& outline = body.track.motion;
  if (!outline ||
      !BlobFollower::moves(body, frame.up, verdictParamsOf(params_), params_.window_s)) {
    return std::nullopt;
  }
  return MeasuredVelocity{overGround(outline->velocity, frame.up), outline->velocity_covariance};
}

// The box around a mover's cells, if enough of the points inside it move too.
std::optional<ObjectExtent> MoverFinder::plausibleExtent(const std::vector<ObjectCell>& cells,
                                                         const Eigen::Vector3d& velocity,
                                                         const stereo::GroundPlane& floor,
                                                         double least_share,
                                                         const LookedAt& frame) {
  const Pose& T_cam_world = frame.path.T_cam_world(frame.path.newest());
  auto extent = extentOf(cells, T_cam_world.linear() * velocity, frame.disparity, camera_, floor);
  if (extent) {
    const auto [nearest, farthest] = std::minmax_element(
        cells.begin(), cells.end(), [](auto& a, auto& b) { return a.point.z() < b.point.z(); });
    const double share = movingShare(frame.points, frame.verdicts, frame.path, extent->box2d,
                                     nearest->point.z(), farthest->point.z());
    if (share >= least_share) return extent;
  }
  ++implausible_;
  return std::nullopt;
}

}  // namespace headway::detect
