// SPDX-License-Identifier: BSD-3-Clause
// Smoothing of a path by a prior of its motion (Sec. III-C1).
#pragma once

#include <headway/core/pose.h>
#include <headway/objects/objects_params.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "measurement_model.h"

namespace headway::objects {

/// Symmetric positive definite system of B x B blocks with two block diagonals below the main one.
///
/// Solved by block elimination in O(n) without fill-in outside the bands: five times as fast as
/// Eigen's SimplicialLDLT for a window of 20 frames (0.8 against 4.2 us, bench_objects).
///
/// @see Golub & Van Loan 2013, 4.3 and 4.5
template <int B>
class BandedSystem {
 public:
  using Block = Eigen::Matrix<double, B, B>;
  using Vector = Eigen::Matrix<double, B, 1>;

  std::vector<Block> diagonal;  ///< block (i, i)
  std::vector<Block> first;     ///< block (i + 1, i)
  std::vector<Block> second;    ///< block (i + 2, i)
  std::vector<Vector> right;    ///< right-hand side; the solution after solve()

  void reset(std::size_t size) {
    diagonal.assign(size, Block::Zero());
    first.assign(size, Block::Zero());
    second.assign(size, Block::Zero());
    right.assign(size, Vector::Zero());
  }

  /// Replaces `right` by the solution and overwrites the blocks.
  void solve() {
    const std::size_t n = diagonal.size();
    for (std::size_t i = 0; i < n; ++i) {
      // Of one triangle: what rounding leaves of an asymmetry would grow from block to block.
      const Block inverse = diagonal[i].llt().solve(Block::Identity());
      if (i + 1 < n) {
        const Block scaled = first[i] * inverse;
        diagonal[i + 1] -= scaled * first[i].transpose();
        right[i + 1] -= scaled * right[i];
        if (i + 2 < n) first[i + 1] -= second[i] * scaled.transpose();
      }
      if (i + 2 < n) {
        const Block scaled = second[i] * inverse;
        diagonal[i + 2] -= scaled * second[i].transpose();
        right[i + 2] -= scaled * right[i];
      }
      diagonal[i] = inverse;
    }
    for (std::size_t i = n; i-- > 0;) {
      Vector sum = right[i];
      if (i + 1 < n) sum -= first[i].transpose() * right[i + 1];
      if (i + 2 < n) sum -= second[i].transpose() * right[i + 2];
      right[i] = diagonal[i] * sum;
    }
  }
};

/// A measured position with its information.
struct PlaceMeasurement {
  Time time = 0.0;                                            ///< [s]
  Eigen::Vector3d measured = Eigen::Vector3d::Zero();         ///< map frame [m]
  Eigen::Matrix2d information = Eigen::Matrix2d::Identity();  ///< of (x, y) [1/m^2]
  double vertical_information = 1.0;                          ///< of z [1/m^2]
  std::optional<GroundVelocity> velocity;                     ///< if measured
};

/// Kind and weight of the prior.
struct PriorStiffness {
  MotionPriorKind kind = MotionPriorKind::kLeastForce;
  double weight = 1.0;         ///< least_kinetic: r [1/(m^2/s)]; least_force: [1/(m^2/s^3)]
  double outlier_sigma = 3.0;  ///< residual from which Huber's loss is linear [-]
  /// Typical acceleration, by which a measured velocity may differ from the mean of a step;
  /// least_force only [m/s^2].
  double acceleration_mps2 = 1.0;
};

/// The smoothing problem of Sec. III-C1: measured positions and a prior of the motion.
///
///     minimise  sum_j rho(|P_j - z_j|^2_Sigma) / 2  +  prior(P)
///     least_kinetic:  sum_j  w/2 (|P_j+1 - P_j| / (dt_j + eps))^2 dt_j           eq. (5)
///     least_force:    sum_j  w/2 |a_j|^2 (dt_j-1 + dt_j) / 2,  a_j the second difference,
///                     + sum_j  rho(|(P_j - P_j-1) / dt_j - v_j|^2_Sigma) / 2  for v_j measured
///                     in the middle of that step or over a time whose middle it contains
///
/// The paper's eq. (5) has no data term, so that all places coincide at its minimum; its eqs. (6)
/// and (7) are not the derivative of (5). Here the data term is added, and the derivative is
/// +- w dP / dt. rho is Huber's loss, which limits the effect of an outlier.
///
/// Iteratively reweighted least squares are hand-written because Ceres' TinySolver solves a dense
/// system, cubic in the length of the window, and has no robust loss.
///
/// @see Vo et al. 2016, "Spatiotemporal bundle adjustment for dynamic 3D reconstruction"
class MotionPriorProblem {
 public:
  MotionPriorProblem() = default;
  /// @param measurements  at least two, times increasing; must outlive the problem
  MotionPriorProblem(const std::vector<PlaceMeasurement>& measurements,
                     const PriorStiffness& stiffness) {
    set(measurements, stiffness);
  }

