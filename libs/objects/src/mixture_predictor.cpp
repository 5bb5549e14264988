// SPDX-License-Identifier: BSD-3-Clause
#include "mixture_predictor.h"

#include <headway/core/statistics.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace headway::objects {
namespace {

constexpr int kModes = 4;
// Frequency at which each path was the nearest to the true one, rounded.
constexpr std::array<double, kModes> kProbabilities = {0.55, 0.25, 0.1, 0.1};
constexpr double kMinPositionSigma_m = 0.03;
constexpr double kMaxTurnRate = 3.0;  // [rad/s]

// The direction turned by a small angle: by series, exact to 3e-7 at the fastest turn.
Eigen::Vector2d turnedBy(const Eigen::Vector2d& direction, double angle) {
  const double a2 = angle * angle;
  const double c = 1.0 - a2 * (1.0 / 2.0 - a2 * (1.0 / 24.0));
  const double s = angle * (1.0 - a2 * (1.0 / 6.0 - a2 * (1.0 / 120.0)));
  return {c * direction.x() - s * direction.y(), s * direction.x() + c * direction.y()};
}

Eigen::Matrix2d ellipse(double along, double across, const Eigen::Vector2d& direction) {
  const double c = direction.x();
  const double s = direction.y();
  const double cross = (along - across) * c * s;
  Eigen::Matrix2d covariance;
  covariance << along * c * c + across * s * s, cross, cross, along * s * s + across * c * c;
  return covariance;
}

}  // namespace

/// The directions that a path takes step by step, and the spread about it.
struct MixturePredictor::Course {
  std::array<Eigen::Vector2d, kPredictionSamples> directions;
  Spread covariances;
};

MixturePredictor::Tables MixturePredictor::tabulate(const ManoeuvreParams& params) {
  Tables tables;
  const auto faded = [](double t, double time) { return -time * std::expm1(-t / time); };
  double turned = 0.0;
  for (int j = 0; j < kPredictionSamples; ++j) {
    const double t = (j + 1) * kPredictionStep_s;
    const double middle = faded(t - 0.5 * kPredictionStep_s, params.turn_fade_s);
    tables.gained[j] = params.acceleration_fade_s * (t - faded(t, params.acceleration_fade_s));
    tables.turned[j] = middle - turned;
    turned = middle;
    tables.along[j] = square(params.acceleration_sigma_mps2 * 0.5 * t * t);
    tables.across[j] = square(params.lateral_sigma_mps2 * 0.5 * t * t);
  }
  return tables;
}

MixturePredictor::MixturePredictor(const PredictorParams& params)
    : params_(params.manoeuvres),
      tables_{tabulate(params.manoeuvres.vehicle), tabulate(params.manoeuvres.cyclist),
              tabulate(params.manoeuvres.pedestrian)} {}

void MixturePredictor::predictInto(const MotionHistory& history,
                                   std::vector<PredictedPath>& paths) const {
  if (history.path.empty()) return paths.clear();
  const ManoeuvreParams& params = params_.of(history.object_class);
  const Tables& tables = tables_.of(history.object_class);
  const Manoeuvre now = fitManoeuvre(history, params);
  const double moves = square(now.speed) / (square(now.speed) + square(params.cruising_speed_mps));
  const auto common = commonSpread(history.position_covariance, now.velocity_covariance);

  const double turn_rate = std::clamp(now.turn_rate, -kMaxTurnRate, kMaxTurnRate);
  const Course turning = course(tables, now.direction, turn_rate, common, moves);
  const Course straight = course(tables, now.direction, 0.0, common, moves);
  const double other = moves * params.alternative_mps2;
  paths.resize(kModes);
  walk(history, tables, turning, now.speed, now.acceleration, paths[0]);
  walk(history, tables, straight, now.speed, 0.0, paths[1]);
  walk(history, tables, turning, now.speed, now.acceleration - other, paths[2]);
  walk(history, tables, turning, now.speed, now.acceleration + other, paths[3]);
  for (int mode = 0; mode < kModes; ++mode) {
    paths[mode].mode = mode;
    paths[mode].probability = kProbabilities[mode];
  }
}

MixturePredictor::Spread MixturePredictor::commonSpread(const Eigen::Matrix2d& place,
                                                        const Eigen::Matrix2d& velocity) {
  const Eigen::Matrix2d start = place + square(kMinPositionSigma_m) * Eigen::Matrix2d::Identity();
  Spread spread;
  for (int j = 0; j < kPredictionSamples; ++j) {
    spread[j] = start + square((j + 1) * kPredictionStep_s) * velocity;
  }
  return spread;
}

MixturePredictor::Course MixturePredictor::course(const Tables& tables, Eigen::Vector2d direction,
                                                  double turn_rate, const Spread& common,
                                                  double moves) {
  Course course;
  for (int j = 0; j < kPredictionSamples; ++j) {
    direction = turnedBy(direction, turn_rate * tables.turned[j]);
    course.directions[j] = direction;
    course.covariances[j] =
        common[j] + ellipse(moves * tables.along[j], moves * tables.across[j], direction);
  }
  return course;
}

void MixturePredictor::walk(const MotionHistory& history, const Tables& tables,
                            const Course& course, double speed, double acceleration,
                            PredictedPath& path) {
  path.points.resize(kPredictionSamples);
  Eigen::Vector3d position = history.path.back().position;
  double walked = 0.0;
  for (int j = 0; j < kPredictionSamples; ++j) {
    PredictedPoint& point = path.points[j];
    point.horizon_s = (j + 1) * kPredictionStep_s;
    const double distance = speed * point.horizon_s + acceleration * tables.gained[j];
    if (distance > walked) {  // a braking object stops; it does not roll back
      position.head<2>() += (distance - walked) * course.directions[j];
      walked = distance;
    }
    point.position = position;
    point.covariance = course.covariances[j];
  }
}

}  // namespace headway::objects
