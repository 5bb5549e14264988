// SPDX-License-Identifier: BSD-3-Clause
#include "moving_average.h"

#include <algorithm>
#include <cmath>

namespace headway::objects {
namespace {

Eigen::Vector3d carriedOn(const PlaceMeasurement& place, Time time,
                          const Eigen::Vector3d& velocity) {
  return place.measured + (time - place.time) * velocity;
}

}  // namespace

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

}  // namespace headway::objects
