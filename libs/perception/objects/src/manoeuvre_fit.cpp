// SPDX-License-Identifier: BSD-3-Clause
#include "manoeuvre_fit.h"

#include <headway/core/statistics.h>

#include <algorithm>
#include <cmath>

#include "recent_motion.h"

namespace headway::objects {
namespace {

constexpr double kMinSpeed = 0.3;  // min. speed for a turn rate [m/s]

// Weighted moments of the first `seen` positions about the last of them, and of time.
struct Moments {
  double t1 = 0.0;                      // of v
  double t2 = 0.0, t3 = 0.0, t4 = 0.0;  // of v * v, v * a and a * a in the normal equations
  Eigen::Vector2d dt1 = Eigen::Vector2d::Zero();
  Eigen::Vector2d dt2 = Eigen::Vector2d::Zero();

  Moments(const std::vector<TrajectoryPoint>& path, std::size_t seen, double memory_s) {
    const TrajectoryPoint& now = path[seen - 1];
    const double rate = 1.0 / memory_s;
    for (std::size_t i = seen - 1; i-- > 0;) {
      const double t = path[i].time - now.time;
      const double freshness = 1.0 + t * rate;
      if (freshness <= 0.0 && i + 2 < seen) break;  // the last step is always used
      const double weight = std::max(freshness * freshness, kMinWeight);
      const double half_square = 0.5 * t * t;
      const Eigen::Vector2d offset = (path[i].position - now.position).head<2>();
      t1 += weight * t;
      t2 += weight * t * t;
      t3 += weight * t * half_square;
      t4 += weight * half_square * half_square;
      dt1 += weight * t * offset;
      dt2 += weight * half_square * offset;
    }
  }

 private:
  static constexpr double kMinWeight = 1e-3;
};

// The fit along one axis.
struct AxisFit {
  double velocity = 0.0;      // [m/s]
  double acceleration = 0.0;  // [m/s^2]
  double variance = 0.0;      // of the velocity, from the noise of the places before and the prior
  double gain = 0.0;          // by which an error of the newest place becomes one of velocity [1/s]

  // `noise` is the variance of a place; the prior is given by typical speed and acceleration.
  AxisFit(const Moments& m, double dt1, double dt2, double noise, double speed,
          double typical_acceleration_mps2) {
    const double a = m.t2 + noise / square(speed);
    const double c = m.t4 + noise / square(typical_acceleration_mps2);
    const double determinant = a * c - m.t3 * m.t3;
    velocity = (c * dt1 - m.t3 * dt2) / determinant;
    acceleration = (a * dt2 - m.t3 * dt1) / determinant;
    variance = noise * c / determinant;
    gain = (0.5 * m.t3 * m.t2 - c * m.t1) / determinant;
  }
};

}  // namespace

Manoeuvre fitManoeuvre(const MotionHistory& history, std::size_t seen,
                       const ManoeuvreParams& params) {
  Manoeuvre result;
  const Moments m(history.path, seen, params.memory_s);
  const Eigen::Vector2d ahead = unitOr(m.dt1, Eigen::Vector2d::UnitX());
  const Eigen::Vector2d left(-ahead.y(), ahead.x());
  const Eigen::Matrix2d& places = history.position_covariance;
  const double noise = square(params.path_noise_m) + 0.5 * places.trace();
  const auto fit = [&](const Eigen::Vector2d& axis, double typical_acceleration_mps2) {
    return AxisFit(m, m.dt1.dot(axis), m.dt2.dot(axis), noise, params.typical_speed_mps,
                   typical_acceleration_mps2);
  };
  const AxisFit along = fit(ahead, params.typical_acceleration_mps2);
  const AxisFit across = fit(left, params.typical_lateral_mps2);
  const Eigen::Vector2d velocity = along.velocity * ahead + across.velocity * left;
  const Eigen::Vector2d acceleration = along.acceleration * ahead + across.acceleration * left;

  Eigen::Matrix2d axes;
  axes << ahead, left;
  const Eigen::Matrix2d gain =
      axes * Eigen::Vector2d(along.gain, across.gain).asDiagonal() * axes.transpose();
  result.velocity_covariance =
      gain * places * gain +
      axes * Eigen::Vector2d(along.variance, across.variance).asDiagonal() * axes.transpose();

  const double speed = velocity.norm();
  result.direction = unitOr(velocity, ahead);
  const double fourth = square(square(speed));
  const double moves = fourth / (fourth + square(square(params.standing_speed_mps)));
  result.velocity_covariance +=
      (1.0 - moves) * square(params.setting_off_mps) * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d& d = result.direction;
  result.speed = moves * speed;
  result.acceleration = moves * acceleration.dot(d);
  if (speed > kMinSpeed) {
    result.turn_rate = moves * (d.x() * acceleration.y() - d.y() * acceleration.x()) / speed;
  }
  return result;
}

}  // namespace headway::objects
