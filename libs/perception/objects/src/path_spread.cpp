// SPDX-License-Identifier: BSD-3-Clause
#include "path_spread.h"

#include <headway/core/statistics.h>

#include <algorithm>

#include "mean_sigma.h"
#include "recent_motion.h"

namespace headway::objects {
DirectedSpread::DirectedSpread(const PathSpread& spread, const Eigen::Vector2d& direction) {
  const double c = direction.x();
  const double s = direction.y();
  Eigen::Matrix2d along;
  along << c * c, c * s, c * s, s * s;
  const Eigen::Matrix2d across = Eigen::Matrix2d::Identity() - along;
  start_ = square(spread.position_sigma) * Eigen::Matrix2d::Identity();
  velocity_ = square(spread.along_velocity) * along + square(spread.across_velocity) * across;
  acceleration_ = 0.25 * (square(spread.along_acceleration) * along +
                          square(spread.across_acceleration) * across);
}

PathSpread spreadOf(const MotionHistory& history, const ManoeuvreParams& params, double window_s) {
  constexpr double kMinPositionSigma_m = 0.05;
  constexpr double kUnknownSpeed = 5.0;  // of an object seen once [m/s]
  PathSpread spread;
  const double sigma = meanSigma(history.position_covariance);
  spread.position_sigma = std::max(sigma, kMinPositionSigma_m);
  const double span = std::min(window_s, spanOf(history.path));
  const double velocity = span > 0.0 ? std::min(kUnknownSpeed, sigma / span) : kUnknownSpeed;
  spread.along_velocity = velocity;
  spread.across_velocity = velocity;
  spread.along_acceleration = params.acceleration_sigma_mps2;
  spread.across_acceleration = params.lateral_sigma_mps2;
  return spread;
}

PredictedPath& singlePath(const MotionHistory& history, std::vector<PredictedPath>& paths) {
  paths.resize(1);
  PredictedPath& path = paths.front();
  path.mode = 0;
  path.probability = 1.0;
  path.points.resize(kPredictionSamples);
  const double z = history.path.back().position.z();
  for (int j = 0; j < kPredictionSamples; ++j) {
    path.points[j].horizon_s = (j + 1) * kPredictionStep_s;
    path.points[j].position.z() = z;
  }
  return path;
}

void writeStanding(const MotionHistory& history, const PathSpread& spread,
                   std::vector<PredictedPath>& paths) {
  if (history.path.empty()) {
    paths.clear();
    return;
  }
  const DirectedSpread directed(spread, Eigen::Vector2d::UnitX());
  for (PredictedPoint& point : singlePath(history, paths).points) {
    point.position = history.path.back().position;
    point.covariance = directed.covariance(point.horizon_s);
  }
}

}  // namespace headway::objects
