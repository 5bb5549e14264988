// SPDX-License-Identifier: BSD-3-Clause
#include "range_scanner.h"

#include <cmath>
#include <limits>

namespace headway::app {
namespace {

using Eigen::Vector2d;

constexpr int kRays = 360;
constexpr double kHeight_m = 0.4;

/// Range at which a ray from the origin meets a disc; infinity if it does not.
double rangeToDisc(const Vector2d& ray, const Vector2d& centre, double radius) {
  const double along = ray.dot(centre);
  const double squared = radius * radius - (centre.squaredNorm() - along * along);
  if (squared < 0.0 || along < 0.0) return std::numeric_limits<double>::infinity();
  return std::max(0.0, along - std::sqrt(squared));
}

}  // namespace

RangeScanner::RangeScanner(const SensorParams& params, std::uint64_t seed)
    : params_(params), random_(seed) {}

void RangeScanner::scan(const sim::Crowd& crowd, const mrpt::math::TPose2D& robot,
                        mrpt::maps::CSimplePointsMap& out) {
  std::normal_distribution<double> noise(0.0, 1.0);
  const Vector2d here(robot.x, robot.y);
  out.clear();
  for (int i = 0; i < kRays; ++i) {
    const double angle = 2.0 * M_PI * i / kRays;
    const Vector2d ray(std::cos(robot.phi + angle), std::sin(robot.phi + angle));
    double range = std::numeric_limits<double>::infinity();
    for (const auto& person : crowd.people()) {
      range = std::min(range, rangeToDisc(ray, person.position - here, person.radius));
    }
    for (const auto& pillar : crowd.pillars()) {
      range = std::min(range, rangeToDisc(ray, pillar.position - here, pillar.radius));
    }
    const double measured = range + params_.scan_sigma_m * noise(random_);
    if (range > params_.scan_range_m) continue;
    out.insertPoint(static_cast<float>(measured * std::cos(angle)),
                    static_cast<float>(measured * std::sin(angle)), static_cast<float>(kHeight_m));
  }
}

}  // namespace headway::app
