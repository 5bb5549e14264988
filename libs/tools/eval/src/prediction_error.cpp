// SPDX-License-Identifier: BSD-3-Clause
// Errors of predictions, and the cases that they are of.
#include <headway/core/assignment.h>
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

namespace {

constexpr std::size_t kHistoryFrames = 20;  // before the current one
constexpr double kHorizonEnd_s = kHorizonStep_s * kHorizons;

bool isMovableClass(ObjectClass object_class) {
  return isVehicle(object_class) || object_class == ObjectClass::kPedestrian ||
         object_class == ObjectClass::kCyclist;
}

/// True positions at all horizons; nullopt if the truth ends earlier or has a gap.
std::optional<HorizonPath> futureOf(const TrueObject& object, Time now, double max_gap_s) {
  HorizonPath future;
  for (std::size_t j = 0; j < kHorizons; ++j) {
    const auto position =
        object.positionAt(now + kHorizonStep_s * static_cast<double>(j + 1), max_gap_s);
    if (!position) return std::nullopt;
    future[j] = position->head<2>();
  }
  return future;
}

/// Whether the path has every frame between its points `first` and `last`.
bool isConsecutive(const TrueObject& object, std::size_t first, std::size_t last) {
  return last < object.path.size() &&
         object.path[last].frame - object.path[first].frame == last - first;
}

/// Whether a track of class `tracked` may be an object; one of unknown class may be any.
bool mayBe(ObjectClass object_class, ObjectClass tracked) {
  return tracked == ObjectClass::kUnknown || tracked == object_class;
}

/// Pairs of predictions and true objects within `max_distance_m` at the first horizon.
std::vector<CandidatePair> nearby(const std::vector<TrueObject>& objects,
                                  const std::vector<TrackPrediction>& predictions,
                                  const std::vector<std::size_t>& rows, double max_distance_m,
                                  double max_gap_s) {
  std::vector<CandidatePair> pairs;
  for (const std::size_t row : rows) {
    const auto& prediction = predictions[row];
    const auto& next = prediction.paths.front().points.front();
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (!mayBe(objects[i].object_class, prediction.object_class)) continue;
      const auto truth = objects[i].positionAt(prediction.time + next.horizon_s, max_gap_s);
      if (!truth) continue;
      const double distance = (next.position - *truth).head<2>().norm();
      if (distance <= max_distance_m) pairs.push_back({row, i, distance});
    }
  }
  return pairs;
}

}  // namespace

std::vector<HistoryCase> historyCases(const std::vector<TrueObject>& objects,
                                      double frame_interval_s) {
  const auto later = static_cast<std::size_t>(std::lround(kHorizonEnd_s / frame_interval_s));
  std::vector<HistoryCase> cases;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const auto& object = objects[i];
    if (!isMovableClass(object.object_class)) continue;
    for (std::size_t first = 0; first < object.path.size(); ++first) {
      const std::size_t now = first + kHistoryFrames;
      if (!isConsecutive(object, first, now + later)) continue;
      const auto future = futureOf(object, object.path[now].time, 2.0 * frame_interval_s);
      if (!future) continue;
      const auto begin = object.path.begin() + static_cast<std::ptrdiff_t>(first);
      cases.push_back({i, {begin, begin + kHistoryFrames + 1}, *future});
    }
  }
  return cases;
}

TrackCases trackCases(const std::vector<TrueObject>& objects,
                      const std::vector<TrackPrediction>& predictions, double max_distance_m,
                      double max_gap_s) {
  std::map<std::size_t, std::vector<std::size_t>> rows_of_frame;
  for (std::size_t row = 0; row < predictions.size(); ++row) {
    rows_of_frame[predictions[row].frame].push_back(row);
  }
  TrackCases result;
  for (const auto& [frame, rows] : rows_of_frame) {
    const auto pairs = assignPairs(nearby(objects, predictions, rows, max_distance_m, max_gap_s));
    result.unmatched += rows.size() - pairs.size();
    for (const auto& pair : pairs) {
      const auto future = futureOf(objects[pair.column], predictions[pair.row].time, max_gap_s);
      if (future) {
        result.cases.push_back({pair.row, pair.column, *future});
      } else {
        ++result.cut_short;
      }
    }
  }
  return result;
}

}  // namespace headway::eval
