// SPDX-License-Identifier: BSD-3-Clause
// The bundle adjustment's least-squares problem and its Levenberg-Marquardt solver.
#include "bundle_solver.h"

#include <headway/core/statistics.h>
#include <headway/stereo/stereo_residual.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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

namespace {

constexpr double kHuber = 2.0;  ///< residual above which the loss is linear [sigma]
using stereo::kRectificationSigma_px;

using Matrix63 = Eigen::Matrix<double, 6, 3>;

/// Huber's loss of a squared residual.
double huber(double squared) {
  return squared <= kHuber * kHuber ? squared : 2.0 * kHuber * std::sqrt(squared) - kHuber * kHuber;
}

/// Weight of a squared residual, the derivative of Huber's loss.
double huberWeight(double squared) {
  return squared <= kHuber * kHuber ? 1.0 : kHuber / std::sqrt(squared);
}

/// Levenberg's damping of one diagonal element.
double damping(double diagonal, double radius) { return std::max(diagonal, 1e-6) / radius; }

stereo::StereoMeasurement withoutOffset(stereo::StereoMeasurement measurement, double offset_px) {
  measurement.disparity -= offset_px;
  return measurement;
}

std::vector<Pose> inverses(const std::vector<Pose>& poses) {
  std::vector<Pose> result;
  result.reserve(poses.size());
  for (const Pose& pose : poses) result.push_back(pose.inverse(Eigen::Isometry));
  return result;
}

}  // namespace

double costOf(const BundleProblem& problem, const StereoCamera& camera, double previous_offset) {
  const auto cameras = inverses(problem.poses);
  double sum =
      std::pow(problem.disparity_offset_px / kRectificationSigma_px, 2) +
      std::pow((problem.disparity_offset_px - previous_offset) / problem.offset_walk_px, 2);
  std::size_t next = 0;
  for (const BundleProblem::Point& point : problem.points) {
    for (; next < point.observations_end; ++next) {
      const auto& [pose, measurement] = problem.observations[next];
      const Pose& T_cam_map = cameras[static_cast<std::size_t>(pose)];
      const Eigen::Vector3d point_cam = T_cam_map * point.position;
      if (point_cam.z() < stereo::kMinDepth) return std::numeric_limits<double>::infinity();
      const auto corrected = withoutOffset(measurement, problem.disparity_offset_px);
      sum += huber(stereo::stereoResidual(point_cam, corrected, camera, nullptr).squaredNorm());
    }
  }
  for (const BundleProblem::Motion& motion : problem.motions) {
    sum += motionLoss(motion, problem.poses, camera.T_robot_cam);
  }
  return 0.5 * sum;
}

BundleStep::BundleStep(const BundleProblem& problem, const StereoCamera& camera,
                       double previous_offset)
    : problem_(problem),
      camera_(camera),
      previous_offset_(previous_offset),
      free_(freeIndices(problem)),
      system_(countFree(free_), coupledPoses(problem, free_)),
      points_(problem.points.size()) {
  for (int& index : free_) index = index < 0 ? index : system_.place(index);
}

std::vector<int> BundleStep::freeIndices(const BundleProblem& problem) {
  std::vector<int> free(problem.poses.size(), -1);
  int next = 0;
  for (std::size_t i = 0; i < free.size(); ++i) {
    if (!problem.is_fixed[i]) free[i] = next++;
  }
  return free;
}

int BundleStep::countFree(const std::vector<int>& free) {
  return static_cast<int>(std::count_if(free.begin(), free.end(), [](int i) { return i >= 0; }));
}

