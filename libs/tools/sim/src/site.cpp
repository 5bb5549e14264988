// SPDX-License-Identifier: BSD-3-Clause
#include "site.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace headway::sim {
namespace {

/// Height of a triangle at a place; nullopt beside it.
std::optional<double> heightIn(const std::array<Eigen::Vector3d, 3>& triangle,
                               const Eigen::Vector2d& at) {
  const Eigen::Vector2d a = triangle[0].head<2>();
  Eigen::Matrix2d edges;
  edges << triangle[1].head<2>() - a, triangle[2].head<2>() - a;
  const Eigen::Vector2d weights = edges.inverse() * (at - a);
  constexpr double kTolerance = 1e-9;
  if (!(weights.minCoeff() >= -kTolerance && weights.sum() <= 1.0 + kTolerance)) {
    return std::nullopt;
  }
  return triangle[0].z() + weights.x() * (triangle[1].z() - triangle[0].z()) +
         weights.y() * (triangle[2].z() - triangle[0].z());
}

}  // namespace

double groundHeight(const Site& site, const Eigen::Vector2d& at) {
  for (const auto& triangle : site.ground) {
    if (const auto height = heightIn(triangle, at)) return *height;
  }
  return 0.0;
}

double wheelHeight(const Site& site, const Eigen::Vector2d& at) {
  constexpr double kRamp = 0.06;  // of a wheel that climbs a step [m]
  double height = 0.0;
  for (const Threshold& threshold : site.thresholds) {
    const Footprint& strip = threshold.strip;
    const Eigen::Vector2d ex(std::cos(strip.yaw), std::sin(strip.yaw));
    const Eigen::Vector2d to = at - strip.centre;
    const double across = std::abs(ex.x() * to.y() - ex.y() * to.x());
    const double beyond = std::abs(to.dot(ex)) - 0.5 * strip.size.x();
    if (across > 0.5 * strip.size.y() || beyond > kRamp) continue;
    const double ratio = std::clamp(1.0 - beyond / kRamp, 0.0, 1.0);
    height = std::max(height, threshold.height_m * 0.5 * (1.0 - std::cos(M_PI * ratio)));
  }
  return groundHeight(site, at) + height;
}

}  // namespace headway::sim
