// SPDX-License-Identifier: BSD-3-Clause
// Noise of boxes as detectors have it, added to exact ones.
#include <headway/core/detector_noise.h>

#include <algorithm>
#include <cmath>

namespace headway {

DetectorNoise withCentreScaled(DetectorNoise noise, double factor) {
  noise.along_sigma_m *= factor;
  noise.across_sigma_m *= factor;
  return noise;
}

Box3d measuredBox(const Box3d& truth, const DetectorNoise& noise, Random& random) {
  Box3d box = truth;
  const Eigen::Vector3d ray = truth.centre.normalized();
  const double vertical =
      noise.across_sigma_m * (std::sqrt(noise.vertical_variance_ratio) * random.normal());
  const double across = noise.across_sigma_m * random.normal();
  const double along = noise.along_sigma_m * random.normal();
  box.centre += Eigen::Vector3d(across, vertical, 0.0) + along * ray;
  const auto measured = [&](double size) {
    return size * std::clamp(1.0 + noise.size_sigma_ratio * random.normal(), 0.6, 1.5);
  };
  box.length = measured(truth.length);
  box.width = measured(truth.width);
  box.height = measured(truth.height);
  box.yaw += noise.yaw_sigma_rad * random.normal();
  if (random.chance(noise.flip_probability)) box.yaw += M_PI;
  box.yaw = wrapAngle(box.yaw);
  return box;
}

Eigen::Matrix3d centreCovariance(const Eigen::Vector3d& centre, const DetectorNoise& noise) {
  constexpr double kDepthVariance = 1e-4;  ///< keeps the matrix invertible where along is 0 [m^2]
  const Eigen::Vector3d ray = centre.normalized();
  const double across = noise.across_sigma_m, along = noise.along_sigma_m;
  Eigen::Matrix3d covariance =
      Eigen::Vector3d(across * across, noise.vertical_variance_ratio * across * across,
                      kDepthVariance)
          .asDiagonal();
  covariance += along * along * ray * ray.transpose();
  return covariance;
}

}  // namespace headway
