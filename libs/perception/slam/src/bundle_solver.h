// SPDX-License-Identifier: BSD-3-Clause
// The bundle adjustment's least-squares problem and its Levenberg-Marquardt solver.
#pragma once

#include <headway/core/pose.h>
#include <headway/core/stereo_camera.h>
#include <headway/core/worker_thread.h>
#include <headway/stereo/rectification.h>
#include <headway/stereo/stereo_residual.h>

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "reduced_system.h"

namespace headway::slam {

/// Poses and points to be adjusted to measurements of the points; indices refer to the vectors.
struct BundleProblem {
  struct Observation {
    int pose = 0;
    stereo::StereoMeasurement measurement;
  };
  /// Measured motion from one pose to a later one, by other sensors than the camera.
  struct Motion {
    int a = 0;
    int b = 0;
    Pose T_a_b = Pose::Identity();  ///< robot frames
    /// Standard deviations of translation [m] and rotation [rad] along the axes of frame b.
    Eigen::Matrix<double, 6, 1> sigma = Eigen::Matrix<double, 6, 1>::Ones();
  };
  struct Point {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< map frame [m]
    std::size_t observations_end = 0;  ///< its observations begin where the point's before end
  };

  std::vector<Pose> poses;     ///< T_map_cam
  std::vector<bool> is_fixed;  ///< of each pose; at least one is
  std::vector<Point> points;
  std::vector<Observation> observations;  ///< by point, then by pose
  std::vector<Motion> motions;
  double disparity_offset_px = 0.0;  ///< measured less true disparity, estimated as well
  double offset_walk_px = 0.05;      ///< by which it changes from that of the adjustment before
};

/// How a solve went.
struct BundleSolution {
  bool usable = false;  ///< the problem holds poses and points that are no worse than before
  int iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  /// The disparities' offset by the observations alone, without what is assumed about it; nullopt
  /// if they do not tell it.
  std::optional<stereo::OffsetEstimate> free_offset;
};

/// Minimises the reprojection errors by Levenberg-Marquardt with a Huber loss.
///
/// Each point is eliminated by its 3x3 block (Schur complement), which leaves a system of the free
/// poses and of the disparities' offset. All blocks have fixed sizes: for residuals of 3 with poses
/// of 6, Ceres 2.1 falls back to dynamic ones (doc/lab/slam.md compares the times).
///
/// @param stop  cancels the solve after its present iteration, with an unusable solution
/// @see Triggs et al. 2000, "Bundle adjustment: a modern synthesis", sec. 6;
///      Agarwal et al. 2010, "Bundle adjustment in the large", sec. 3 (step control as in Ceres)
[[nodiscard]] BundleSolution solveBundle(BundleProblem& problem, const StereoCamera& camera,
                                         int max_iterations, const StopCondition& stop = neverStop);

/// A measured motion's weighted residual and its derivatives by the tangents of both camera poses.
struct MotionTerms {
  Eigen::Matrix<double, 6, 1> residual;
  Eigen::Matrix<double, 6, 6> by_a;
  Eigen::Matrix<double, 6, 6> by_b;
};

/// Cauchy's loss of a measured motion: it stays small where the wheels slip, unlike a square.
[[nodiscard]] double motionLoss(const BundleProblem::Motion& motion, const std::vector<Pose>& poses,
                                const Pose& T_robot_cam);

/// The motion linearised about the poses, scaled by the root of the loss's weight.
[[nodiscard]] MotionTerms linearised(const BundleProblem::Motion& motion,
                                     const std::vector<Pose>& poses, const Pose& T_robot_cam);

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
