// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/objects/predictor.h>

#include <Eigen/Core>

namespace headway::objects {

/// Growth of the uncertainty of a predicted position: errors of position, of velocity and of
/// acceleration, along the path and across it.
struct PathSpread {
  double position_sigma = 0.0;       ///< [m]
  double along_velocity = 0.0;       ///< [m/s]
  double across_velocity = 0.0;      ///< [m/s]
  double along_acceleration = 0.0;   ///< [m/s^2]
  double across_acceleration = 0.0;  ///< [m/s^2]
};

/// A spread about a path that runs along one direction.
class DirectedSpread {
 public:
  /// @param direction  unit length
  DirectedSpread(const PathSpread& spread, const Eigen::Vector2d& direction);

  /// Covariance at one horizon [m^2].
  [[nodiscard]] Eigen::Matrix2d covariance(double horizon_s) const {
    const double square = horizon_s * horizon_s;
    return start_ + square * (velocity_ + square * acceleration_);
  }

 private:
  Eigen::Matrix2d start_, velocity_, acceleration_;
};

/// The spread of a predictor that estimates velocities from `window_s` of the history.
[[nodiscard]] PathSpread spreadOf(const MotionHistory& history, const ManoeuvreParams& params,
                                  double window_s);

/// Sets `paths` to one path at constant position; to none if the history is empty.
void writeStanding(const MotionHistory& history, const PathSpread& spread,
                   std::vector<PredictedPath>& paths);

/// Sets `paths` to one path of kPredictionSamples samples with horizons and z.
PredictedPath& singlePath(const MotionHistory& history, std::vector<PredictedPath>& paths);

}  // namespace headway::objects
