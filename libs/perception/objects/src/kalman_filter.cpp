// SPDX-License-Identifier: BSD-3-Clause
// The filter of a track's state (Sec. III-C2).
#include "kalman_filter.h"

#include <headway/core/pose.h>
#include <headway/core/statistics.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace headway::objects {
namespace {

constexpr double kVerticalRatio = 0.2;     // of vertical to horizontal accelerations
constexpr double kTurnAcceleration = 0.5;  // typical [rad/s^2]
constexpr double kInitialTurnRate = 0.3;   // typical [rad/s]

KalmanFilter::Chain startingAt(double value, double variance, double rate_sigma,
                               double acceleration_sigma_mps2) {
  KalmanFilter::Chain chain;
  chain.mean(0) = value;
  chain.covariance.diagonal() << variance, square(rate_sigma), square(acceleration_sigma_mps2);
  return chain;
}

}  // namespace

Transition::Transition(double dt_s, double time_s) {
  // Response to a unit impulse of the acceleration after u seconds.
  const auto response = [&](double u) {
    const double x = u / time_s;
    const double fade = std::exp(-x);
    // The closed form of the first entry cancels for short steps.
    const double value = x < 1e-3 ? u * u * (0.5 - x / 6.0) : square(time_s) * (x - 1.0 + fade);
    return Eigen::Vector3d(value, -time_s * std::expm1(-x), fade);
  };
  F(0, 1) = dt_s;
  F.col(2) = response(dt_s);
  // Q = 2 / time * integral of response * response^T; 3-point Gauss in pieces of one time constant.
  constexpr std::array<double, 3> kGaussNodes = {0.112701665379258, 0.5, 0.887298334620742};
  constexpr std::array<double, 3> kGaussWeights = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  constexpr double kMaxPieces = 64.0;
  const double pieces = std::clamp(std::ceil(dt_s / time_s), 1.0, kMaxPieces);
  const double piece = dt_s / pieces;
  for (int i = 0; i < static_cast<int>(pieces); ++i) {
    for (std::size_t n = 0; n < kGaussNodes.size(); ++n) {
      const Eigen::Vector3d r = response((i + kGaussNodes[n]) * piece);
      Q += 2.0 / time_s * piece * kGaussWeights[n] * r * r.transpose();
    }
  }
}

void KalmanFilter::Chain::predict(const Transition& transition, double sigma) {
  mean = transition.F * mean;
  covariance = transition.F * covariance * transition.F.transpose() + square(sigma) * transition.Q;
}

void KalmanFilter::Chain::update(double measured, double variance) {
  const Eigen::Vector3d gain = covariance.col(0) / (covariance(0, 0) + variance);
  mean += gain * (measured - mean(0));
  covariance -= gain * covariance.row(0).eval();
}

KalmanFilter::KalmanFilter(const MeasuredBox& first, const FilterParams& params)
    : params_(params), acceleration_sigma_(params.acceleration_sigma_mps2.of(first.object_class)) {
  const double speed = params.initial_speed_sigma_mps.of(first.object_class);
  const Eigen::Vector3d& p = first.position;
  x_ = startingAt(p.x(), first.covariance(0, 0), speed, acceleration_sigma_);
  y_ = startingAt(p.y(), first.covariance(1, 1), speed, acceleration_sigma_);
  cross_xy_(0, 0) = first.covariance(0, 1);
  if (first.velocity) updateVelocity(*first.velocity);
  z_ = startingAt(p.z(), first.vertical_variance, kVerticalRatio * speed,
                  kVerticalRatio * acceleration_sigma_);
  yaw_ = startingAt(first.yaw, square(first.yaw_sigma_rad), kInitialTurnRate, kTurnAcceleration);
  const double size_variance = square(first.size_sigma_m);
  length_ = startingAt(first.size.x(), size_variance, 0.0, 0.0);
  width_ = startingAt(first.size.y(), size_variance, 0.0, 0.0);
  height_ = first.size.z();
  height_weight_ = 1.0 / size_variance;
}

