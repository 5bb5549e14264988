// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/manifold.h>
#include <headway/core/pose.h>

namespace headway::slam {

/// A pose as Ceres holds it: quaternion (x, y, z, w), then translation.
using PoseBlock = Eigen::Matrix<double, 7, 1>;

[[nodiscard]] PoseBlock blockFrom(const Pose& pose);
[[nodiscard]] Pose poseFrom(const double* block);

/// Poses move by T * exp(xi), xi = (translation, rotation).
///
/// Residuals give their derivatives by xi in the first six of the seven columns, so that the
/// derivative of this manifold is a plain unit matrix. Ceres' ProductManifold of a quaternion and a
/// vector would need derivatives by seven ambient coordinates and multiply each by a full Jacobian.
class PoseManifold final : public ceres::Manifold {
 public:
  [[nodiscard]] int AmbientSize() const override { return 7; }
  [[nodiscard]] int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

}  // namespace headway::slam
