// SPDX-License-Identifier: BSD-3-Clause
#include "motion_factor.h"

#include <headway/stereo/pose_tangent.h>

#include <cmath>

namespace headway::slam {
namespace {

constexpr double kCauchy = 2.0;  ///< residual at which the weight is a half [sigma]

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Adjoint: T * exp(xi) = exp(adjoint(T) * xi) * T for small xi = (translation, rotation).
Matrix6 adjoint(const Pose& T) {
  Matrix6 result;
  result << T.linear(), crossMatrix(T.translation()) * T.linear(), Eigen::Matrix3d::Zero(),
      T.linear();
  return result;
}

Pose robotMotion(const BundleProblem::Motion& motion, const std::vector<Pose>& poses,
                 const Pose& T_robot_cam) {
  const Pose& T_map_a = poses[static_cast<std::size_t>(motion.a)];
  const Pose& T_map_b = poses[static_cast<std::size_t>(motion.b)];
  return T_robot_cam * T_map_a.inverse(Eigen::Isometry) * T_map_b *
         T_robot_cam.inverse(Eigen::Isometry);
}

}  // namespace

double motionLoss(const BundleProblem::Motion& motion, const std::vector<Pose>& poses,
                  const Pose& T_robot_cam) {
  const stereo::Tangent difference =
      stereo::localCoordinates(motion.T_a_b, robotMotion(motion, poses, T_robot_cam), nullptr);
  const double squared = difference.cwiseQuotient(motion.sigma).squaredNorm();
  return kCauchy * kCauchy * std::log1p(squared / (kCauchy * kCauchy));
}

MotionTerms linearised(const BundleProblem::Motion& motion, const std::vector<Pose>& poses,
                       const Pose& T_robot_cam) {
  const Pose T_a_b = robotMotion(motion, poses, T_robot_cam);
  Matrix6 by_motion;
  MotionTerms terms;
  terms.residual =
      stereo::localCoordinates(motion.T_a_b, T_a_b, &by_motion).cwiseQuotient(motion.sigma);
  const double squared = terms.residual.squaredNorm();
  const double root = 1.0 / std::sqrt(1.0 + squared / (kCauchy * kCauchy));
  const Matrix6 weighted = root * motion.sigma.cwiseInverse().asDiagonal() * by_motion;
  const Matrix6 camera_to_robot = adjoint(T_robot_cam);
  terms.residual *= root;
  terms.by_b = weighted * camera_to_robot;
  terms.by_a = -weighted * adjoint(T_a_b.inverse(Eigen::Isometry)) * camera_to_robot;
  return terms;
}

}  // namespace headway::slam
