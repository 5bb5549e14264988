// SPDX-License-Identifier: BSD-3-Clause
// Poses of the camera in the last frames, refined by static points.
#include "camera_path.h"

#include <headway/stereo/pose_refiner.h>

#include <algorithm>
#include <cmath>

namespace headway::detect {
namespace {

// Of the motion given, in 0.1 s; it grows with the root of the time, as a random walk does.
constexpr double kPriorTranslation = 0.004;  // [m]
constexpr double kPriorRotation = 0.0035;    // [rad]

constexpr double kLossScale = 2.0;  // of the joint Cauchy loss, in sigmas

/// @param seconds  since the frame before
stereo::PosePrior priorAt(const Pose& T_world_cam, double seconds) {
  const double tenths = tenthsOf(seconds);
  const double growth = tenths > 0.0 ? std::sqrt(tenths) : 1.0;
  stereo::Tangent sigmas;
  sigmas << Eigen::Vector3d::Constant(growth * kPriorTranslation),
      Eigen::Vector3d::Constant(growth * kPriorRotation);
  stereo::PosePrior prior;
  prior.T_map_cam = T_world_cam;
  prior.information = sigmas.cwiseAbs2().cwiseInverse().asDiagonal();
  return prior;
}

}  // namespace

int CameraPath::advance(Time time, const Pose& T_odom_cam) {
  Pose T_cam_world = Pose::Identity();
  if (!frames_.empty()) {
    const Pose motion = T_odom_cam.inverse() * T_odom_cam_;
    T_cam_world = motion * frames_.back().T_cam_world;
  }
  frames_.push_back({time, normalized(T_cam_world)});
  T_odom_cam_ = T_odom_cam;
  return newest();
}

double CameraPath::refine(const std::vector<StaticObservation>& points) {
  if (points.empty() || frames_.empty()) return 1.0;
  Pose& T_cam_world = frames_.back().T_cam_world;
  std::vector<stereo::PoseConstraint> constraints;
  constraints.reserve(points.size());
  for (const StaticObservation& seen : points) {
    constraints.push_back(
        {seen.point, {seen.uvd.head<2>(), seen.uvd.z(), true, sigma_px_, sigma_px_}, true, true});
  }
  const Pose given = T_cam_world.inverse(Eigen::Isometry);
  const auto prior = priorAt(given, lastStep_s());
  stereo::PoseRefinerOptions options;
  options.first_scale = kLossScale;
  options.rounds = 1;
  options.loss = stereo::RobustLoss::kJoint;
  const auto refined = stereo::refinePose(given, constraints, camera_, options, &prior);
  if (!refined) return 0.0;
  T_cam_world = refined->T_map_cam.inverse(Eigen::Isometry);
  stereo::markInliers(refined->T_map_cam, constraints, camera_, 1.0);
  const auto agreeing = std::count_if(constraints.begin(), constraints.end(), [](const auto& one) {
    return one.inlier && one.stereo_inlier;
  });
  return static_cast<double>(agreeing) / static_cast<double>(points.size());
}

void CameraPath::removeBefore(int first_kept) {
  while (first_ < first_kept && frames_.size() > 1) {
    frames_.pop_front();
    ++first_;
  }
}

int CameraPath::firstSince(Time time) const {
  int first = oldest();
  while (first < newest() && timeOf(first) < time - kFrameJitter_s) ++first;
  return first;
}

}  // namespace headway::detect
