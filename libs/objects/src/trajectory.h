#pragma once

#include <headway/core/track.h>
#include <headway/objects/objects_params.h>

#include <vector>

#include "kalman_filter.h"
#include "measured_box.h"
#include "motion_prior.h"

namespace headway::objects {

/// The last frames of one object's path: places as measured, and as smoothed from them.
struct Trajectory {
  std::vector<TrajectoryPoint> path;           ///< as smoothed, oldest first
  std::vector<PlaceMeasurement> measurements;  ///< the places behind them, same order
  std::size_t length = 0;                      ///< |S_i|: places since the track began

  /// Appends a place; `position` is the first guess of where it will be smoothed to.
  void append(std::size_t frame, Time time, const MeasuredBox& measured,
              const Eigen::Vector3d& position, double yaw);

  /// Takes out the places that no later frame will change: all but the last `window`.
  [[nodiscard]] std::vector<TrajectoryPoint> finalise(std::size_t window);
};

/// Smooths trajectories: young ones with a moving average, grown ones with a motion prior.
class TrajectorySmoother {
 public:
  explicit TrajectorySmoother(const SmoothingParams& params) : params_(params) {}

  /// Updates the path after a place was appended; line 5 to 11 of Algorithm 1.
  ///
  /// @param standing  the object is known to stand: its path is held together more tightly
  void refine(Trajectory& trajectory, const KalmanFilter& filter, MotionGroup group,
              bool standing) const;

 private:
  /// The newest place: filter and n-point moving average, weighted (Sec. III-C2, Initialization).
  void blendYoung(Trajectory& trajectory, const KalmanFilter& filter) const;
  /// The whole window: motion prior and measurements (Sec. III-C1).
  void optimizeGrown(Trajectory& trajectory, const PriorStiffness& stiffness) const;
  /// The newest measured place, blurred over its predecessors (Sec. III-C3, G(P)).
  void blurNewest(Trajectory& trajectory, const Eigen::Vector3d& velocity) const;
  [[nodiscard]] PriorStiffness stiffnessOf(MotionGroup group, bool standing) const;

  SmoothingParams params_;
};

}  // namespace headway::objects
