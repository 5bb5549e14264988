// SPDX-License-Identifier: BSD-3-Clause
// Noise of boxes as detectors have it, added to exact ones.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/random.h>

namespace headway {

/// Errors of a detector of 3D boxes, for simulated detections, degraded recordings and navigation
/// trials. Sigmas are standard deviations of Gaussian errors.
///
/// @see Hu et al. 2022, "Monocular quasi-dense 3D object tracking" (QD-3DT), the kind of detector
///      that it emulates
struct DetectorNoise {
  double along_sigma_m = 0.0;   ///< of the centre, along the viewing ray
  double across_sigma_m = 0.0;  ///< of the centre, along the optical frame's x axis
  /// Variance of the centre along the optical frame's y axis, relative to that across.
  double vertical_variance_ratio = 0.0;
  double size_sigma_ratio = 0.0;  ///< of length, width and height, relative to the true ones
  double yaw_sigma_rad = 0.0;     ///< of the heading
  double flip_probability = 0.0;  ///< of a heading turned by 180 degrees
};

/// The same noise with the errors of the centre multiplied by `factor`.
[[nodiscard]] DetectorNoise withCentreScaled(DetectorNoise noise, double factor);

/// A box as the detector measures it.
///
/// The number of random numbers drawn does not depend on the sigmas, so that changing one of them
/// does not change the other errors. Sizes are limited to 0.6 to 1.5 times the true ones.
///
/// @param truth  in the sensor's optical frame
[[nodiscard]] Box3d measuredBox(const Box3d& truth, const DetectorNoise& noise, Random& random);

/// Covariance of the centre of such a box, optical frame [m^2].
[[nodiscard]] Eigen::Matrix3d centreCovariance(const Eigen::Vector3d& centre,
                                               const DetectorNoise& noise);

}  // namespace headway
