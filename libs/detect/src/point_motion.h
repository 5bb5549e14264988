#pragma once

#include <headway/core/stereo_camera.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "camera_path.h"

namespace headway::detect {

/// Where one frame saw a point.
struct Sighting {
  int frame = 0;                                  ///< number on the camera path
  Eigen::Vector3d uvd = Eigen::Vector3d::Zero();  ///< left u, left v, disparity [px]
};

/// Standard deviations of a sighting.
struct SightingNoise {
  double u = 0.4;          ///< [px]
  double v = 0.4;          ///< [px]
  double disparity = 0.4;  ///< [px]
};

/// A point fitted to its sightings twice: standing still, and at a constant velocity.
struct PointMotion {
  Eigen::Vector3d still_point = Eigen::Vector3d::Zero();  ///< world of the path [m]
  double still_error = 0.0;         ///< squared error of the still point, in sigmas squared
  double offset_information = 0.0;  ///< what a still point tells of a disparity offset [1/px^2]
  double offset_push = 0.0;         ///< information times the offset it asks for [1/px]
  Eigen::Vector3d point = Eigen::Vector3d::Zero();     ///< in the newest frame, if it moves [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Identity();  ///< [m^2/s^2]
  double moving_error = 0.0;  ///< squared error of the moving point, with the prior's share
  int sightings = 0;          ///< that it was fitted to

  /// Squared errors to a degree of freedom: 1 where the hypothesis and the noise are right.
  [[nodiscard]] double stillFit() const { return still_error / (3.0 * (sightings - 1)); }
  [[nodiscard]] double movingFit() const { return moving_error / (3.0 * (sightings - 2) + 1.0); }
};

/// The sightings from a frame on.
[[nodiscard]] std::vector<Sighting> since(int frame, const std::vector<Sighting>& sightings);

/// Fits both hypotheses to the sightings of one point, in the images, where noise is plain.
///
/// The difference of the errors is the likelihood ratio of "moves" against "stands": chi-square
/// with 3 degrees of freedom for a still point.
///
/// @param sightings       ascending frames of the path; velocity and point are of its newest
/// @param speed_prior     standard deviation of speeds [m/s]; keeps short tracks sane
/// @return                nullopt with fewer than two sightings or if the point is not in front
/// @see  Franke et al. 2005 ("6D-Vision"), in batch instead of recursively
[[nodiscard]] std::optional<PointMotion> fitMotion(const std::vector<Sighting>& sightings,
                                                   const CameraPath& path,
                                                   const StereoCamera& camera,
                                                   const SightingNoise& noise, double speed_prior);

}  // namespace headway::detect
