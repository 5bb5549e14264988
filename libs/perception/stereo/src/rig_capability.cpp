// SPDX-License-Identifier: BSD-3-Clause
// The distances at which a rig detects things, derived from its calibration and mounting.
#include <headway/core/text.h>
#include <headway/stereo/rig_capability.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace headway::stereo {
namespace {

constexpr double kMinKnownHeight_m = 0.05;  // a lower origin is the camera itself, not the ground
constexpr double kAssumedHeight_m = 1.65;   // of a camera without known mounting
constexpr double kLowMount_m = 1.0;         // below it a robot's, else a car's
constexpr double kLowObstacle_m = 0.12;     // default obstacle height of a small robot
constexpr double kHighObstacle_m = 0.3;     // and of a car
constexpr double kMaxDisparityRatio = 0.2;  // of the image width
constexpr double kNearestDepth_m = 0.3;     // that depth cameras measure
constexpr double kMinObstaclePx = 10.0;     // height of an obstacle in the image
constexpr double kMinContrastSigmas = 7.5;  // of an obstacle's top against the ground behind it
constexpr double kMaxDepthSigma_m = 0.45;   // of an obstacle
constexpr double kMaxGroundSigma_m = 0.65;  // depth error of a point of the ground
constexpr double kMotionSigmas = 3.0;       // significance of a speed
constexpr double kMotionWindow_s = 1.0;     // in which it is measured
constexpr double kWalkingSpeed_mps = 1.4;   // Bohannon 1997
constexpr double kVehicleSpeed_mps = 9.0;   // urban traffic
constexpr double kSegmentsRatio = 1.5;      // beyond people's motion only lateral motion is seen
constexpr double kPreferredRatio = 0.5;     // of the nearest visible ground: the top of an obstacle
                                            // half as high as the camera leaves the image there
constexpr double kDenseVoxelRatio = 150.0;  // of the reach of the dense map to its voxels
constexpr double kDenseVoxelStep_m = 0.05;

double rounded(double value) {
  const double step = value < 0.95 ? 0.1 : value < 9.75 ? 0.5 : value < 19.5 ? 1.0 : 5.0;
  return std::max(0.1, step * std::round(value / step));
}

/// Where the ground enters the image at its lower edge [m]; infinite if it does not.
struct NearestGround {
  double depth_m = std::numeric_limits<double>::infinity();     ///< along the optical axis
  double distance_m = std::numeric_limits<double>::infinity();  ///< over the ground
};

NearestGround nearestGround(const StereoCamera& camera, double height) {
  const Eigen::Vector3d edge =
      camera.T_robot_cam.linear() * ray({camera.cx, camera.height - 1.0}, camera);
  if (!(edge.z() < 0.0)) return {};
  const double depth = height / -edge.z();
  return {depth, depth * edge.head<2>().norm()};
}

/// Depth at which the depth error has a size.
double depthOfSigma(const RigCapability& rig, double sigma_m) {
  return std::sqrt(sigma_m * rig.focal_baseline / rig.sigma_disparity_px);
}

/// Depth up to which a constant speed is significant.
double motionReach(const RigCapability& rig, double speed, double rate_hz) {
  const double frames = std::max(2.0, kMotionWindow_s * rate_hz);
  const double max_depth_sigma = speed * kMotionWindow_s / kMotionSigmas / std::sqrt(12.0 / frames);
  return depthOfSigma(rig, max_depth_sigma);
}

double obstacleReach(const RigCapability& rig, double focal) {
  const double h = rig.min_obstacle_height_m;
  const double by_size = focal * h / kMinObstaclePx;
  const double by_depth = depthOfSigma(rig, kMaxDepthSigma_m);
  if (!rig.camera_height_known) return std::min(by_size, by_depth);
  const double by_contrast =
      rig.focal_baseline * h / rig.camera_height_m / (kMinContrastSigmas * rig.sigma_disparity_px);
  return std::min({by_size, by_contrast, by_depth});
}

/// A configured value, or the derived one where it is 0.
double valueOr(double configured, double derived) {
  return configured > 0.0 ? configured : derived;
}

}  // namespace

double RigCapability::depthSigma(double depth_m) const {
  return sigma_disparity_px * depth_m * depth_m / focal_baseline;
}

