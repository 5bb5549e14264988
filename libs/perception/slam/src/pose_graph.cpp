// SPDX-License-Identifier: BSD-3-Clause
// Pose graph optimisation: keyframes that agree best with measured relative poses.
#include "pose_graph.h"

#include <ceres/ceres.h>
#include <ceres/manifold.h>
#include <headway/core/pose.h>
#include <headway/stereo/stereo_residual.h>

namespace headway::slam {

namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using stereo::Tangent;

/// A pose as Ceres holds it: quaternion (x, y, z, w), then translation.
using PoseBlock = Eigen::Matrix<double, 7, 1>;

PoseBlock blockFrom(const Pose& pose) {
  PoseBlock block;
  block << Eigen::Quaterniond(pose.linear()).coeffs(), pose.translation();
  return block;
}

Pose poseFrom(const double* block) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Map<const Eigen::Quaterniond>(block).normalized().toRotationMatrix();
  pose.translation() = Eigen::Map<const Eigen::Vector3d>(block + 4);
  return pose;
}

/// Poses move by T * exp(xi), xi = (translation, rotation).
///
/// Residuals give their derivatives by xi in the first six of the seven columns, so that the
/// derivative of this manifold is a plain unit matrix. Ceres' ProductManifold of a quaternion and a
/// vector would need derivatives by seven ambient coordinates and multiply each by a full Jacobian.
class PoseManifold final : public ceres::Manifold {
 public:
  [[nodiscard]] int AmbientSize() const override { return 7; }
  [[nodiscard]] int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const Eigen::Map<const Tangent> xi(delta);
    Eigen::Map<PoseBlock>{x_plus_delta} = blockFrom(stereo::retract(poseFrom(x), xi));
    return true;
  }
  bool PlusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Tangent>{y_minus_x} = stereo::localCoordinates(poseFrom(x), poseFrom(y), nullptr);
    return true;
  }
  bool MinusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
};

class Edge final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  explicit Edge(const PoseGraphEdge& edge) : edge_(edge) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    Matrix6 by[2];
    Eigen::Map<Tangent> residual(residuals);
    residual =
        edgeResidual(edge_, poseFrom(parameters[0]), poseFrom(parameters[1]), &by[0], &by[1]);
    for (int i = 0; jacobians != nullptr && i < 2; ++i) {
      if (jacobians[i] == nullptr) continue;
      Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> jacobian(jacobians[i]);
      jacobian.leftCols<6>() = by[i];
      jacobian.rightCols<1>().setZero();
    }
    return true;
  }

 private:
  PoseGraphEdge edge_;
};

/// Ends the solver with the present solution.
class EndWhenStopped : public ceres::IterationCallback {
 public:
  explicit EndWhenStopped(const StopCondition& stop) : stop_(stop) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    return stop_() ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  const StopCondition& stop_;
};

}  // namespace

Tangent edgeResidual(const PoseGraphEdge& edge, const Pose& T_map_a, const Pose& T_map_b,
                     Matrix6* by_a, Matrix6* by_b) {
  const Pose T_a_b = T_map_a.inverse(Eigen::Isometry) * T_map_b;
  const Eigen::Vector3d phi = logSo3(edge.T_a_b.linear().transpose() * T_a_b.linear());
  Tangent residual;
  residual << (T_a_b.translation() - edge.T_a_b.translation()) / edge.sigma_m, phi / edge.sigma_rad;
  const Eigen::Matrix3d turn = stereo::inverseRightJacobian(phi) / edge.sigma_rad;
  if (by_a != nullptr) {
    by_a->setZero();
    by_a->topLeftCorner<3, 3>() = -Eigen::Matrix3d::Identity() / edge.sigma_m;
    by_a->topRightCorner<3, 3>() = crossMatrix(T_a_b.translation()) / edge.sigma_m;
    by_a->bottomRightCorner<3, 3>() = -turn * T_a_b.linear().transpose();
  }
  if (by_b != nullptr) {
    by_b->setZero();
    by_b->topLeftCorner<3, 3>() = T_a_b.linear() / edge.sigma_m;
    by_b->bottomRightCorner<3, 3>() = turn;
  }
  return residual;
}

std::map<KeyframeId, Pose> optimisePoseGraph(const std::map<KeyframeId, Pose>& poses,
                                             const std::vector<PoseGraphEdge>& edges,
                                             const StopCondition& stop) {
  if (poses.empty() || edges.empty()) return poses;
  std::vector<PoseBlock> blocks;  // one array in order of ids: Ceres orders blocks by address
  blocks.reserve(poses.size());
  std::map<KeyframeId, std::size_t> at;
  for (const auto& [id, pose] : poses) {
    at[id] = blocks.size();
    blocks.push_back(blockFrom(pose));
  }
  PoseManifold manifold;
  ceres::Problem::Options ownership;
  ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  for (PoseBlock& block : blocks) problem.AddParameterBlock(block.data(), 7, &manifold);
  for (const PoseGraphEdge& edge : edges) {
    problem.AddResidualBlock(new Edge(edge), nullptr, blocks[at.at(edge.a)].data(),
                             blocks[at.at(edge.b)].data());
  }
  problem.SetParameterBlockConstant(blocks.front().data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 30;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  EndWhenStopped end_when_stopped(stop);
  options.callbacks.push_back(&end_when_stopped);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) return poses;
  std::map<KeyframeId, Pose> result;
  for (const auto& [id, index] : at) result[id] = poseFrom(blocks[index].data());
  return result;
}

}  // namespace headway::slam
