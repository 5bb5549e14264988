// SPDX-License-Identifier: BSD-3-Clause
// The distances at which a rig detects things, derived from its calibration and mounting.
#pragma once

#include <headway/core/statistics.h>
#include <headway/core/stereo_camera.h>

#include <string>

namespace headway::stereo {

/// Assumptions that a calibration does not contain.
struct RigAssumptions {
  /// 0: for a camera mounted below 1 m 0.12, and from 0.08 on where that is seen; else 0.3 [m].
  double min_obstacle_height_m = 0.0;
  double sigma_disparity_px = 0.4;          ///< noise of one disparity [px]
  double rate_hz = FrameRate::kAssumed_hz;  ///< frames per second, as measured [Hz]
  // Configured values, which replace those of RigCapability; 0: derived.
  double nearest_m = 0.0;
  double obstacles_to_m = 0.0;
  double vehicles_to_m = 0.0;
  double segments_to_m = 0.0;
  double grid_spacing_m = 0.0;
  double dense_to_m = 0.0;
  double dense_voxel_m = 0.0;
  double dense_spacing_m = 0.0;
};

/// Distances at which a stereo rig detects things, derived from its calibration and mounting.
///
/// Parameters in metres that depend on the rig have the default 0, which stands for a value of this
/// struct. Rounded to 0.1 m (below 1 m), 0.5 m (below 10 m), 1 m (below 20 m) and 5 m. With f the
/// focal length, b the baseline, H the camera's height, h the obstacle's height and s the noise of
/// a disparity:
///
///     depth error                  z^2 s / (f b)
///     nearest matched depth        max(z0 / 2, 5 f b / width); z0: nearest ground in the image
///     ground                       z^2 s / (f b) <= 0.65 m
///     obstacles                    x0 (1 - h / H) up to the least of; x0: distance of that ground
///       height in the image          f h / z >= 10 px
///       contrast against the ground  f b h / (H z) >= 7.5 s; not used where H is unknown
///       depth error                  z^2 s / (f b) <= 0.45 m
///     dense map                    z^2 s / (f b) <= 0.45 m, in voxels of 1/150 of that depth
///     shapes of people             z^2 s / (f b) <= 0.12 m, at most 12 m; depth camera 4 m
///     motion at a speed v          v >= 3 sigma_v; sigma_v = z^2 s / (f b) sqrt(12 / n) / T
///
/// A depth camera is used from 0.3 m, or z0 / 2, and nothing reaches farther than its depths do.
///
/// v is 1.4 m/s for people and 9 m/s for vehicles, T = 1 s and n the number of frames in it.
///
/// @see  Gallup et al. 2008, "Variable baseline/resolution stereo" (depth error); doc/rigs.md
struct RigCapability {
  double baseline_m = 0.0;             ///< [m]
  double depth_reach_m = 0.0;          ///< of a depth camera, as StereoCamera::depth_reach_m [m]
  double focal_baseline = 0.0;         ///< f b [px m]
  double camera_height_m = 0.0;        ///< above the ground [m]
  bool camera_height_known = false;    ///< false: the mounting has no height, 1.65 m are assumed
  double sigma_disparity_px = 0.0;     ///< as assumed [px]
  double rate_hz = 0.0;                ///< as assumed or measured [Hz]
  double min_obstacle_height_m = 0.0;  ///< of the obstacles below [m]
  double low_obstacle_height_m = 0.0;  ///< of those that are seen where they can be [m]
  double nearest_m = 0.0;              ///< minimum depth matched [m]
  double ground_to_m = 0.0;            ///< ground is searched from nearest_m to here [m]
  double obstacles_from_m = 0.0;       ///< obstacles of the minimum height are visible from here
  double obstacles_to_m = 0.0;         ///< to here [m]
  double low_obstacles_to_m = 0.0;     ///< to here if they are as high as low ones [m]
  double high_obstacles_to_m = 0.0;    ///< to here if they are higher: the depth error limits [m]
  bool meets_drops = false;            ///< mounted below 1 m: robots meet stairs, cars do not
  double people_to_m = 0.0;            ///< walking people are told from standing ones to here [m]
  double standing_to_m = 0.0;          ///< standing people are known by their shape to here [m]
  double vehicles_to_m = 0.0;          ///< moving vehicles from parked ones to here [m]
  double segments_to_m = 0.0;          ///< upright segments are tracked to here: 1.5 people_to_m
  double grid_spacing_m = 0.0;         ///< of ground scans: obstacles_to_m / 20, 0.2 to 1 m
  double dense_to_m = 0.0;             ///< surfaces enter the dense map to here [m]
  double dense_voxel_m = 0.0;          ///< of the dense map: dense_to_m / 150, 0.05 or 0.1 m
  double dense_spacing_m = 0.0;        ///< of its depth scans: dense_to_m / 24, 0.25 to 1 m

  /// Standard deviation of a depth [m].
  [[nodiscard]] double depthSigma(double depth_m) const;
  /// Height from which an obstacle at a depth is seen: of what is half as far, half of it, as the
  /// formulas above say [m].
  [[nodiscard]] double obstacleHeight(double depth_m) const;
};

/// The one place where parameters with the value 0 get that of the rig.
///
/// @param camera  validated
[[nodiscard]] RigCapability rigCapability(const StereoCamera& camera,
                                          const RigAssumptions& assumptions = {});

/// One line for users, without a line end. Of people a robot's says how many were found in
/// simulated worlds (doc/rigs.md), by ratios of people_to_m.
[[nodiscard]] std::string describe(const RigCapability& rig);

}  // namespace headway::stereo
