// SPDX-License-Identifier: BSD-3-Clause
#include "motion_clusters.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "over_ground.h"

namespace headway::detect {
namespace {

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

}  // namespace

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
  const double margin = 0.3 + 0.02 * farthest;
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

}  // namespace headway::detect
