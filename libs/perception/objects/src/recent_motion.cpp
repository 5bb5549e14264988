// SPDX-License-Identifier: BSD-3-Clause
// Motion over the ground from an object's past positions.
#include "recent_motion.h"

#include <Eigen/LU>
#include <algorithm>

namespace headway::objects {

Eigen::Vector2d placeAt(const std::vector<TrajectoryPoint>& path, Time time) {
  return positionAt(path, time).head<2>();
}

double spanOf(const std::vector<TrajectoryPoint>& path) {
  return path.size() < 2 ? 0.0 : path.back().time - path.front().time;
}

Eigen::Vector2d recentVelocity(const std::vector<TrajectoryPoint>& path, double window_s) {
  const double window = std::min(window_s, spanOf(path));
  if (window <= 0.0) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d now = path.back().position.head<2>();
  return (now - placeAt(path, path.back().time - window)) / window;
}

Eigen::Vector2d unitOr(const Eigen::Vector2d& direction, const Eigen::Vector2d& fallback) {
  const double length = direction.norm();
  return length > kNoDirection_m ? Eigen::Vector2d(direction / length) : fallback;
}

namespace {

/// Sums of the normal equations of a straight line; positions can be removed again.
struct LineFit {
  Eigen::Matrix2d weight = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d time = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d time_squared = Eigen::Matrix2d::Zero();
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  Eigen::Vector2d place_time = Eigen::Vector2d::Zero();

  void add(const PlaceMeasurement& measured, Time now, double sign = 1.0) {
    const double t = measured.time - now;
    const Eigen::Matrix2d information = sign * measured.information;
    const Eigen::Vector2d weighted = information * measured.measured.head<2>();
    weight += information;
    time += t * information;
    time_squared += t * t * information;
    place += weighted;
    place_time += t * weighted;
  }

  /// The line, as its motion and its place at the time of the last position.
  [[nodiscard]] std::pair<MeasuredMotion, Eigen::Vector2d> line() const {
    const Eigen::Matrix2d spread = weight.inverse();
    const Eigen::Matrix2d covariance = (time_squared - time * spread * time).inverse();
    const Eigen::Vector2d velocity = covariance * (place_time - time * spread * place);
    return {{velocity, covariance}, spread * (place - time * velocity)};
  }
};

}  // namespace

std::optional<MeasuredMotion> measuredMotion(const std::vector<PlaceMeasurement>& places,
                                             double window_s) {
  const auto first = std::find_if(places.begin(), places.end(), [&](const auto& place) {
    return places.back().time - place.time <= window_s;
  });
  if (places.end() - first < 3) return std::nullopt;
  const Time now = places.back().time;
  LineFit fit;
  for (auto place = first; place != places.end(); ++place) fit.add(*place, now);
  const auto [motion, at_now] = fit.line();
  auto worst = first;
  double largest = -1.0;  // squared error, in standard deviations
  for (auto place = first; place != places.end(); ++place) {
    const Eigen::Vector2d off =
        place->measured.head<2>() - at_now - (place->time - now) * motion.velocity;
    const double error = off.dot(place->information * off);
    if (!(error > largest)) continue;
    largest = error;
    worst = place;
  }
  fit.add(*worst, now, -1.0);
  return fit.line().first;
}

}  // namespace headway::objects