  /// Another problem, in the memory of the one before.
  void set(const std::vector<PlaceMeasurement>& measurements, const PriorStiffness& stiffness);

  [[nodiscard]] double cost(const std::vector<Eigen::Vector3d>& places) const;

  /// Derivative of the cost with respect to each place.
  [[nodiscard]] std::vector<Eigen::Vector3d> gradient(
      const std::vector<Eigen::Vector3d>& places) const;

  /// Outcome of refine().
  struct Summary {
    int iterations = 0;
    double initial_cost = 0.0;
    double final_cost = 0.0;
  };

  /// Iteratively reweighted least squares from `places`, which it overwrites with the minimum. The
  /// weights of outliers are constant in each step, so that the cost never rises (Holland & Welsch
  /// 1977): Newton's steps would need damping, which ends long before the minimum where the prior
  /// is stiff, at 30 Hz.
  ///
  /// @param tolerance_m  converged when no place moves farther in one step [m]
  Summary refine(std::vector<Eigen::Vector3d>& places, int max_iterations, double tolerance_m);

 private:
  /// A linear form of neighbouring places whose square is a term of the prior.
  struct PriorTerm {
    std::size_t first = 0;  ///< index of the earliest place in it
    int count = 0;          ///< of places in it: 2 or 3
    Eigen::Vector3d coefficients = Eigen::Vector3d::Zero();
    double weight = 0.0;
  };

  /// A measured velocity as the length of the step that it belongs to.
  struct Step {
    std::size_t to = 0;                                         ///< index of the place at its end
    Eigen::Vector2d measured = Eigen::Vector2d::Zero();         ///< [m]
    Eigen::Matrix2d information = Eigen::Matrix2d::Identity();  ///< [1/m^2]
  };

  void addSteps(double acceleration_mps2);
  [[nodiscard]] Eigen::Vector2d stepError(const Step& step,
                                          const std::vector<Eigen::Vector3d>& places) const;
  [[nodiscard]] double stepWeight(const Step& step, const Eigen::Vector2d& error) const;
  /// Adds the measured steps' Hessian.
  void addStepCurvature(const std::vector<Eigen::Vector3d>& places);
  void addKineticTerms(double weight);
  void addForceTerms(double weight);
  /// The cost of places, and whether no residual is in the linear part of Huber's loss, so that the
  /// cost is quadratic there.
  struct Value {
    double cost = 0.0;
    bool is_quadratic = true;
  };
  [[nodiscard]] Value evaluate(const std::vector<Eigen::Vector3d>& places) const;
  [[nodiscard]] double squaredResidual(std::size_t j, const Eigen::Vector3d& place) const;
  [[nodiscard]] Eigen::Vector3d formOf(const PriorTerm& term,
                                       const std::vector<Eigen::Vector3d>& places) const;
  /// Adds the gradient of the prior and of the measured steps.
  void addPriorSlope(const std::vector<Eigen::Vector3d>& places,
                     std::vector<Eigen::Vector3d>& slope) const;
  /// Writes the measurements' Hessian and the negative gradient of the whole cost.
  void addMeasurements(const std::vector<Eigen::Vector3d>& places);
  /// Adds the prior's Hessian.
  void addPrior();
  /// Solves H step = -gradient.
  void solveStep(const std::vector<Eigen::Vector3d>& places, std::vector<Eigen::Vector3d>& step);

  const std::vector<PlaceMeasurement>* measurements_ = nullptr;  ///< not null once it is set
  double outlier_sigma_ = 0.0;
  std::vector<PriorTerm> terms_;
  std::vector<Step> steps_;
  BandedSystem<2> horizontal_;
  BandedSystem<1> vertical_;
  // Buffers: the gradient, a step, and the places after it.
  std::vector<Eigen::Vector3d> slope_, step_, candidate_;
};

}  // namespace headway::objects
