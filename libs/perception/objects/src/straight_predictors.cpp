// SPDX-License-Identifier: BSD-3-Clause
#include "straight_predictors.h"

#include <algorithm>
#include <cmath>

#include "bezier_predictor.h"
#include "path_spread.h"
#include "recent_motion.h"

namespace headway::objects {
namespace {

// Turn rate from the mean velocities over the last window and the one before it [rad/s].
double recentTurnRate(const std::vector<TrajectoryPoint>& path, double window_s) {
  constexpr double kStanding_mps = 0.3;  // below, directions are noise
  const double window = std::min(window_s, 0.5 * spanOf(path));
  if (window <= 0.0) return 0.0;
  const Time now = path.back().time;
  const Eigen::Vector2d p0 = path.back().position.head<2>();
  const Eigen::Vector2d p1 = placeAt(path, now - window);
  const Eigen::Vector2d p2 = placeAt(path, now - 2.0 * window);
  const Eigen::Vector2d recent = p0 - p1;
  const Eigen::Vector2d older = p1 - p2;
  if (std::min(recent.norm(), older.norm()) < kStanding_mps * window) return 0.0;
  const double cross = older.x() * recent.y() - older.y() * recent.x();
  return std::atan2(cross, older.dot(recent)) / window;
}

// Least-squares parabola of four positions one spacing apart, the last of them current.
class Parabola {
 public:
  Parabola(const std::vector<TrajectoryPoint>& path, double spacing_s) : spacing_s_(spacing_s) {
    const Time now = path.back().time;
    const Eigen::Vector2d p0 = path.back().position.head<2>();
    const Eigen::Vector2d p1 = placeAt(path, now - spacing_s);
    const Eigen::Vector2d p2 = placeAt(path, now - 2.0 * spacing_s);
    const Eigen::Vector2d p3 = placeAt(path, now - 3.0 * spacing_s);
    // Least squares in the spacings from the middle of the four: -3/2, -1/2, 1/2, 3/2.
    slope_ = (3.0 * (p0 - p3) + (p1 - p2)) / 10.0;
    bend_ = (p0 - p1 - p2 + p3) / 4.0;
  }
  /// Displacement from the current position at one time [m].
  [[nodiscard]] Eigen::Vector2d advance(double time_s) const {
    const double u = time_s / spacing_s_;
    return u * (slope_ + (u + 3.0) * bend_);
  }

 private:
  double spacing_s_;
  Eigen::Vector2d slope_, bend_;
};

}  // namespace

void ConstantVelocityPredictor::predictInto(const MotionHistory& history,
                                            std::vector<PredictedPath>& paths) const {
  const PathSpread spread =
      spreadOf(history, params_.manoeuvres.of(history.object_class), params_.velocity_window_s);
  if (history.path.size() < 2) return writeStanding(history, spread, paths);
  const Eigen::Vector2d velocity = recentVelocity(history.path, params_.velocity_window_s);
  const DirectedSpread directed(spread, unitOr(velocity, Eigen::Vector2d::UnitX()));
  const Eigen::Vector2d start = history.path.back().position.head<2>();
  for (PredictedPoint& point : singlePath(history, paths).points) {
    point.position.head<2>() = start + point.horizon_s * velocity;
    point.covariance = directed.covariance(point.horizon_s);
  }
}

void ConstantTurnPredictor::predictInto(const MotionHistory& history,
                                        std::vector<PredictedPath>& paths) const {
  const PathSpread spread =
      spreadOf(history, params_.manoeuvres.of(history.object_class), params_.velocity_window_s);
  if (history.path.size() < 2) return writeStanding(history, spread, paths);
  const double window = std::min(params_.velocity_window_s, spanOf(history.path));
  const double turn_rate = recentTurnRate(history.path, params_.velocity_window_s);
  // The mean velocity of a window has the object's heading at the middle of the window.
  const Eigen::Vector2d velocity = Eigen::Rotation2Dd(0.5 * window * turn_rate) *
                                   recentVelocity(history.path, params_.velocity_window_s);
  const DirectedSpread directed(spread, unitOr(velocity, Eigen::Vector2d::UnitX()));
  const Eigen::Vector2d sideways(-velocity.y(), velocity.x());
  const Eigen::Vector2d start = history.path.back().position.head<2>();
  constexpr double kStraight = 1e-6;  // below this turn rate the circle is a line [rad/s]
  for (PredictedPoint& point : singlePath(history, paths).points) {
    const double t = point.horizon_s;
    const double angle = turn_rate * t;
    const bool straight = std::abs(turn_rate) < kStraight;
    const double ahead = straight ? t : std::sin(angle) / turn_rate;
    const double lateral = straight ? 0.0 : (1.0 - std::cos(angle)) / turn_rate;
    point.position.head<2>() = start + ahead * velocity + lateral * sideways;
    point.covariance = directed.covariance(t);
  }
}

void PolynomialPredictor::predictInto(const MotionHistory& history,
                                      std::vector<PredictedPath>& paths) const {
  constexpr double kSpacing_s = 0.5;  // five frames at 10 Hz
  constexpr double kHorizon_s = kPredictionSamples * kPredictionStep_s;
  const PathSpread spread =
      spreadOf(history, params_.manoeuvres.of(history.object_class), params_.velocity_window_s);
  if (history.path.size() < 2) return writeStanding(history, spread, paths);
  const double end_distance =
      kHorizon_s * smoothedSpeed(history.path, params_.paper.speed_samples, params_.paper);
  const Parabola parabola(history.path, std::min(kSpacing_s, spanOf(history.path) / 3.0));
  const Eigen::Vector2d end = parabola.advance(kHorizon_s);
  const double scale = end.norm() > kNoDirection_m ? end_distance / end.norm() : 0.0;
  const DirectedSpread directed(spread, unitOr(end, Eigen::Vector2d::UnitX()));
  const Eigen::Vector2d start = history.path.back().position.head<2>();
  for (PredictedPoint& point : singlePath(history, paths).points) {
    point.position.head<2>() = start + scale * parabola.advance(point.horizon_s);
    point.covariance = directed.covariance(point.horizon_s);
  }
}

}  // namespace headway::objects
