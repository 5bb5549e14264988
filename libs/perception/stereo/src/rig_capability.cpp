// SPDX-License-Identifier: BSD-3-Clause
// The distances at which a rig detects things, derived from its calibration and mounting.
#include <headway/core/text.h>
#include <headway/stereo/rig_capability.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace headway::stereo {
namespace {

/// What is assumed of a camera whose calibration does not say it.
struct MountingAssumptions {
  double min_known_height_m = 0.05;  ///< a lower origin is the camera itself, not the ground
  double height_m = 1.65;            ///< without known mounting: of KITTI's car
  double low_mount_m = 1.0;          ///< below it a robot's camera, else a car's
  double robot_obstacle_m = 0.12;    ///< a robot's default
  double kerb_m = 0.08;              ///< what its wheels do not pass
  double car_obstacle_m = 0.3;       ///< a car's
};

/// What a detection needs (doc/rigs.md).
struct DetectionNeeds {
  double min_obstacle_px = 10.0;     ///< height in the image: no less than the matched block
  double min_contrast_sigmas = 7.5;  ///< of an obstacle's top against the ground behind it
  double max_depth_sigma_m = 0.45;   ///< of an obstacle: about two cells of the grid
  double max_ground_sigma_m = 0.65;  ///< of a point of the ground: 25 m with a car's rig
  double motion_sigmas = 3.0;        ///< significance of a speed
  double motion_window_s = 1.0;      ///< in which it is measured
  double walking_speed_mps = 1.4;    ///< Bohannon 1997
  double vehicle_speed_mps = 9.0;    ///< of urban traffic
  double segments_ratio = 1.5;       ///< of people_to_m: beyond, lateral motion alone is seen
  double max_shape_sigma_m = 0.12;   ///< by which shapes of people are told apart
  double max_shape_m = 12.0;         ///< by stereo
  double max_shape_given_m = 4.0;    ///< by depth cameras: a RealSense's furniture resembles people
};

/// Where stereo matching begins and how fine the dense map is.
struct MatchingLimits {
  double max_disparity_ratio = 0.2;  ///< of the image width: the rest of it is matched
  double nearest_depth_m = 0.3;      ///< that depth cameras measure
  double preferred_ratio = 0.5;      ///< of the nearest visible ground: the top of an obstacle half
                                     ///< as high as the camera leaves the image there
  double voxel_ratio = 150.0;        ///< of the reach of the dense map to its voxels
  double voxel_step_m = 0.05;
};

/// How many people are found, measured with three rigs in four worlds (tests/bench/rigs.sh).
struct FoundPeople {
  double sure_to = 0.6;            ///< ratio of people_to_m
  double sure_percent = 97.0;      ///< to there
  double likely_to = 0.8;          ///< ratio of people_to_m
  double likely_percent = 80.0;    ///< from sure_to to there
  double standing_percent = 83.0;  ///< to standing_to_m
};

constexpr FoundPeople kFound;
constexpr MountingAssumptions kMounting;
constexpr DetectionNeeds kNeeds;
constexpr MatchingLimits kMatching;

/// The ratios were measured with robots; a car's line says how far a motion is significant.
std::string peopleText(const RigCapability& rig) {
  if (!rig.meets_drops) return formatted("; people's motion to %.1f m", rig.people_to_m);
  return formatted("; people who walk: %.0f %% found to %.1f m, %.0f %% from there to %.1f m",
                   kFound.sure_percent, kFound.sure_to * rig.people_to_m, kFound.likely_percent,
                   kFound.likely_to * rig.people_to_m) +
         formatted("; who stand: %.0f %% to %.1f m", kFound.standing_percent, rig.standing_to_m);
}

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
  const double frames = std::max(2.0, kNeeds.motion_window_s * rate_hz);
  const double way_m = speed * kNeeds.motion_window_s;
  return depthOfSigma(rig, way_m / kNeeds.motion_sigmas / std::sqrt(12.0 / frames));
}

double obstacleReach(const RigCapability& rig, double focal, double h) {
  const double by_size = focal * h / kNeeds.min_obstacle_px;
  const double by_depth = depthOfSigma(rig, kNeeds.max_depth_sigma_m);
  if (!rig.camera_height_known) return std::min(by_size, by_depth);
  const double by_contrast = rig.focal_baseline * h / rig.camera_height_m /
                             (kNeeds.min_contrast_sigmas * rig.sigma_disparity_px);
  return std::min({by_size, by_contrast, by_depth});
}

/// A configured value, or the derived one where it is 0.
double valueOr(double configured, double derived) {
  return configured > 0.0 ? configured : derived;
}

/// Only a robot whose user states no height is stopped by kerbs.
void setObstacleHeights(double configured, RigCapability& rig) {
  rig.min_obstacle_height_m =
      valueOr(configured, rig.meets_drops ? kMounting.robot_obstacle_m : kMounting.car_obstacle_m);
  const bool meets_kerbs = rig.meets_drops && configured <= 0.0;
  rig.low_obstacle_height_m = meets_kerbs ? kMounting.kerb_m : rig.min_obstacle_height_m;
}

}  // namespace

double RigCapability::depthSigma(double depth_m) const {
  return sigma_disparity_px * depth_m * depth_m / focal_baseline;
}

double RigCapability::obstacleHeight(double depth_m) const {
  return std::clamp(low_obstacle_height_m * depth_m / low_obstacles_to_m, low_obstacle_height_m,
                    min_obstacle_height_m);
}

