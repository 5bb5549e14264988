// SPDX-License-Identifier: BSD-3-Clause
// The last frames of a track's path, measured and smoothed.
#pragma once

#include <headway/core/pose.h>
#include <headway/core/statistics.h>
#include <headway/core/track.h>
#include <headway/objects/objects_params.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <vector>

#include "kalman_filter.h"
#include "measurement_model.h"
#include "motion_prior.h"

namespace headway::objects {

/// Interval of the frames in which objects are detected, as their times show it.
///
/// Frames that were dropped do not count: the median of the last intervals, in whole hertz.
class DetectionRate {
 public:
  /// Takes the time of the next frame.
  void add(Time time);
  /// The next frame may have an earlier time.
  void restart() { last_.reset(); }

  /// Number of frames in a time, to the nearest.
  [[nodiscard]] int framesIn(double time_s) const {
    return static_cast<int>(std::lround(time_s * hz_));
  }
  /// As many frames, but two at least: one observation alone proves nothing.
  [[nodiscard]] int observationsIn(double time_s) const { return std::max(2, framesIn(time_s)); }
  [[nodiscard]] double hz() const { return hz_; }

  /// Before two frames are known; of given sums of scores.
  static constexpr double kUsual_hz = headway::FrameRate::kAssumed_hz;

 private:
  double hz_ = kUsual_hz;
  std::optional<Time> last_;
  std::deque<double> intervals_;  ///< the last [s]
};

/// n-point moving average of measured positions, for a moving object (Sec. III-C2).
///
/// Each position is first extrapolated to the newest one's time with the object's velocity, because
/// a plain average lags behind a moving object by half its span.
///
/// @param measurements  at least one, oldest first
/// @param points        n >= 1
/// @return              map frame [m]
[[nodiscard]] Eigen::Vector3d movingAverage(const std::vector<PlaceMeasurement>& measurements,
                                            int points, const Eigen::Vector3d& velocity);

/// The same with Gaussian weights that decrease with age.
///
/// @param sigma_s  width of the Gaussian [s]
[[nodiscard]] Eigen::Vector3d gaussianAverage(const std::vector<PlaceMeasurement>& measurements,
                                              double sigma_s, const Eigen::Vector3d& velocity);

/// The last frames of one object's path: measured and smoothed positions.
struct Trajectory {
  std::vector<TrajectoryPoint> path;           ///< as smoothed, oldest first
  std::vector<PlaceMeasurement> measurements;  ///< the measured positions, same order

  /// Appends a position; `position` is the initial value of the smoothed one.
  void append(std::size_t frame, Time time, const MeasuredBox& measured,
              const Eigen::Vector3d& position, double yaw);

  /// Removes and returns the positions that are final: all but the last `window`.
  [[nodiscard]] std::vector<TrajectoryPoint> finalise(std::size_t window);
};

/// Smooths trajectories: short ones with a moving average, mature ones with a motion prior.
class TrajectorySmoother {
 public:
  /// @param rate  must outlive the smoother
  TrajectorySmoother(const SmoothingParams& params, const DetectionRate& rate)
      : params_(params), rate_(rate) {}

  /// Updates the path after a position was appended; lines 5 to 11 of Algorithm 1.
  ///
  /// @param mature    the track is long enough for the prior
  /// @param standing  the object is classified as static: the prior is stiffer
  void refine(Trajectory& trajectory, const KalmanFilter& filter, MotionGroup group, bool mature,
              bool standing);

 private:
  /// The newest position: weighted mean of filter and n-point moving average (Sec. III-C2).
  void blendWithFilter(Trajectory& trajectory, const KalmanFilter& filter) const;
  /// The whole window: motion prior and measurements (Sec. III-C1).
  void optimizeGrown(Trajectory& trajectory, const PriorStiffness& stiffness);
  /// The newest measured position, smoothed over its predecessors (Sec. III-C3, G(P)).
  void blurNewest(Trajectory& trajectory, const Eigen::Vector3d& velocity) const;
  [[nodiscard]] PriorStiffness stiffnessOf(MotionGroup group, bool standing) const;

  SmoothingParams params_;
  const DetectionRate& rate_;
  MotionPriorProblem problem_;           ///< its memory is used again
  std::vector<Eigen::Vector3d> places_;  ///< buffer of one path
};

}  // namespace headway::objects
