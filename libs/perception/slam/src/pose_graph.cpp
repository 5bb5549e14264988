// SPDX-License-Identifier: BSD-3-Clause
#include "pose_graph.h"

#include <ceres/ceres.h>
#include <headway/stereo/pose_tangent.h>

#include "pose_block.h"

namespace headway::slam {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

class Edge final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  explicit Edge(const PoseGraphEdge& edge) : edge_(edge) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    Matrix6 by[2];
    Eigen::Map<Vector6> residual(residuals);
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

Vector6 edgeResidual(const PoseGraphEdge& edge, const Pose& T_map_a, const Pose& T_map_b,
                     Matrix6* by_a, Matrix6* by_b) {
  const Pose T_a_b = T_map_a.inverse(Eigen::Isometry) * T_map_b;
  const Eigen::Vector3d phi = logSo3(edge.T_a_b.linear().transpose() * T_a_b.linear());
  Vector6 residual;
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
