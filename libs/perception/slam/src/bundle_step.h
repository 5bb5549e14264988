// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "bundle_solver.h"
#include "reduced_system.h"

namespace headway::slam {

/// Half the sum of all losses of a problem; infinite where a point is behind a camera.
///
/// @param previous_offset  of the disparities, from the adjustment before [px]
[[nodiscard]] double costOf(const BundleProblem& problem, const StereoCamera& camera,
                            double previous_offset);

/// One damped Gauss-Newton step: linearises, eliminates the points, solves, substitutes back.
class BundleStep {
 public:
  /// @param previous_offset  of the disparities, from the adjustment before [px]
  BundleStep(const BundleProblem& problem, const StereoCamera& camera, double previous_offset);

  /// Computes a step; false if the system is singular.
  bool compute(double radius);
  /// The disparities' offset that the observations alone ask for, at the problem as it is now;
  /// nullopt if they do not tell it: the posterior's Gaussian divided by those of the assumptions.
  /// Replaces the step.
  [[nodiscard]] std::optional<stereo::OffsetEstimate> freeOffset();
  /// Decrease of the cost that the linearised problem predicts for the step.
  [[nodiscard]] double predictedDecrease() const;
  /// Moves the problem by the step.
  void applyTo(BundleProblem& problem) const;

 private:
  /// A point's part of the normal equations, and its step.
  struct PointBlock {
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();  ///< damped; before inversion the sum
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    Eigen::Vector3d damping = Eigen::Vector3d::Zero();
    Eigen::Vector3d by_offset = Eigen::Vector3d::Zero();
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
  };

  static std::vector<int> freeIndices(const BundleProblem& problem);
  static int countFree(const std::vector<int>& free);
  static std::vector<std::pair<int, int>> coupledPoses(const BundleProblem& problem,
                                                       const std::vector<int>& free);
  [[nodiscard]] std::size_t begin(std::size_t point) const {
    return point == 0 ? 0 : problem_.points[point - 1].observations_end;
  }
  [[nodiscard]] int freeIndex(int pose) const { return free_[static_cast<std::size_t>(pose)]; }
  void setZero();
  void addOffsetPrior();
  void addMotion(const BundleProblem::Motion& motion);
  /// One observation's residual and its derivatives, weighted by the loss.
  struct ObservationTerms {
    Eigen::Vector3d point_cam;
    Eigen::Vector3d residual;
    Eigen::Matrix3d by_point_cam;
    Eigen::Matrix3d by_point;
    double by_offset;
  };
  /// An observation of the present point by a free pose.
  struct Coupling {
    int pose = 0;
    Eigen::Matrix<double, 6, 3> by_point;  ///< block of its pose and its point
  };
  [[nodiscard]] ObservationTerms termsOf(std::size_t observation,
                                         const Eigen::Vector3d& position) const;
  void add(std::size_t observation, const Eigen::Vector3d& position, PointBlock& block);
  void eliminate(PointBlock& block, double radius);
  void dampPoses(double radius);
  void substituteBack();

  const BundleProblem& problem_;
  const StereoCamera& camera_;
  double previous_offset_;
  std::vector<int> free_;  ///< place in the system, of each pose; -1 if fixed
  ReducedSystem system_;
  std::vector<Pose> T_cam_map_;
  std::vector<Coupling> couplings_;  ///< of the present point
  std::vector<PointBlock> points_;
  Eigen::VectorXd right_;     ///< of the poses, before points are eliminated
  Eigen::VectorXd diagonal_;  ///< likewise
  Eigen::VectorXd damping_;
  double right_offset_ = 0.0;
  double diagonal_offset_ = 0.0;
  double damping_offset_ = 0.0;
  Eigen::VectorXd step_;
  double step_offset_ = 0.0;
};

}  // namespace headway::slam
