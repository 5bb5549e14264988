#pragma once

#include <headway/core/ground_scan.h>
#include <headway/core/moving_regions.h>
#include <headway/core/params.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/ground_plane.h>
#include <headway/stereo/rig_capability.h>

namespace headway::detect {

/// What an obstacle is, and the accuracy of its distance. Part of section [grid].
struct GroundScanParams {
  double reach_m = 0.0;                ///< maximum distance; 0: of the rig [m]
  double min_obstacle_height_m = 0.0;  ///< above ground; 0: of the rig [m]
  double max_obstacle_height_m = 2.0;  ///< above ground [m]
  double sigma_disparity_px = 0.4;     ///< noise of an obstacle's disparity [px]
  double max_error_m = 0.6;            ///< maximum uncertainty of an obstacle's distance [m]

  void describe(Params::Section section);
  /// Capability of a rig for these obstacles; an own reach replaces the rig's.
  [[nodiscard]] stereo::RigCapability capabilityOf(const StereoCamera& camera) const;
  /// Parameters without 0.
  [[nodiscard]] GroundScanParams forRig(const stereo::RigCapability& rig) const;
  void validate() const { validateRanges(*this, "grid"); }  ///< @throws InputError
};

/// Scans the ground: a ray for each column of a disparity image.
///
/// Obstacles are detected by upright cells in a column, enough of them at one distance, so that a
/// ramp is not an obstacle. The nearest ends the ray. The ground before it is free where it was
/// observed, as far before that as the line of sight is lower than an obstacle, and over short gaps
/// without texture. The area behind the end is unknown.
///
/// @param ground   before the camera, in this image
/// @param moving   left out, with what they hide; the unsure ones, too
/// @return         empty for a camera that looks straight down or lies on its side
/// @see            Labayrade et al. 2002 (obstacles as what is upright in disparity); Badino et al.
///                 2007, "Free space computation using stochastic occupancy grids"
[[nodiscard]] GroundScan scanGround(const stereo::DisparityImage& disparity,
                                    const StereoCamera& camera, const stereo::GroundPlane& ground,
                                    const MovingRegions& moving, const GroundScanParams& params);

}  // namespace headway::detect
