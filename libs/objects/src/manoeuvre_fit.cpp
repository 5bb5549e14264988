#include "manoeuvre_fit.h"

#include <algorithm>
#include <cmath>

#include "recent_motion.h"

namespace headway::objects {
namespace {

constexpr double kTypicalSpeed = 50.0;  // a prior so wide that it only tames tiny time steps [m/s]
constexpr double kLeastSpeed = 0.3;     // slower, a turn rate means nothing [m/s]

// Weighted moments of the path about its newest place, and of time.
struct Moments {
  double t2 = 0.0, t3 = 0.0, t4 = 0.0;  // of v * v, v * a and a * a in the normal equations
  Eigen::Vector2d dt1 = Eigen::Vector2d::Zero();
  Eigen::Vector2d dt2 = Eigen::Vector2d::Zero();

  Moments(const std::vector<TrajectoryPoint>& path, double memory_s) {
    const TrajectoryPoint& now = path.back();
    const double rate = 1.0 / memory_s;
    for (std::size_t i = path.size() - 1; i-- > 0;) {
      const double t = path[i].time - now.time;
      const double freshness = 1.0 + t * rate;
      if (freshness <= 0.0 && i + 2 < path.size()) break;  // the last step always counts
      const double weight = std::max(freshness * freshness, kLeastWeight);
      const double half_square = 0.5 * t * t;
      const Eigen::Vector2d offset = (path[i].position - now.position).head<2>();
      t2 += weight * t * t;
      t3 += weight * t * half_square;
      t4 += weight * half_square * half_square;
      dt1 += weight * t * offset;
      dt2 += weight * half_square * offset;
    }
  }

 private:
  static constexpr double kLeastWeight = 1e-3;
};

// Velocity and acceleration along one axis; `ridge` is what the prior adds to the acceleration.
Eigen::Vector2d solve(const Moments& m, double dt1, double dt2, double speed_ridge, double ridge) {
  const double a = m.t2 + speed_ridge;
  const double c = m.t4 + ridge;
  const double determinant = a * c - m.t3 * m.t3;
  return Eigen::Vector2d(c * dt1 - m.t3 * dt2, a * dt2 - m.t3 * dt1) / determinant;
}

double square(double x) { return x * x; }

}  // namespace

Manoeuvre fitManoeuvre(const MotionHistory& history, const ManoeuvreParams& params) {
  Manoeuvre result;
  if (history.path.size() < 2) return result;
  const Moments m(history.path, params.memory_s);
  const double noise = square(params.path_noise_m) + square(history.position_sigma_m);
  const double speed_ridge = noise / square(kTypicalSpeed);
  const double along_ridge = noise / square(params.typical_acceleration);
  const double across_ridge = noise / square(params.typical_turn);

  const Eigen::Vector2d ahead = unitOr(m.dt1 / (m.t2 + speed_ridge), Eigen::Vector2d::UnitX());
  const Eigen::Vector2d left(-ahead.y(), ahead.x());
  const auto along = solve(m, m.dt1.dot(ahead), m.dt2.dot(ahead), speed_ridge, along_ridge);
  const auto across = solve(m, m.dt1.dot(left), m.dt2.dot(left), speed_ridge, across_ridge);
  const Eigen::Vector2d velocity = along(0) * ahead + across(0) * left;
  const Eigen::Vector2d acceleration = along(1) * ahead + across(1) * left;

  const double speed = velocity.norm();
  result.direction = unitOr(velocity, ahead);
  const double fourth = square(square(speed));
  const double moves = fourth / (fourth + square(square(params.standing_speed)));
  const Eigen::Vector2d& d = result.direction;
  result.speed = moves * speed;
  result.acceleration = moves * acceleration.dot(d);
  if (speed > kLeastSpeed) {
    result.turn_rate = moves * (d.x() * acceleration.y() - d.y() * acceleration.x()) / speed;
  }
  return result;
}

}  // namespace headway::objects