/// Free poses that observe a point together or are joined by a motion; none for a dense system.
std::vector<std::pair<int, int>> BundleStep::coupledPoses(const BundleProblem& problem,
                                                          const std::vector<int>& free) {
  std::vector<std::pair<int, int>> coupled;
  if (countFree(free) <= ReducedSystem::kDense) return coupled;
  std::size_t limit = 1 << 17;  // neighbouring points repeat the same pairs
  const auto removeRepeats = [&] {
    std::sort(coupled.begin(), coupled.end());
    coupled.erase(std::unique(coupled.begin(), coupled.end()), coupled.end());
    limit = std::max(limit, 2 * coupled.size());
  };
  const auto add = [&](int a, int b) {
    const int i = free[static_cast<std::size_t>(a)];
    const int j = free[static_cast<std::size_t>(b)];
    if (i >= 0 && j >= 0) coupled.emplace_back(i, j);
  };
  std::size_t first = 0;
  for (const BundleProblem::Point& point : problem.points) {
    for (std::size_t i = first; i < point.observations_end; ++i) {
      for (std::size_t j = i + 1; j < point.observations_end; ++j) {
        add(problem.observations[i].pose, problem.observations[j].pose);
      }
    }
    first = point.observations_end;
    if (coupled.size() > limit) removeRepeats();
  }
  for (const BundleProblem::Motion& motion : problem.motions) add(motion.a, motion.b);
  return coupled;
}

bool BundleStep::compute(double radius) {
  setZero();
  addOffsetPrior();
  for (const BundleProblem::Motion& motion : problem_.motions) addMotion(motion);
  for (std::size_t point = 0; point < points_.size(); ++point) {
    PointBlock& block = points_[point] = PointBlock();
    couplings_.clear();
    for (std::size_t i = begin(point); i < problem_.points[point].observations_end; ++i) {
      add(i, problem_.points[point].position, block);
    }
    eliminate(block, radius);
  }
  dampPoses(radius);
  if (!system_.solve(step_, step_offset_)) return false;
  substituteBack();
  return true;
}

std::optional<stereo::OffsetEstimate> BundleStep::freeOffset() {
  if (!compute(1e12)) return std::nullopt;  // undamped
  const double relative = 1.0 / square(problem_.offset_walk_px);
  const double information = system_.pivot() - 1.0 / square(kRectificationSigma_px) - relative;
  if (information < 1.0 / square(kRectificationSigma_px)) return std::nullopt;
  const double sum = system_.pivot() * (problem_.disparity_offset_px + step_offset_);
  return stereo::OffsetEstimate{(sum - relative * previous_offset_) / information,
                                1.0 / std::sqrt(information)};
}

void BundleStep::setZero() {
  T_cam_map_ = inverses(problem_.poses);
  system_.setZero();
  right_.setZero(6 * system_.poses());
  diagonal_.setZero(6 * system_.poses());
  right_offset_ = diagonal_offset_ = 0.0;
}

void BundleStep::addOffsetPrior() {
  const double offset = problem_.disparity_offset_px;
  const double absolute = 1.0 / (kRectificationSigma_px * kRectificationSigma_px);
  const double relative = 1.0 / square(problem_.offset_walk_px);
  diagonal_offset_ += absolute + relative;
  right_offset_ -= offset * absolute + (offset - previous_offset_) * relative;
}

void BundleStep::addMotion(const BundleProblem::Motion& motion) {
  const MotionTerms terms = linearised(motion, problem_.poses, camera_.T_robot_cam);
  const int a = freeIndex(motion.a);
  const int b = freeIndex(motion.b);
  const auto addPose = [&](int i, const ReducedSystem::Block& by_pose) {
    if (i < 0) return;
    const ReducedSystem::Block information = by_pose.transpose() * by_pose;
    system_.block(i, i) += information;
    diagonal_.segment<6>(6 * i) += information.diagonal();
    right_.segment<6>(6 * i) -= by_pose.transpose() * terms.residual;
  };
  addPose(a, terms.by_a);
  addPose(b, terms.by_b);
  if (a >= 0 && b >= 0) {
    const ReducedSystem::Block by_both = terms.by_b.transpose() * terms.by_a;
    if (b > a) {
      system_.block(b, a) += by_both;
    } else {
      system_.block(a, b) += by_both.transpose();
    }
  }
}

