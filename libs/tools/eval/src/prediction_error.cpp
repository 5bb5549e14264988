// SPDX-License-Identifier: BSD-3-Clause
#include <headway/eval/prediction_error.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace headway::eval {
namespace {

constexpr std::array<double, 3> kEllipses = {0.50, 0.90, 0.95};
constexpr std::array<std::size_t, 3> kSeconds = {9, 19, 29};  // index of 1, 2, 3 s

std::array<double, kHorizons> errorsOf(const PredictedPath& path, const HorizonPath& future) {
  std::array<double, kHorizons> errors{};
  for (std::size_t j = 0; j < kHorizons; ++j) {
    errors[j] = (path.points[j].position.head<2>() - future[j]).norm();
  }
  return errors;
}

double meanOf(const std::array<double, kHorizons>& errors) {
  return std::accumulate(errors.begin(), errors.end(), 0.0) / kHorizons;
}

bool isPositiveDefinite(const Eigen::Matrix2d& m) {
  return m.allFinite() && m(0, 0) > 0.0 && m.determinant() > 0.0;
}

void requireHorizons(const PredictedPath& path) {
  bool is_valid = path.points.size() == kHorizons;
  for (std::size_t j = 0; is_valid && j < kHorizons; ++j) {
    is_valid =
        std::abs(path.points[j].horizon_s - kHorizonStep_s * static_cast<double>(j + 1)) < 1e-3;
  }
  if (!is_valid) {
    throw std::invalid_argument(
        "PredictionEvaluator: a path must have points at 0.1 s, 0.2 s ... 3.0 s");
  }
}

}  // namespace

void PredictionEvaluator::add(ObjectClass object_class, const std::vector<PredictedPath>& paths,
                              const HorizonPath& future) {
  if (paths.empty()) throw std::invalid_argument("PredictionEvaluator: no path is given");
  for (const auto& path : paths) requireHorizons(path);
  classes_[object_class].add(paths, future);
}

void PredictionEvaluator::add(const PredictionEvaluator& other) {
  for (const auto& [object_class, sums] : other.classes_) classes_[object_class].add(sums);
}

PredictionErrors PredictionEvaluator::errors() const {
  PredictionErrors result;
  Sums all;
  for (const auto& [object_class, sums] : classes_) {
    result.classes[object_class] = sums.errors();
    all.add(sums);
  }
  result.all = all.errors();
  return result;
}

void PredictionEvaluator::Sums::add(const std::vector<PredictedPath>& paths,
                                    const HorizonPath& future) {
  const auto& most_probable =
      *std::max_element(paths.begin(), paths.end(),
                        [](const auto& a, const auto& b) { return a.probability < b.probability; });
  const auto errors = errorsOf(most_probable, future);
  ++cases;
  for (std::size_t j = 0; j < kHorizons; ++j) error[j] += errors[j];
  for (std::size_t s = 0; s < kSeconds.size(); ++s) {
    if (errors[kSeconds[s]] > kMissDistance_m) ++misses[s];
  }
  double best = meanOf(errors);
  for (const auto& path : paths) best = std::min(best, meanOf(errorsOf(path, future)));
  best_ade += best;
  addCoverage(most_probable, future);
}

void PredictionEvaluator::Sums::addCoverage(const PredictedPath& path, const HorizonPath& future) {
  const bool has_covariance =
      std::all_of(path.points.begin(), path.points.end(),
                  [](const auto& point) { return isPositiveDefinite(point.covariance); });
  if (!has_covariance) return;
  ++with_covariance;
  std::array<double, kHorizons> squared{};
  for (std::size_t j = 0; j < kHorizons; ++j) {
    const Eigen::Vector2d e = path.points[j].position.head<2>() - future[j];
    squared[j] = e.dot(path.points[j].covariance.inverse() * e);
    nees += squared[j] / kHorizons;
  }
  for (std::size_t p = 0; p < kEllipses.size(); ++p) {
    const double limit = -2.0 * std::log(1.0 - kEllipses[p]);
    for (std::size_t s = 0; s < kSeconds.size(); ++s) {
      if (squared[kSeconds[s]] <= limit) ++inside[p][s];
    }
  }
}

void PredictionEvaluator::Sums::add(const Sums& other) {
  cases += other.cases;
  with_covariance += other.with_covariance;
  best_ade += other.best_ade;
  nees += other.nees;
  for (std::size_t j = 0; j < kHorizons; ++j) error[j] += other.error[j];
  for (std::size_t s = 0; s < kSeconds.size(); ++s) {
    misses[s] += other.misses[s];
    for (std::size_t p = 0; p < kEllipses.size(); ++p) inside[p][s] += other.inside[p][s];
  }
}

PredictionError PredictionEvaluator::Sums::errors() const {
  PredictionError result;
  result.cases = cases;
  if (cases == 0) return result;
  const auto count = static_cast<double>(cases);
  for (std::size_t j = 0; j < kHorizons; ++j) result.mean_error_m[j] = error[j] / count;
  result.ade_m = meanOf(result.mean_error_m);
  result.fde_m = result.mean_error_m.back();
  result.best_of_k_ade_m = best_ade / count;
  for (std::size_t s = 0; s < kSeconds.size(); ++s) {
    result.miss_rate[s] = static_cast<double>(misses[s]) / count;
  }
  if (with_covariance == 0) return result;
  const auto covariance_count = static_cast<double>(with_covariance);
  result.nees = nees / covariance_count;
  for (std::size_t p = 0; p < kEllipses.size(); ++p) {
    for (std::size_t s = 0; s < kSeconds.size(); ++s) {
      result.coverage[p][s] = static_cast<double>(inside[p][s]) / covariance_count;
    }
  }
  return result;
}

}  // namespace headway::eval
