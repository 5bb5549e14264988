// SPDX-License-Identifier: BSD-3-Clause
// Scans the ground for free space and obstacles, column by column of a disparity image.
#pragma once

#include <headway/core/moving_regions.h>
#include <headway/core/params.h>
#include <headway/core/scan.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/ground_plane.h>
#include <headway/stereo/rig_capability.h>

namespace headway::detect {

/// What an obstacle is, and the accuracy of its distance. Part of section [grid].
struct GroundScanParams {
  double reach_m = 0.0;                ///< of free ground and low obstacles; 0: of the rig [m]
  double min_obstacle_height_m = 0.0;  ///< above ground; 0: of the rig [m]
  double max_obstacle_height_m = 2.0;  ///< above ground [m]
  double sigma_disparity_px = 0.4;     ///< noise of an obstacle's disparity [px]
  double max_error_m = 0.6;            ///< maximum uncertainty of an obstacle's distance [m]

  void describe(Params::Section section);
  /// These values, as they replace those of the rig.
  [[nodiscard]] stereo::RigAssumptions configured() const;
  /// Capability of a rig for these obstacles; an own reach replaces the rig's.
  ///
  /// @throws InputError if the rig cannot tell obstacles of `min_obstacle_height_m` from the ground
  ///                    where it sees them best
  [[nodiscard]] stereo::RigCapability capabilityOf(const StereoCamera& camera) const;
  void validate() const { validateRanges(*this, "grid"); }  ///< @throws InputError
};

/// Scans the ground: a ray for each column of a disparity image.
///
/// The nearest obstacle of a column is what stands upright at one distance, or what is higher than
/// a ramp could be at its distance, such as the top of a table; behind it, every surface as high as
/// an obstacle is one. Ground is free where it was matched and an obstacle in front of it would
/// have been noticed, up to the nearest obstacle or drop; gaps without texture are bridged up to
/// 1.5 times the height of the camera. The rim of a drop is an obstacle. A camera 1 m high or more
/// is a car's: there, the end of a longer gap counts as free, too, and rims are not entered, as
/// roads have no open drops. Everything else is unknown. For robots, higher obstacles are entered
/// beyond the reach, as far as the depth error allows, at most 1.3 times of it.
///
/// Stripes, as of corrugated walls, are matched a period off, and then seem to hang before their
/// wall: what hangs and whose image repeats along the rows ends free ground, but is no obstacle.
///
/// @param image    left, on the disparity grid, 8-bit
/// @param ground   before the camera, in this image
/// @param moving   left out, with what they hide; the unsure ones, too
/// @param step     columns from one that is scanned to the next
/// @return         empty for a camera that looks straight down or lies on its side
/// @see            Labayrade et al. 2002 (obstacles as what is upright in disparity); Badino et al.
///                 2007, "Free space computation using stochastic occupancy grids"
[[nodiscard]] GroundScan scanGround(const stereo::DisparityImage& disparity, const cv::Mat& image,
                                    const StereoCamera& camera, const stereo::GroundPlane& ground,
                                    const MovingRegions& moving, const GroundScanParams& params,
                                    int step = 1);

}  // namespace headway::detect