RigCapability rigCapability(const StereoCamera& camera, const RigAssumptions& assumptions) {
  RigCapability rig;
  rig.baseline_m = camera.baseline_m;
  rig.depth_reach_m = camera.depth_reach_m;
  rig.focal_baseline = camera.fx * camera.baseline_m;
  rig.sigma_disparity_px = assumptions.sigma_disparity_px;
  const double mounted = camera.T_robot_cam.translation().z();
  rig.camera_height_known = mounted >= kMinKnownHeight_m;
  rig.camera_height_m = rig.camera_height_known ? mounted : kAssumedHeight_m;
  rig.meets_drops = rig.camera_height_m < kLowMount_m;
  rig.min_obstacle_height_m = assumptions.min_obstacle_height_m;
  if (rig.min_obstacle_height_m <= 0.0) {
    rig.min_obstacle_height_m = rig.meets_drops ? kLowObstacle_m : kHighObstacle_m;
  }
  const bool is_depth = camera.isDepthCamera();
  const double by_disparity =
      is_depth ? kNearestDepth_m : rig.focal_baseline / (kMaxDisparityRatio * camera.width);
  const NearestGround ground = nearestGround(camera, rig.camera_height_m);
  const bool ground_in_view = std::isfinite(ground.depth_m);
  const double nearest =
      ground_in_view ? std::max(kPreferredRatio * ground.depth_m, by_disparity) : by_disparity;
  rig.nearest_m = valueOr(assumptions.nearest_m, rounded(nearest));
  const double hidden = std::min(1.0, rig.min_obstacle_height_m / rig.camera_height_m);
  rig.obstacles_from_m = std::max(
      rig.nearest_m, rounded(ground_in_view ? ground.distance_m * (1.0 - hidden) : by_disparity));
  const auto reach = [&](double derived) {
    return is_depth ? std::min(rounded(derived), camera.depth_reach_m) : rounded(derived);
  };
  rig.ground_to_m = reach(depthOfSigma(rig, kMaxGroundSigma_m));
  rig.obstacles_to_m = valueOr(assumptions.obstacles_to_m, reach(obstacleReach(rig, camera.fy)));
  rig.high_obstacles_to_m = reach(depthOfSigma(rig, kMaxDepthSigma_m));
  rig.people_to_m = reach(motionReach(rig, kWalkingSpeed_mps, assumptions.rate_hz));
  rig.vehicles_to_m = valueOr(assumptions.vehicles_to_m,
                              reach(motionReach(rig, kVehicleSpeed_mps, assumptions.rate_hz)));
  const double segments_to_m = kSegmentsRatio * rig.people_to_m;
  rig.segments_to_m =
      valueOr(assumptions.segments_to_m,
              is_depth ? std::min(segments_to_m, camera.depth_reach_m) : segments_to_m);
  rig.grid_spacing_m =
      valueOr(assumptions.grid_spacing_m, std::clamp(rig.obstacles_to_m / 20.0, 0.2, 1.0));
  rig.dense_to_m = valueOr(assumptions.dense_to_m, rig.high_obstacles_to_m);
  const double voxels = std::round(rig.dense_to_m / kDenseVoxelRatio / kDenseVoxelStep_m);
  rig.dense_voxel_m =
      valueOr(assumptions.dense_voxel_m, std::clamp(kDenseVoxelStep_m * voxels, 0.05, 0.1));
  rig.dense_spacing_m =
      valueOr(assumptions.dense_spacing_m, std::clamp(rig.dense_to_m / 24.0, 0.25, 1.0));
  return rig;
}

std::string describe(const RigCapability& rig) {
  const bool sees_obstacles = rig.obstacles_from_m < rig.obstacles_to_m;
  const std::string kind = rig.depth_reach_m > 0.0
                               ? formatted("depth camera to %.1f m", rig.depth_reach_m)
                               : formatted("baseline %.2f m", rig.baseline_m);
  return formatted("rig: %s, camera %.2f m above the ground%s, %s from %.1f m; ", kind.c_str(),
                   rig.camera_height_m,
                   rig.camera_height_known ? "" : " (assumed: no promise of free ground)",
                   rig.depth_reach_m > 0.0 ? "used" : "matched", rig.nearest_m) +
         (sees_obstacles
              ? formatted("obstacles of %.2f m at %.1f to %.1f m", rig.min_obstacle_height_m,
                          rig.obstacles_from_m, rig.obstacles_to_m)
              : formatted("no obstacles of %.2f m", rig.min_obstacle_height_m)) +
         formatted(", people's motion to %.1f m, vehicles' to %.0f m", rig.people_to_m,
                   rig.vehicles_to_m);
}

}  // namespace headway::stereo
