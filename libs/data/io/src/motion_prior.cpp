// SPDX-License-Identifier: BSD-3-Clause
// Motion between frames by wheel odometry and inertial samples.
#include "motion_prior.h"

#include <headway/io/trajectory_file.h>

#include <algorithm>
#include <cmath>

namespace headway::io {
namespace {

/// Interpolated value at `time`; nullopt without close neighbours.
std::optional<Eigen::Vector3d> valueAt(const std::deque<Stamped<Eigen::Vector3d>>& samples,
                                       Time time, double max_gap_s) {
  const auto around = neighboursOf(samples, time, max_gap_s);
  if (!around) return std::nullopt;
  return Eigen::Vector3d((1.0 - around->ratio) * around->before + around->ratio * around->after);
}

}  // namespace

template <typename T>
void MotionPriorBuilder::addInOrder(std::deque<Stamped<T>>& samples, Time time,
                                    const T& value) const {
  // A sample far ahead of its predecessor is an outlier if the next one continues the latter.
  const Time before =
      samples.size() > 1 ? samples[samples.size() - 2].time : time - params_.max_odometry_gap_s;
  if (!samples.empty() && time < samples.back().time && time > before &&
      samples.back().time - std::max(before, time) > kMaxTimeGap_s) {
    samples.pop_back();
  }
  if (samples.empty() || time > samples.back().time) samples.push_back({time, value});
}

void MotionPriorBuilder::addOdometry(Time time, const Pose& T_odom_robot) {
  addInOrder(odometry_, time, T_odom_robot);
}

void MotionPriorBuilder::addInertial(const InertialSample& sample) {
  if (sample.angular_velocity) {
    addInOrder(angular_velocity_, sample.time, *sample.angular_velocity);
  }
  if (sample.acceleration) addInOrder(acceleration_, sample.time, *sample.acceleration);
}

MotionPrior MotionPriorBuilder::between(std::optional<Time> previous, Time current) const {
  MotionPrior prior;
  if (previous && *previous < current) {  // else the clock was set back
    const auto T_odom_previous = poseAt(odometry_, *previous, params_.max_odometry_gap_s);
    const auto T_odom_current = poseAt(odometry_, current, params_.max_odometry_gap_s);
    if (T_odom_previous && T_odom_current) {
      prior.T_previous_current = T_odom_previous->inverse() * *T_odom_current;
    }
    prior.R_previous_current = rotationBetween(*previous, current);
    prior.velocity_increment = velocityIncrement(*previous, current);
  }
  prior.specific_force = specificForceAt(current);
  return prior;
}

void MotionPriorBuilder::extrapolate(Time time, double max_s) {
  const auto lags = [&](const auto& samples) {
    return !samples.empty() && samples.back().time < time && time - samples.back().time <= max_s;
  };
  if (lags(angular_velocity_)) angular_velocity_.push_back({time, angular_velocity_.back().value});
  if (lags(acceleration_)) acceleration_.push_back({time, acceleration_.back().value});
  if (!lags(odometry_) || odometry_.size() < 2) return;
  const auto& [last_time, last] = odometry_.back();
  const auto& [before_time, before] = odometry_[odometry_.size() - 2];
  const double ratio = (time - last_time) / (last_time - before_time);
  if (ratio > params_.max_odometry_ratio) return;
  const Pose step = before.inverse() * last;
  const Eigen::AngleAxisd rotation(step.linear());
  Pose ahead = Pose::Identity();
  ahead.translation() = ratio * step.translation();
  ahead.linear() = Eigen::AngleAxisd(ratio * rotation.angle(), rotation.axis()).toRotationMatrix();
  odometry_.push_back({time, last * ahead});
}

void MotionPriorBuilder::limitSamples(std::size_t max_count) {
  const auto limit = [max_count](auto& samples) {
    while (samples.size() > max_count) samples.pop_front();
  };
  limit(odometry_);
  limit(angular_velocity_);
  limit(acceleration_);
}

void MotionPriorBuilder::discardBefore(Time time) {
  const auto discard = [&](auto& samples) {
    while (samples.size() > 2 && samples[1].time < time - params_.max_odometry_gap_s)
      samples.pop_front();
  };
  discard(odometry_);
  discard(angular_velocity_);
  discard(acceleration_);
}

std::optional<Eigen::Matrix3d> MotionPriorBuilder::rotationBetween(Time previous,
                                                                   Time current) const {
  auto omega = valueAt(angular_velocity_, previous, params_.max_inertial_gap_s);
  const auto omega_end = valueAt(angular_velocity_, current, params_.max_inertial_gap_s);
  if (!omega || !omega_end) return std::nullopt;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Time time = previous;
  const auto integrate = [&](Time to, const Eigen::Vector3d& omega_to) {
    rotation = rotation * expSo3(0.5 * (to - time) * (*omega + omega_to));  // trapezoid rule
    time = to;
    omega = omega_to;
  };
  for (auto sample = firstFrom(angular_velocity_, previous);
       sample != angular_velocity_.end() && sample->time < current; ++sample) {
    if (sample->time - time > params_.max_inertial_gap_s) return std::nullopt;
    integrate(sample->time, sample->value);
  }
  if (current - time > params_.max_inertial_gap_s) return std::nullopt;
  integrate(current, *omega_end);
  return rotation;
}

std::optional<Eigen::Vector3d> MotionPriorBuilder::velocityIncrement(Time previous,
                                                                     Time current) const {
  auto force = valueAt(acceleration_, previous, params_.max_inertial_gap_s);
  const auto force_end = valueAt(acceleration_, current, params_.max_inertial_gap_s);
  if (!force || !force_end) return std::nullopt;
  Eigen::Matrix3d R_previous_sample = Eigen::Matrix3d::Identity();
  Eigen::Vector3d increment = Eigen::Vector3d::Zero();
  Time time = previous;
  const auto integrate = [&](Time to, const Eigen::Vector3d& force_to) {
    const auto rotation = rotationBetween(time, to);
    if (!rotation || to - time > params_.max_inertial_gap_s) return false;
    const Eigen::Vector3d before = R_previous_sample * *force;
    R_previous_sample *= *rotation;
    increment += 0.5 * (to - time) * (before + R_previous_sample * force_to);  // trapezoid rule
    time = to;
    force = force_to;
    return true;
  };
  for (auto sample = firstFrom(acceleration_, previous);
       sample != acceleration_.end() && sample->time < current; ++sample) {
    if (!integrate(sample->time, sample->value)) return std::nullopt;
  }
  if (!integrate(current, *force_end)) return std::nullopt;
  return increment;
}

std::optional<Eigen::Vector3d> MotionPriorBuilder::specificForceAt(Time time) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  std::size_t count = 0;
  for (auto sample = firstFrom(acceleration_, time - params_.force_before_s);
       sample != acceleration_.end() && sample->time <= time + params_.force_after_s; ++sample) {
    sum += sample->value;
    ++count;
  }
  if (count < params_.min_force_samples) return std::nullopt;
  return Eigen::Vector3d(sum / static_cast<double>(count));
}

}  // namespace headway::io
