// SPDX-License-Identifier: BSD-3-Clause
// Smoothing of a path by a prior of its motion (Sec. III-C1).
#include "motion_prior.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace headway::objects {
namespace {

// Huber's loss of a squared residual, and its derivative: the weight of the residual.
double huber(double squared, double limit) {
  if (squared <= limit * limit) return squared;
  return 2.0 * limit * std::sqrt(squared) - limit * limit;
}
double huberWeight(double squared, double limit) {
  return squared <= limit * limit ? 1.0 : limit / std::sqrt(squared);
}

}  // namespace

void MotionPriorProblem::set(const std::vector<PlaceMeasurement>& measurements,
                             const PriorStiffness& stiffness) {
  measurements_ = &measurements;
  outlier_sigma_ = stiffness.outlier_sigma;
  terms_.clear();
  steps_.clear();
  terms_.reserve(measurements.size());
  if (stiffness.kind == MotionPriorKind::kLeastKinetic) {
    addKineticTerms(stiffness.weight);
  } else {
    addForceTerms(stiffness.weight);
    addSteps(stiffness.acceleration_mps2);
  }
}

void MotionPriorProblem::addSteps(double acceleration_mps2) {
  const auto& measurements = *measurements_;
  for (std::size_t j = 1; j < measurements.size(); ++j) {
    if (!measurements[j].velocity) continue;
    const GroundVelocity& velocity = *measurements[j].velocity;
    const Time middle = measurements[j].time - velocity.age_s;
    std::size_t to = j;
    while (to > 1 && measurements[to - 1].time >= middle) --to;
    const double dt = measurements[to].time - measurements[to - 1].time;
    const double before = std::max(0.0, measurements[to - 1].time - middle);  // the first place
    const double change = acceleration_mps2 * (0.5 * dt + before);
    const Eigen::Matrix2d covariance =
        velocity.covariance + change * change * Eigen::Matrix2d::Identity();
    steps_.push_back({to, dt * velocity.value, covariance.inverse() / (dt * dt)});
  }
}

Eigen::Vector2d MotionPriorProblem::stepError(const Step& step,
                                              const std::vector<Eigen::Vector3d>& places) const {
  return (places[step.to] - places[step.to - 1]).head<2>() - step.measured;
}

double MotionPriorProblem::stepWeight(const Step& step, const Eigen::Vector2d& error) const {
  return huberWeight(error.dot(step.information * error), outlier_sigma_);
}

void MotionPriorProblem::addKineticTerms(double weight) {
  const auto& measurements = *measurements_;
  for (std::size_t j = 0; j + 1 < measurements.size(); ++j) {
    const double dt = measurements[j + 1].time - measurements[j].time;
    const double rate = 1.0 / (dt + 1e-9);  // eps of eq. (5)
    terms_.push_back({j, 2, {-rate, rate, 0.0}, weight * dt});
  }
}

void MotionPriorProblem::addForceTerms(double weight) {
  const auto& measurements = *measurements_;
  for (std::size_t j = 0; j + 2 < measurements.size(); ++j) {
    const double before = measurements[j + 1].time - measurements[j].time;
    const double after = measurements[j + 2].time - measurements[j + 1].time;
    const double middle = 0.5 * (before + after);
    const double a = 1.0 / (before * middle);
    const double c = 1.0 / (after * middle);
    terms_.push_back({j, 3, {a, -a - c, c}, weight * middle});
  }
}

double MotionPriorProblem::squaredResidual(std::size_t j, const Eigen::Vector3d& place) const {
  const PlaceMeasurement& m = (*measurements_)[j];
  const Eigen::Vector3d e = place - m.measured;
  return e.head<2>().dot(m.information * e.head<2>()) + m.vertical_information * e.z() * e.z();
}

Eigen::Vector3d MotionPriorProblem::formOf(const PriorTerm& term,
                                           const std::vector<Eigen::Vector3d>& places) const {
  Eigen::Vector3d form =
      term.coefficients(0) * places[term.first] + term.coefficients(1) * places[term.first + 1];
  if (term.count == 3) form += term.coefficients(2) * places[term.first + 2];
  return form;
}

MotionPriorProblem::Value MotionPriorProblem::evaluate(
    const std::vector<Eigen::Vector3d>& places) const {
  const double quadratic = outlier_sigma_ * outlier_sigma_;
  double twice = 0.0;
  double largest = 0.0;  // squared residual
  const auto addLoss = [&](double squared) {
    largest = std::max(largest, squared);
    twice += huber(squared, outlier_sigma_);
  };
  for (std::size_t j = 0; j < places.size(); ++j) addLoss(squaredResidual(j, places[j]));
  for (const PriorTerm& term : terms_) twice += term.weight * formOf(term, places).squaredNorm();
  for (const Step& step : steps_) {
    const Eigen::Vector2d error = stepError(step, places);
    addLoss(error.dot(step.information * error));
  }
  return {0.5 * twice, largest <= quadratic};
}

double MotionPriorProblem::cost(const std::vector<Eigen::Vector3d>& places) const {
  return evaluate(places).cost;
}

