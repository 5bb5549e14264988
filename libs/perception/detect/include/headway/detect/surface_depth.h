// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>
#include <headway/core/stereo_camera.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/ground_plane.h>

#include <optional>
#include <vector>

namespace headway::detect {

/// Depth of what a 2D box was drawn around.
struct SurfaceDepth {
  double disparity = 0.0;  ///< of the visible surface [px]
  double sigma = 0.0;      ///< its standard deviation [px]
  int cells = 0;           ///< that agree with it; 0: derived from the box's height alone
};

/// One stereo measurement inside a box.
struct DisparitySample {
  double u = 0.0;          ///< [px], full image
  double v = 0.0;          ///< [px]
  double disparity = 0.0;  ///< [px]
};

/// Stereo measurements inside a box, without those on the ground.
[[nodiscard]] std::vector<DisparitySample> samplesInside(
    const Box2d& box, const stereo::DisparityImage& disparity, const StereoCamera& camera,
    const std::optional<stereo::GroundPlane>& ground);

/// Depth of an object by the mode of the stereo measurements inside its box.
///
/// Background seen past the object or through its windows and occluders before it make modes of
/// their own; the mode wins that has most measurements near the box's middle and agrees with the
/// depth at which an object of the class would be as high as the box. Without stereo
/// measurements that height alone determines it, with its large error.
///
/// @return  nullopt without enough measurements and without a known size (expected, not an error)
[[nodiscard]] std::optional<SurfaceDepth> surfaceDepth(const Box2d& box, ObjectClass object_class,
                                                       const std::vector<DisparitySample>& samples,
                                                       const StereoCamera& camera);

}  // namespace headway::detect