RigCapability rigCapability(const StereoCamera& camera, const RigAssumptions& assumptions) {
  RigCapability rig;
  rig.baseline_m = camera.baseline_m;
  rig.depth_reach_m = camera.depth_reach_m;
  rig.focal_baseline = camera.fx * camera.baseline_m;
  rig.sigma_disparity_px = assumptions.sigma_disparity_px;
  rig.rate_hz = assumptions.rate_hz;
  const double mounted = camera.T_robot_cam.translation().z();
  rig.camera_height_known = mounted >= kMounting.min_known_height_m;
  rig.camera_height_m = rig.camera_height_known ? mounted : kMounting.height_m;
  rig.meets_drops = rig.camera_height_m < kMounting.low_mount_m;
  setObstacleHeights(assumptions.min_obstacle_height_m, rig);
  const bool is_depth = camera.isDepthCamera();
  const double by_disparity =
      is_depth ? kMatching.nearest_depth_m
               : rig.focal_baseline / (kMatching.max_disparity_ratio * camera.width);
  const NearestGround ground = nearestGround(camera, rig.camera_height_m);
  const bool ground_in_view = std::isfinite(ground.depth_m);
  const double nearest = ground_in_view
                             ? std::max(kMatching.preferred_ratio * ground.depth_m, by_disparity)
                             : by_disparity;
  rig.nearest_m = valueOr(assumptions.nearest_m, rounded(nearest));
  const double hidden = std::min(1.0, rig.min_obstacle_height_m / rig.camera_height_m);
  rig.obstacles_from_m = std::max(
      rig.nearest_m, rounded(ground_in_view ? ground.distance_m * (1.0 - hidden) : by_disparity));
  // Nothing is seen beyond what a depth camera measures, whatever is configured.
  const auto measured = [&](double reach_m) {
    return is_depth ? std::min(reach_m, camera.depth_reach_m) : reach_m;
  };
  const auto reach = [&](double derived, double configured = 0.0) {
    return measured(valueOr(configured, rounded(derived)));
  };
  rig.ground_to_m = reach(depthOfSigma(rig, kNeeds.max_ground_sigma_m));
  rig.obstacles_to_m =
      reach(obstacleReach(rig, camera.fy, rig.min_obstacle_height_m), assumptions.obstacles_to_m);
  rig.low_obstacles_to_m =
      std::min(reach(obstacleReach(rig, camera.fy, rig.low_obstacle_height_m)), rig.obstacles_to_m);
  rig.high_obstacles_to_m = reach(depthOfSigma(rig, kNeeds.max_depth_sigma_m));
  rig.people_to_m = reach(motionReach(rig, kNeeds.walking_speed_mps, assumptions.rate_hz));
  rig.standing_to_m =
      is_depth ? measured(kNeeds.max_shape_given_m)
               : std::min(kNeeds.max_shape_m, depthOfSigma(rig, kNeeds.max_shape_sigma_m));
  rig.vehicles_to_m = reach(motionReach(rig, kNeeds.vehicle_speed_mps, assumptions.rate_hz),
                            assumptions.vehicles_to_m);
  rig.segments_to_m =
      measured(valueOr(assumptions.segments_to_m, kNeeds.segments_ratio * rig.people_to_m));
  rig.grid_spacing_m =
      valueOr(assumptions.grid_spacing_m, std::clamp(rig.obstacles_to_m / 20.0, 0.2, 1.0));
  rig.dense_to_m = measured(valueOr(assumptions.dense_to_m, rig.high_obstacles_to_m));
  const double voxels = std::round(rig.dense_to_m / kMatching.voxel_ratio / kMatching.voxel_step_m);
  rig.dense_voxel_m =
      valueOr(assumptions.dense_voxel_m, std::clamp(kMatching.voxel_step_m * voxels, 0.05, 0.1));
  rig.dense_spacing_m =
      valueOr(assumptions.dense_spacing_m, std::clamp(rig.dense_to_m / 24.0, 0.25, 1.0));
  return rig;
}

std::string describe(const RigCapability& rig) {
  const bool sees_obstacles = rig.obstacles_from_m < rig.obstacles_to_m;
  const bool has_low = rig.low_obstacle_height_m < rig.min_obstacle_height_m &&
                       rig.obstacles_from_m < rig.low_obstacles_to_m;
  const std::string kind = rig.depth_reach_m > 0.0
                               ? formatted("depth camera to %.1f m", rig.depth_reach_m)
                               : formatted("baseline %.2f m", rig.baseline_m);
  return formatted("rig: %s, camera %.2f m above the ground%s, %s from %.1f m; ", kind.c_str(),
                   rig.camera_height_m,
                   rig.camera_height_known ? "" : " (assumed: no promise of free ground)",
                   rig.depth_reach_m > 0.0 ? "used" : "matched", rig.nearest_m) +
         (sees_obstacles
              ? formatted("obstacles of %.2f m at %.1f to %.1f m", rig.min_obstacle_height_m,
                          rig.obstacles_from_m, rig.obstacles_to_m) +
                    (has_low ? formatted(", of %.2f m to %.1f m", rig.low_obstacle_height_m,
                                         rig.low_obstacles_to_m)
                             : "")
              : formatted("no obstacles of %.2f m", rig.min_obstacle_height_m)) +
         peopleText(rig) + formatted("; vehicles' motion to %.0f m", rig.vehicles_to_m);
}

}  // namespace headway::stereo