std::vector<Eigen::Vector3d> MotionPriorProblem::gradient(
    const std::vector<Eigen::Vector3d>& places) const {
  std::vector<Eigen::Vector3d> gradient(places.size(), Eigen::Vector3d::Zero());
  for (std::size_t j = 0; j < places.size(); ++j) {
    const PlaceMeasurement& m = (*measurements_)[j];
    const Eigen::Vector3d e = places[j] - m.measured;
    const double weight = huberWeight(squaredResidual(j, places[j]), outlier_sigma_);
    gradient[j].head<2>() = weight * m.information * e.head<2>();
    gradient[j].z() = weight * m.vertical_information * e.z();
  }
  addPriorSlope(places, gradient);
  return gradient;
}

void MotionPriorProblem::addPriorSlope(const std::vector<Eigen::Vector3d>& places,
                                       std::vector<Eigen::Vector3d>& slope) const {
  for (const PriorTerm& term : terms_) {
    const Eigen::Vector3d pull = term.weight * formOf(term, places);
    for (int i = 0; i < term.count; ++i) slope[term.first + i] += term.coefficients(i) * pull;
  }
  for (const Step& step : steps_) {
    const Eigen::Vector2d error = stepError(step, places);
    const Eigen::Vector2d pull = stepWeight(step, error) * step.information * error;
    slope[step.to].head<2>() += pull;
    slope[step.to - 1].head<2>() -= pull;
  }
}

void MotionPriorProblem::addMeasurements(const std::vector<Eigen::Vector3d>& places) {
  slope_.resize(places.size());
  for (std::size_t j = 0; j < places.size(); ++j) {
    const PlaceMeasurement& m = (*measurements_)[j];
    const Eigen::Vector3d e = places[j] - m.measured;
    const double squared = squaredResidual(j, places[j]);
    const double weight = huberWeight(squared, outlier_sigma_);
    horizontal_.diagonal[j] = weight * m.information;
    vertical_.diagonal[j](0) = weight * m.vertical_information;
    slope_[j].head<2>() = weight * m.information * e.head<2>();
    slope_[j].z() = weight * m.vertical_information * e.z();
  }
  addPriorSlope(places, slope_);
  for (std::size_t j = 0; j < places.size(); ++j) {
    horizontal_.right[j] = -slope_[j].head<2>();
    vertical_.right[j](0) = -slope_[j].z();
  }
}

void MotionPriorProblem::addPrior() {
  const auto add = [](auto& block, double value) { block.diagonal().array() += value; };
  for (const PriorTerm& term : terms_) {
    const std::size_t j = term.first;
    const Eigen::Vector3d& c = term.coefficients;
    const Eigen::Vector3d weighted = term.weight * c;
    const auto addTo = [&](auto& system) {
      add(system.diagonal[j], weighted(0) * c(0));
      add(system.first[j], weighted(0) * c(1));
      add(system.diagonal[j + 1], weighted(1) * c(1));
      if (term.count < 3) return;
      add(system.second[j], weighted(0) * c(2));
      add(system.first[j + 1], weighted(1) * c(2));
      add(system.diagonal[j + 2], weighted(2) * c(2));
    };
    addTo(horizontal_);
    addTo(vertical_);
  }
}

void MotionPriorProblem::addStepCurvature(const std::vector<Eigen::Vector3d>& places) {
  for (const Step& step : steps_) {
    const Eigen::Matrix2d curvature = stepWeight(step, stepError(step, places)) * step.information;
    horizontal_.diagonal[step.to] += curvature;
    horizontal_.diagonal[step.to - 1] += curvature;
    horizontal_.first[step.to - 1] -= curvature;
  }
}

void MotionPriorProblem::solveStep(const std::vector<Eigen::Vector3d>& places,
                                   std::vector<Eigen::Vector3d>& step) {
  const std::size_t n = places.size();
  horizontal_.reset(n);
  vertical_.reset(n);
  addMeasurements(places);
  addPrior();
  addStepCurvature(places);
  horizontal_.solve();
  vertical_.solve();
  for (std::size_t j = 0; j < n; ++j) step[j] << horizontal_.right[j], vertical_.right[j];
}

MotionPriorProblem::Summary MotionPriorProblem::refine(std::vector<Eigen::Vector3d>& places,
                                                       int max_iterations, double tolerance_m) {
  Value value = evaluate(places);
  Summary summary;
  summary.initial_cost = summary.final_cost = value.cost;
  step_.resize(places.size());
  candidate_.resize(places.size());
  while (summary.iterations < max_iterations) {
    ++summary.iterations;
    solveStep(places, step_);
    double farthest = 0.0;
    for (std::size_t j = 0; j < places.size(); ++j) {
      candidate_[j] = places[j] + step_[j];
      farthest = std::max(farthest, step_[j].squaredNorm());
    }
    const Value next = evaluate(candidate_);
    if (!(next.cost <= summary.final_cost)) break;  // by rounding: it is at the minimum
    // The places of which the cost is quadratic are convex: such a step ends at the minimum.
    const bool is_minimum = value.is_quadratic && next.is_quadratic;
    places.swap(candidate_);
    value = next;
    summary.final_cost = next.cost;
    if (is_minimum || farthest <= tolerance_m * tolerance_m) break;
  }
  return summary;
}

}  // namespace headway::objects
