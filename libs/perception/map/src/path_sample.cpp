// SPDX-License-Identifier: BSD-3-Clause
#include <headway/map/path_sample.h>

#include <algorithm>

namespace headway::map {
namespace {

struct Dated {
  double horizon_s;
  PathSample sample;
};

/// Number 0 is the track itself, number i the i-th point of the path.
Dated pointOf(const Track& track, const PredictedPath& path, std::size_t i) {
  if (i == 0) {
    return {0.0, {track.position.head<2>(), track.position_covariance.topLeftCorner<2, 2>()}};
  }
  const auto& point = path.points[i - 1];
  return {point.horizon_s, {point.position.head<2>(), point.covariance}};
}

}  // namespace

PathSample samplePath(const Track& track, const PredictedPath& path, double horizon_s) {
  const auto& points = path.points;
  if (points.empty() || !(horizon_s > 0.0)) return pointOf(track, path, 0).sample;
  const auto after =
      std::lower_bound(points.begin(), points.end(), horizon_s,
                       [](const PredictedPoint& p, double time) { return p.horizon_s < time; });
  const bool beyond = after == points.end();
  const auto next = static_cast<std::size_t>(after - points.begin()) + (beyond ? 0 : 1);
  const Dated b = pointOf(track, path, next), a = pointOf(track, path, next - 1);
  const double fraction = (horizon_s - a.horizon_s) / (b.horizon_s - a.horizon_s);
  PathSample sample{a.sample.centre + fraction * (b.sample.centre - a.sample.centre),
                    a.sample.covariance + fraction * (b.sample.covariance - a.sample.covariance)};
  if (beyond) {
    const double growth = horizon_s / b.horizon_s;
    sample.covariance = growth * growth * b.sample.covariance;
  }
  return sample;
}

}  // namespace headway::map