void KalmanFilter::predict(const Transition& transition, bool standing) {
  const double sigma = (standing ? params_.standing_acceleration_ratio : 1.0) * acceleration_sigma_;
  x_.predict(transition, sigma);
  y_.predict(transition, sigma);
  cross_xy_ = transition.F * cross_xy_ * transition.F.transpose();
  z_.predict(transition, kVerticalRatio * sigma);
  yaw_.predict(transition, kTurnAcceleration);
  yaw_.mean(0) = wrapAngle(yaw_.mean(0));
}

// The 6-state block: joint measurement of x and y (or their rates) with their covariance.
void KalmanFilter::updatePlanar(const Eigen::RowVector3d& row, const Eigen::Vector2d& measured,
                                const Eigen::Matrix2d& covariance) {
  const Eigen::Matrix2d weight = (planar(row) + covariance).inverse();
  const Eigen::Vector2d innovation = measured - Eigen::Vector2d(row.dot(x_.mean), row.dot(y_.mean));
  Eigen::Matrix<double, 3, 2> column_x;  // covariance of x's chain with the measurement
  Eigen::Matrix<double, 3, 2> column_y;
  column_x << x_.covariance * row.transpose(), cross_xy_ * row.transpose();
  column_y << (row * cross_xy_).transpose(), y_.covariance * row.transpose();
  const Eigen::Matrix<double, 3, 2> gain_x = column_x * weight;
  const Eigen::Matrix<double, 3, 2> gain_y = column_y * weight;
  x_.mean += gain_x * innovation;
  y_.mean += gain_y * innovation;
  x_.covariance -= gain_x * column_x.transpose();
  y_.covariance -= gain_y * column_y.transpose();
  cross_xy_ -= gain_x * column_y.transpose();
}

void KalmanFilter::updatePlace(const MeasuredBox& measured) {
  updatePlanar(kPlace, measured.position.head<2>(), measured.covariance);
  z_.update(measured.position.z(), measured.vertical_variance);
}

// A mean over some time is the velocity in the middle of it, before it accelerated since.
void KalmanFilter::updateVelocity(const GroundVelocity& measured) {
  updatePlanar({0.0, 1.0, -measured.age_s}, measured.value, measured.covariance);
}

// Sizes are constant: their chains have no rate. Views that are not better than those before do not
// change a converged size, because an object that is more and more hidden seems smaller.
void KalmanFilter::updateSize(const MeasuredBox& measured) {
  const double variance = square(measured.size_sigma_m);
  if (length_.covariance(0, 0) < square(params_.size_converged_ratio) * variance) return;
  length_.update(measured.size.x(), variance);
  width_.update(measured.size.y(), variance);
  height_weight_ += 1.0 / variance;
  height_ += (measured.size.z() - height_) / (variance * height_weight_);
}

void KalmanFilter::updateYaw(double measured, double sigma_rad) {
  const double nearest = yaw_.mean(0) + wrapAngle(measured - yaw_.mean(0));
  yaw_.update(nearest, square(sigma_rad));
  yaw_.mean(0) = wrapAngle(yaw_.mean(0));
}

void KalmanFilter::averageYaw(double measured, double count) {
  const double value = yaw_.mean(0) + wrapAngle(measured - yaw_.mean(0)) / count;
  yaw_ = startingAt(wrapAngle(value), square(params_.yaw_sigma_rad) / count, 0.0, 0.0);
}

void KalmanFilter::turnRound() { yaw_.mean(0) = wrapAngle(yaw_.mean(0) + M_PI); }

Eigen::Matrix2d KalmanFilter::planar(const Eigen::RowVector3d& row) const {
  const auto variance = [&row](const Eigen::Matrix3d& matrix) {
    return Eigen::RowVector3d(row * matrix).dot(row);
  };
  Eigen::Matrix2d covariance;
  covariance << variance(x_.covariance), variance(cross_xy_), variance(cross_xy_),
      variance(y_.covariance);
  return covariance;
}

}  // namespace headway::objects
