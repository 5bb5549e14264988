// SPDX-License-Identifier: BSD-3-Clause
#include "measured_motion.h"

#include <Eigen/LU>
#include <algorithm>

namespace headway::objects {
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

  [[nodiscard]] Eigen::Matrix2d covariance() const {
    return (time_squared - time * weight.inverse() * time).inverse();
  }
  [[nodiscard]] Eigen::Vector2d velocity() const {
    return covariance() * (place_time - time * weight.inverse() * place);
  }
  /// Squared error of a place, in its standard deviations.
  [[nodiscard]] double error(const PlaceMeasurement& measured, Time now) const {
    const Eigen::Vector2d v = velocity();
    const Eigen::Vector2d at_now = weight.inverse() * (place - time * v);
    const Eigen::Vector2d off = measured.measured.head<2>() - at_now - (measured.time - now) * v;
    return off.dot(measured.information * off);
  }
};

}  // namespace

std::optional<MeasuredMotion> measuredMotion(const std::vector<PlaceMeasurement>& places,
                                             double window_s) {
  constexpr std::size_t kFewest = 3;
  const auto first = std::find_if(places.begin(), places.end(), [&](const auto& place) {
    return places.back().time - place.time <= window_s;
  });
  if (places.end() - first < static_cast<std::ptrdiff_t>(kFewest)) return std::nullopt;
  const Time now = places.back().time;
  LineFit fit;
  for (auto place = first; place != places.end(); ++place) fit.add(*place, now);
  const auto worst = std::max_element(first, places.end(), [&](const auto& a, const auto& b) {
    return fit.error(a, now) < fit.error(b, now);
  });
  fit.add(*worst, now, -1.0);
  return MeasuredMotion{fit.velocity(), fit.covariance()};
}

}  // namespace headway::objects
