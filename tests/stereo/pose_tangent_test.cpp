// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/stereo/stereo_residual.h>

#include <random>

namespace headway::stereo {
namespace {

Tangent randomTangent(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> any(-size, size);
  Tangent xi;
  for (int i = 0; i < 6; ++i) xi(i) = any(random);
  return xi;
}

TEST(PoseTangentTest, LocalCoordinatesUndoARetraction) {
  std::mt19937 random(2);
  for (int i = 0; i < 50; ++i) {
    const Pose pose = retract(Pose::Identity(), randomTangent(random, 1.5));
    const Tangent xi = randomTangent(random, 1.5);
    EXPECT_TRUE(localCoordinates(pose, retract(pose, xi), nullptr).isApprox(xi, 1e-9));
  }
}

TEST(PoseTangentTest, JacobianOfLocalCoordinatesEqualsNumericDifferences) {
  constexpr double kStep = 1e-6;
  std::mt19937 random(3);
  for (const double size : {1e-6, 0.2, 1.4}) {
    const Pose from = retract(Pose::Identity(), randomTangent(random, 1.0));
    const Pose to = retract(from, randomTangent(random, size));
    Eigen::Matrix<double, 6, 6> analytic;
    static_cast<void>(localCoordinates(from, to, &analytic));
    for (int axis = 0; axis < 6; ++axis) {
      const Tangent step = kStep * Tangent::Unit(axis);
      const Tangent numeric = (localCoordinates(from, retract(to, step), nullptr) -
                               localCoordinates(from, retract(to, -step), nullptr)) /
                              (2.0 * kStep);
      EXPECT_LT((analytic.col(axis) - numeric).norm(), 1e-7) << "axis " << axis;
    }
  }
}

}  // namespace
}  // namespace headway::stereo
