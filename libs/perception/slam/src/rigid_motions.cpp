// SPDX-License-Identifier: BSD-3-Clause
// Robust poses by consensus: the rigid motions in an image, and which of them is the camera's.
#include "rigid_motions.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <set>
#include <utility>

namespace headway::slam {

std::optional<Consensus> poseByConsensus(const std::vector<stereo::PoseConstraint>& constraints,
                                         const StereoCamera& camera, int min_inliers,
                                         double max_error_px, int max_tries) {
  constexpr double kConfidence = 0.999;
  if (static_cast<int>(constraints.size()) < std::max(6, min_inliers)) return std::nullopt;
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const stereo::PoseConstraint& constraint : constraints) {
    const Eigen::Vector3d& p = constraint.point_map;
    points.emplace_back(p.x(), p.y(), p.z());
    pixels.emplace_back(constraint.measurement.uv.x(), constraint.measurement.uv.y());
  }
  const cv::Matx33d intrinsics(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  cv::Vec3d rotation, translation;
  std::vector<int> inliers;
  const bool found = cv::solvePnPRansac(
      points, pixels, intrinsics, cv::noArray(), rotation, translation, false, max_tries,
      static_cast<float>(max_error_px), kConfidence, inliers, cv::SOLVEPNP_P3P);
  if (!found || static_cast<int>(inliers.size()) < min_inliers) return std::nullopt;
  Pose T_cam_map = Pose::Identity();
  T_cam_map.linear() = expSo3({rotation[0], rotation[1], rotation[2]});
  T_cam_map.translation() << translation[0], translation[1], translation[2];
  if (!T_cam_map.matrix().allFinite()) return std::nullopt;
  return Consensus{T_cam_map.inverse(Eigen::Isometry), static_cast<int>(inliers.size())};
}

namespace {

constexpr double kMaxErrorPx = 1.5;  ///< of a landmark followed from one frame to the next
constexpr double kGateScale = 0.5;   ///< landmarks are followed better than that
constexpr int kMaxMotions = 5;

/// Refines a motion with its inliers until these converge.
std::optional<RigidMotion> refined(const Pose& initial,
                                   std::vector<stereo::PoseConstraint> constraints,
                                   const StereoCamera& camera, int min_members) {
  constexpr int kRounds = 3;
  Pose pose = initial;
  for (int round = 0; round < kRounds; ++round) {
    if (stereo::markInliers(pose, constraints, camera, kGateScale) < min_members)
      return std::nullopt;
    std::vector<stereo::PoseConstraint> agreeing;
    std::copy_if(constraints.begin(), constraints.end(), std::back_inserter(agreeing),
                 [](const stereo::PoseConstraint& constraint) { return constraint.inlier; });
    const auto refined = stereo::refinePose(pose, agreeing, camera, {1.0, 1, 6});
    if (!refined) return std::nullopt;
    pose = refined->T_map_cam;
  }
  RigidMotion motion;
  motion.T_map_cam = pose;
  motion.members = stereo::markInliers(pose, constraints, camera, kGateScale);
  if (motion.members < min_members) return std::nullopt;
  for (const stereo::PoseConstraint& constraint : constraints)
    motion.agrees.push_back(constraint.inlier);
  return motion;
}

}  // namespace

std::vector<RigidMotion> rigidMotions(const std::vector<stereo::PoseConstraint>& constraints,
                                      const StereoCamera& camera,
                                      const std::vector<Pose>& initial_poses, int min_members) {
  std::vector<RigidMotion> motions;
  std::vector<bool> explained(constraints.size(), false);
  const auto take = [&](const std::optional<RigidMotion>& motion) {
    if (!motion) return;
    motions.push_back(*motion);
    for (std::size_t i = 0; i < explained.size(); ++i) {
      explained[i] = explained[i] || motion->agrees[i];
    }
  };
  for (const Pose& pose : initial_poses) take(refined(pose, constraints, camera, min_members));
  while (static_cast<int>(motions.size()) < kMaxMotions) {
    std::vector<stereo::PoseConstraint> left;
    for (std::size_t i = 0; i < constraints.size(); ++i) {
      if (!explained[i]) left.push_back(constraints[i]);
    }
    const auto consensus = poseByConsensus(left, camera, min_members, kMaxErrorPx);
    if (!consensus) break;
    const auto known = motions.size();
    take(refined(consensus->T_map_cam, constraints, camera, min_members));
    if (motions.size() == known) break;
  }
  return motions;
}

double extentBeyond(const RigidMotion& motion, const RigidMotion& other,
                    const std::vector<stereo::PoseConstraint>& constraints,
                    const StereoCamera& camera) {
  constexpr int kColumns = 24;         ///< of square cells over the image's width
  constexpr double kLayerRatio = 1.5;  ///< depth of one layer over that of the one before
  const double cell = static_cast<double>(camera.width) / kColumns;
  const Pose T_cam_map = motion.T_map_cam.inverse(Eigen::Isometry);
  std::set<std::pair<int, int>> covered;  // layer, cell
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    if (!motion.agrees[i] || other.agrees[i]) continue;
    const double depth = (T_cam_map * constraints[i].point_map).z();
    if (depth <= 0.0) continue;
    const Eigen::Vector2i at = (constraints[i].measurement.uv / cell).cast<int>();
    covered.emplace(static_cast<int>(std::floor(std::log(depth) / std::log(kLayerRatio))),
                    at.y() * kColumns + at.x());
  }
  double extent = 0.0;
  for (auto first = covered.begin(); first != covered.end();) {
    const auto next = covered.lower_bound({first->first + 1, -1});
    extent += std::sqrt(static_cast<double>(std::distance(first, next)));
    first = next;
  }
  return extent;
}

const RigidMotion* cameraMotion(const std::vector<RigidMotion>& motions,
                                const std::vector<stereo::PoseConstraint>& constraints,
                                const std::vector<bool>& is_static, const StereoCamera& camera) {
  constexpr double kStaticWeight = 1.5;
  const RigidMotion* best = nullptr;
  for (const RigidMotion& motion : motions) {
    if (best == nullptr) {
      best = &motion;
      continue;
    }
    int for_motion = 0, for_best = 0;
    for (std::size_t i = 0; i < is_static.size(); ++i) {
      for_motion += is_static[i] && motion.agrees[i] ? 1 : 0;
      for_best += is_static[i] && best->agrees[i] ? 1 : 0;
    }
    const double extent = extentBeyond(motion, *best, constraints, camera);
    const double best_extent = extentBeyond(*best, motion, constraints, camera);
    const double needed = for_best > for_motion   ? kStaticWeight * best_extent
                          : for_best < for_motion ? best_extent / kStaticWeight
                                                  : best_extent;
    if (extent > needed) best = &motion;
  }
  return best;
}

Pose poseOfOneMotion(const Pose& T_map_cam, const std::vector<stereo::PoseConstraint>& constraints,
                     const StereoCamera& camera) {
  constexpr double kFitRatio = 0.5;  ///< of one motion, 0.68 are within kGateScale
  const auto count = static_cast<int>(constraints.size());
  auto fitting = constraints;
  if (stereo::markInliers(T_map_cam, fitting, camera, kGateScale) >= kFitRatio * count) {
    return T_map_cam;
  }
  const auto motions = rigidMotions(constraints, camera, {T_map_cam}, count / 4);
  const std::vector<bool> is_static(constraints.size(), true);
  const RigidMotion* best = cameraMotion(motions, constraints, is_static, camera);
  return best != nullptr ? best->T_map_cam : T_map_cam;
}

}  // namespace headway::slam
