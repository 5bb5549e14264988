// SPDX-License-Identifier: BSD-3-Clause
// The pose that given landmarks and their measurements agree on.
#include <headway/core/statistics.h>
#include <headway/stereo/pose_refiner.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace headway::stereo {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Normal equations at one pose.
struct NormalEquations {
  Matrix6 matrix = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  double cost = 0.0;
};

double cauchyCost(double squared, double scale2) { return scale2 * std::log1p(squared / scale2); }
double cauchyWeight(double squared, double scale2) { return 1.0 / (1.0 + squared / scale2); }

/// Cost of a residual and the weight of each of its coordinates.
struct Robust {
  double cost = 0.0;
  Eigen::Vector3d weights;
};

Robust robust(const Eigen::Vector3d& residual, RobustLoss loss, double scale2) {
  if (loss == RobustLoss::kJoint) {
    const double squared = residual.squaredNorm();
    return {cauchyCost(squared, scale2), Eigen::Vector3d::Constant(cauchyWeight(squared, scale2))};
  }
  const double image2 = residual.head<2>().squaredNorm();
  const double disparity2 = residual.z() * residual.z();
  const double weight = cauchyWeight(image2, scale2);
  return {cauchyCost(image2, scale2) + cauchyCost(disparity2, scale2),
          {weight, weight, cauchyWeight(disparity2, scale2)}};
}

/// What the pose is fitted to.
struct Problem {
  const std::vector<PoseConstraint>& constraints;
  const StereoCamera& camera;
  const PosePrior* prior;  ///< or null
  RobustLoss loss;
};

void addPrior(const PosePrior& prior, const Pose& T_map_cam, NormalEquations& sum) {
  Matrix6 jacobian;
  const Vector6 residual = localCoordinates(prior.T_map_cam, T_map_cam, &jacobian);
  const Matrix6 weighted = jacobian.transpose() * prior.information;
  sum.cost += residual.dot(prior.information * residual);
  sum.matrix += weighted * jacobian;
  sum.gradient += weighted * residual;
}

/// Cost and, if wanted, normal equations of all inliers under a Cauchy loss of this scale.
NormalEquations evaluate(const Pose& T_map_cam, const Problem& problem, double scale,
                         bool with_derivatives) {
  const double scale2 = scale * scale;
  const Pose T_cam_map = T_map_cam.inverse(Eigen::Isometry);
  NormalEquations sum;
  if (problem.prior != nullptr) addPrior(*problem.prior, T_map_cam, sum);
  for (const PoseConstraint& constraint : problem.constraints) {
    if (!constraint.inlier) continue;
    const Eigen::Vector3d point_cam = T_cam_map * constraint.point_map;
    if (point_cam.z() < kMinDepth) continue;
    StereoMeasurement measurement = constraint.measurement;
    measurement.stereo = measurement.stereo && constraint.stereo_inlier;
    Eigen::Matrix3d by_point;
    const Eigen::Vector3d residual = stereoResidual(point_cam, measurement, problem.camera,
                                                    with_derivatives ? &by_point : nullptr);
    const Robust robust_residual = robust(residual, problem.loss, scale2);
    sum.cost += robust_residual.cost;
    if (!with_derivatives) continue;
    const Eigen::Matrix<double, 3, 6> jacobian = by_point * pointByPose(point_cam);
    const Eigen::Matrix<double, 6, 3> weighted =
        jacobian.transpose() * robust_residual.weights.asDiagonal();
    sum.matrix.noalias() += weighted * jacobian;
    sum.gradient.noalias() += weighted * residual;
  }
  return sum;
}

/// Levenberg-Marquardt at a fixed scale of the loss; nullopt if the problem is degenerate.
std::optional<Pose> minimize(Pose pose, const Problem& problem, double scale, int iterations) {
  constexpr double kSmallStep = 1e-7;
  double damping = 1e-6;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const NormalEquations here = evaluate(pose, problem, scale, true);
    bool better = false;
    double step_norm = 0.0;
    for (int attempt = 0; attempt < 4 && !better; ++attempt) {
      Matrix6 damped = here.matrix;
      damped.diagonal() *= 1.0 + damping;
      const Vector6 step = -damped.ldlt().solve(here.gradient);
      if (!step.allFinite()) return std::nullopt;
      step_norm = step.norm();
      const Pose moved = retract(pose, step);
      better = evaluate(moved, problem, scale, false).cost <= here.cost;
      damping = better ? damping * 0.1 : std::max(damping, 1e-6) * 100.0;
      if (better) pose = moved;
    }
    if (!better || step_norm < kSmallStep) break;
  }
  return pose;
}

/// Inverse information of the inliers, scaled by how well they fit (at least as given).
std::optional<PoseCovariance> covarianceOf(const Pose& pose, const Problem& problem, int inliers) {
  constexpr double kWide = 1e3;  ///< a loss so wide that it is quadratic
  const NormalEquations sum = evaluate(pose, problem, kWide, true);
  const auto decomposition = sum.matrix.ldlt();
  if (decomposition.info() != Eigen::Success || !decomposition.isPositive()) return std::nullopt;
  const double variance = std::max(1.0, sum.cost / std::max(1, 2 * inliers - 6));
  const PoseCovariance covariance = variance * decomposition.solve(Matrix6::Identity());
  if (!covariance.allFinite()) return std::nullopt;
  return PoseCovariance(0.5 * (covariance + covariance.transpose()));
}

}  // namespace

int markInliers(const Pose& T_map_cam, std::vector<PoseConstraint>& constraints,
                const StereoCamera& camera, double scale) {
  const Pose T_cam_map = T_map_cam.inverse(Eigen::Isometry);
  int inliers = 0;
  for (PoseConstraint& constraint : constraints) {
    const Eigen::Vector3d point_cam = T_cam_map * constraint.point_map;
    constraint.inlier = false;
    if (point_cam.z() < kMinDepth) continue;
    const Eigen::Vector3d residual =
        stereoResidual(point_cam, constraint.measurement, camera, nullptr);
    constraint.inlier = residual.head<2>().squaredNorm() < chiSquare99(2) * scale * scale;
    constraint.stereo_inlier = constraint.measurement.stereo &&
                               residual.z() * residual.z() < chiSquare99(1) * scale * scale;
    inliers += constraint.inlier ? 1 : 0;
  }
  return inliers;
}

std::optional<RefinedPose> refinePose(const Pose& T_map_cam_guess,
                                      std::vector<PoseConstraint>& constraints,
                                      const StereoCamera& camera, const PoseRefinerOptions& options,
                                      const PosePrior* prior) {
  const int min_constraints = prior != nullptr ? 0 : 4;
  if (static_cast<int>(constraints.size()) < min_constraints) return std::nullopt;
  const Problem problem{constraints, camera, prior, options.loss};
  for (PoseConstraint& constraint : constraints)
    constraint.inlier = constraint.stereo_inlier = true;
  RefinedPose result;
  result.T_map_cam = T_map_cam_guess;
  double scale = options.first_scale;
  for (int round = 0; round < options.rounds; ++round, scale = std::max(1.0, 0.5 * scale)) {
    const auto pose = minimize(result.T_map_cam, problem, scale, options.iterations);
    if (!pose) return std::nullopt;
    result.T_map_cam = *pose;
    result.inliers = markInliers(*pose, constraints, camera, scale);
    if (result.inliers < min_constraints) return std::nullopt;
  }
  const auto covariance = covarianceOf(result.T_map_cam, problem, result.inliers);
  if (!covariance) return std::nullopt;
  result.covariance = *covariance;
  return result;
}

}  // namespace headway::stereo