BundleStep::ObservationTerms BundleStep::termsOf(std::size_t observation,
                                                 const Eigen::Vector3d& position) const {
  const auto& [pose, measurement] = problem_.observations[observation];
  const Pose& T_cam_map = T_cam_map_[static_cast<std::size_t>(pose)];
  ObservationTerms result;
  result.point_cam = T_cam_map * position;
  result.residual = stereo::stereoResidual(result.point_cam,
                                           withoutOffset(measurement, problem_.disparity_offset_px),
                                           camera_, &result.by_point_cam);
  const double root = std::sqrt(huberWeight(result.residual.squaredNorm()));
  result.residual *= root;
  result.by_point_cam *= root;
  result.by_point = result.by_point_cam * T_cam_map.linear();
  result.by_offset = measurement.stereo ? root / measurement.sigma_disparity_px : 0.0;
  return result;
}

/// Adds one observation to the blocks of its pose, its point and the offset.
void BundleStep::add(std::size_t observation, const Eigen::Vector3d& position, PointBlock& block) {
  const ObservationTerms terms = termsOf(observation, position);
  block.inverse.noalias() += terms.by_point.transpose() * terms.by_point;
  block.right.noalias() -= terms.by_point.transpose() * terms.residual;
  block.by_offset += terms.by_offset * terms.by_point.row(2).transpose();
  diagonal_offset_ += terms.by_offset * terms.by_offset;
  right_offset_ -= terms.by_offset * terms.residual.z();
  const int i = freeIndex(problem_.observations[observation].pose);
  if (i < 0) return;
  const Eigen::Matrix<double, 3, 6> by_pose =
      terms.by_point_cam * stereo::pointByPose(terms.point_cam);
  ReducedSystem::Block information;
  information.noalias() = by_pose.transpose() * by_pose;
  system_.block(i, i) += information;
  system_.border(i) += terms.by_offset * by_pose.row(2).transpose();
  diagonal_.segment<6>(6 * i) += information.diagonal();
  right_.segment<6>(6 * i).noalias() -= by_pose.transpose() * terms.residual;
  couplings_.push_back({i, by_pose.transpose() * terms.by_point});
}

/// Damps a point's block, inverts it and takes the point out of the system (Schur complement).
void BundleStep::eliminate(PointBlock& block, double radius) {
  for (int i = 0; i < 3; ++i) {
    block.damping[i] = damping(block.inverse(i, i), radius);
    block.inverse(i, i) += block.damping[i];
  }
  block.inverse = block.inverse.llt().solve(Eigen::Matrix3d::Identity()).eval();
  const Eigen::Vector3d mean = block.inverse * block.right;
  for (auto first = couplings_.begin(); first != couplings_.end(); ++first) {
    Matrix63 gain;
    gain.noalias() = first->by_point * block.inverse;
    system_.right(first->pose).noalias() -= first->by_point * mean;
    system_.border(first->pose).noalias() -= gain * block.by_offset;
    for (auto second = first; second != couplings_.end(); ++second) {
      if (second->pose >= first->pose) {
        system_.block(second->pose, first->pose).noalias() -= second->by_point * gain.transpose();
      } else {
        system_.block(first->pose, second->pose).noalias() -= gain * second->by_point.transpose();
      }
    }
  }
  system_.corner -= block.by_offset.dot(block.inverse * block.by_offset);
  system_.right_corner -= block.by_offset.dot(mean);
}

void BundleStep::dampPoses(double radius) {
  damping_.resize(diagonal_.size());
  for (Eigen::Index k = 0; k < diagonal_.size(); ++k) damping_[k] = damping(diagonal_[k], radius);
  for (int i = 0; i < system_.poses(); ++i) {
    system_.block(i, i).diagonal() += damping_.segment<6>(6 * i);
    system_.right(i) += right_.segment<6>(6 * i);
  }
  damping_offset_ = damping(diagonal_offset_, radius);
  system_.corner += diagonal_offset_ + damping_offset_;
  system_.right_corner += right_offset_;
}

