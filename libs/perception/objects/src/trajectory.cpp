// SPDX-License-Identifier: BSD-3-Clause
// The last frames of a track's path, measured and smoothed.
#include "trajectory.h"

#include <headway/core/statistics.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace headway::objects {
namespace {

Eigen::Vector3d carriedOn(const PlaceMeasurement& place, Time time,
                          const Eigen::Vector3d& velocity) {
  return place.measured + (time - place.time) * velocity;
}

}  // namespace

void DetectionRate::add(Time time) {
  if (last_) intervals_.push_back(time - *last_);
  last_ = time;
  if (intervals_.empty()) return;
  if (intervals_.size() > 10) intervals_.pop_front();
  hz_ = std::max(1.0, std::round(1.0 / median({intervals_.begin(), intervals_.end()})));
}

Eigen::Vector3d movingAverage(const std::vector<PlaceMeasurement>& measurements, int points,
                              const Eigen::Vector3d& velocity) {
  const std::size_t count = std::min(measurements.size(), static_cast<std::size_t>(points));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t j = measurements.size() - count; j < measurements.size(); ++j) {
    sum += carriedOn(measurements[j], measurements.back().time, velocity);
  }
  return sum / static_cast<double>(count);
}

Eigen::Vector3d gaussianAverage(const std::vector<PlaceMeasurement>& measurements, double sigma_s,
                                const Eigen::Vector3d& velocity) {
  constexpr double kMaxSigmas = 4.0;  // standard deviations: beyond, the weight is zero
  const Time now = measurements.back().time;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0.0;
  for (auto place = measurements.rbegin(); place != measurements.rend(); ++place) {
    const double age = (now - place->time) / sigma_s;
    if (age > kMaxSigmas) break;
    const double weight = std::exp(-0.5 * age * age);
    sum += weight * carriedOn(*place, now, velocity);
    weights += weight;
  }
  return sum / weights;
}

void Trajectory::append(std::size_t frame, Time time, const MeasuredBox& measured,
                        const Eigen::Vector3d& position, double yaw) {
  path.push_back({frame, time, position, yaw});
  measurements.push_back({time, measured.position, measured.covariance.inverse(),
                          1.0 / measured.vertical_variance, measured.velocity});
}

std::vector<TrajectoryPoint> Trajectory::finalise(std::size_t window) {
  if (path.size() <= window) return {};
  const auto count = static_cast<std::ptrdiff_t>(path.size() - window);
  std::vector<TrajectoryPoint> finalised(path.begin(), path.begin() + count);
  path.erase(path.begin(), path.begin() + count);
  measurements.erase(measurements.begin(), measurements.begin() + count);
  return finalised;
}

void TrajectorySmoother::refine(Trajectory& trajectory, const KalmanFilter& filter,
                                MotionGroup group, bool mature, bool standing) {
  if (params_.gaussian_smoothing) blurNewest(trajectory, filter.velocity());
  if (mature) {
    optimizeGrown(trajectory, stiffnessOf(group, standing));
  } else {
    blendWithFilter(trajectory, filter);
  }
}

void TrajectorySmoother::blendWithFilter(Trajectory& trajectory, const KalmanFilter& filter) const {
  const Eigen::Vector3d average =
      movingAverage(trajectory.measurements, std::max(1, rate_.framesIn(params_.average_time_s)),
                    filter.velocity());
  const double w_k = params_.filter_weight;
  const double w_n = params_.average_weight;
  trajectory.path.back().position = (w_k * filter.position() + w_n * average) / (w_k + w_n);
}

void TrajectorySmoother::optimizeGrown(Trajectory& trajectory, const PriorStiffness& stiffness) {
  places_.clear();
  for (const TrajectoryPoint& point : trajectory.path) places_.push_back(point.position);
  problem_.set(trajectory.measurements, stiffness);
  problem_.refine(places_, params_.max_iterations, params_.tolerance_m);
  for (std::size_t j = 0; j < places_.size(); ++j) trajectory.path[j].position = places_[j];
}

void TrajectorySmoother::blurNewest(Trajectory& trajectory, const Eigen::Vector3d& velocity) const {
  trajectory.measurements.back().measured =
      gaussianAverage(trajectory.measurements, params_.gaussian_sigma_s, velocity);
}

PriorStiffness TrajectorySmoother::stiffnessOf(MotionGroup group, bool standing) const {
  PriorStiffness stiffness;
  stiffness.kind = params_.motion_prior;
  stiffness.outlier_sigma = params_.outlier_sigma;
  if (params_.motion_prior == MotionPriorKind::kLeastKinetic) {
    stiffness.weight = params_.kinetic_scale_per_joule * params_.kinetic_weight_kg.of(group);
  } else {
    const double fraction = standing ? params_.force_standing_ratio : 1.0;
    const double sigma = fraction * params_.force_sigma_mps2.of(group);
    stiffness.weight = 1.0 / (sigma * sigma * params_.force_time_s);
    stiffness.acceleration_mps2 = sigma;
  }
  return stiffness;
}

}  // namespace headway::objects