void BundleStep::substituteBack() {
  for (std::size_t point = 0; point < points_.size(); ++point) {
    PointBlock& block = points_[point];
    Eigen::Vector3d right = block.right - step_offset_ * block.by_offset;
    for (std::size_t i = begin(point); i < problem_.points[point].observations_end; ++i) {
      const int pose = freeIndex(problem_.observations[i].pose);
      if (pose < 0) continue;
      const ObservationTerms terms = termsOf(i, problem_.points[point].position);
      const Eigen::Vector3d moved =
          terms.by_point_cam * (stereo::pointByPose(terms.point_cam) * step_.segment<6>(6 * pose));
      right.noalias() -= terms.by_point.transpose() * moved;
    }
    block.step = block.inverse * right;
  }
}

double BundleStep::predictedDecrease() const {
  double decrease = step_.dot(right_ + damping_.cwiseProduct(step_)) +
                    step_offset_ * (right_offset_ + damping_offset_ * step_offset_);
  for (const PointBlock& block : points_) {
    decrease += block.step.dot(block.right + block.damping.cwiseProduct(block.step));
  }
  return 0.5 * decrease;
}

void BundleStep::applyTo(BundleProblem& problem) const {
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    if (free_[i] < 0) continue;
    problem.poses[i] = stereo::retract(problem.poses[i], step_.segment<6>(6 * free_[i]));
  }
  for (std::size_t i = 0; i < points_.size(); ++i) problem.points[i].position += points_[i].step;
  problem.disparity_offset_px += step_offset_;
}

namespace {

/// What a solve changes of a problem.
struct State {
  std::vector<Pose> poses;
  std::vector<BundleProblem::Point> points;
  double disparity_offset_px = 0.0;

  void copyFrom(const BundleProblem& problem) {
    poses = problem.poses;
    points = problem.points;
    disparity_offset_px = problem.disparity_offset_px;
  }
  void swapInto(BundleProblem& problem) {
    std::swap(problem.poses, poses);
    std::swap(problem.points, points);
    problem.disparity_offset_px = disparity_offset_px;
  }
};

}  // namespace

BundleSolution solveBundle(BundleProblem& problem, const StereoCamera& camera, int max_iterations,
                           const StopCondition& stop) {
  constexpr double kMinGain = 1e-3;    ///< accepted ratio of actual to predicted decrease
  constexpr double kTolerance = 1e-4;  ///< relative decrease of the cost at convergence
  const double previous_offset = problem.disparity_offset_px;
  BundleSolution solution;
  double cost = solution.initial_cost = costOf(problem, camera, previous_offset);
  if (!std::isfinite(cost)) return solution;
  BundleStep step(problem, camera, previous_offset);
  State before;
  double radius = 1e4;  // of the trust region
  double shrink = 2.0;
  for (; solution.iterations < max_iterations && !stop(); ++solution.iterations) {
    if (!step.compute(radius)) break;
    before.copyFrom(problem);
    step.applyTo(problem);
    const double decrease = cost - costOf(problem, camera, previous_offset);
    const double gain = decrease / step.predictedDecrease();
    if (gain > kMinGain) {
      cost -= decrease;
      radius = std::min(1e16, radius / std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gain - 1.0, 3)));
      shrink = 2.0;
    } else {
      before.swapInto(problem);
      radius /= shrink;
      shrink *= 2.0;
    }
    if (std::abs(decrease) <= kTolerance * cost) break;
  }
  solution.usable = !stop();
  if (solution.usable) solution.free_offset = step.freeOffset();
  solution.final_cost = cost;
  return solution;
}

}  // namespace headway::slam
