// SPDX-License-Identifier: BSD-3-Clause
// All streets of a world and where they meet.
#include "road_network.h"

#include <headway/core/random.h>

#include <algorithm>
#include <cmath>

#include "route.h"

namespace headway::sim {
namespace {

constexpr double kSearchCell = 20.0;   // of the search grid [m]
constexpr double kCrossLength = 72.0;  // of a cross street, to each side [m]

Path crossAxis(const Path& street, double s) {
  std::vector<Eigen::Vector3d> points;
  for (double d = -kCrossLength; d <= kCrossLength; d += 2.0) points.push_back(street.beside(s, d));
  return Path(points);
}

/// Distance of two places along a path [m].
double apart(const Path& path, double a, double b) {
  const double distance = std::abs(a - b);
  return path.closed() ? std::min(distance, path.length() - distance) : distance;
}

}  // namespace

RoadNetwork::RoadNetwork(const Route& route, double cross_street_every_m, std::uint64_t seed) {
  layMain(route);
  if (cross_street_every_m > 0.0) layCrossStreets(route, cross_street_every_m, seed);
}

std::pair<int, int> RoadNetwork::cellOf(const Eigen::Vector2d& xy) const {
  return {static_cast<int>(std::floor(xy.x() / kSearchCell)),
          static_cast<int>(std::floor(xy.y() / kSearchCell))};
}

void RoadNetwork::addSamples(std::size_t road, double from, double to) {
  const Path& axis = roads_[road].axis;
  for (double s = from; s < to; s += 1.0) {
    const Eigen::Vector3d at = axis.at(s).position;
    cells_[cellOf(at.head<2>())].push_back({road, s, at.head<2>(), at.z()});
  }
}

void RoadNetwork::layMain(const Route& route) {
  const Path& axis = route.street;
  const auto count = static_cast<std::size_t>(std::ceil(axis.length()));
  roads_.push_back({axis, std::vector<bool>(count, true), true, 0.0, 0.0});
  std::size_t entered = 0;  // samples lag behind, so that a street is not its own revisit
  for (std::size_t i = 0; i < count; ++i) {
    const auto s = static_cast<double>(i);
    for (; static_cast<double>(entered) + kStreet.revisit_after < s; ++entered) {
      if (roads_[0].drawn[entered]) {
        addSamples(0, static_cast<double>(entered), static_cast<double>(entered) + 0.5);
      }
    }
    const PathPoint here = axis.at(s);
    const auto earlier = nearest(here.position.head<2>(), kStreet.same_street);
    // A closed street's end is not a revisit of its beginning.
    if (!earlier || apart(axis, earlier->s, s) <= kStreet.revisit_after) continue;
    const double turn = axis.at(earlier->s).yaw - here.yaw;
    roads_[0].drawn[i] = std::abs(std::sin(turn)) > 0.6;  // a crossing is drawn, a revisit is not
  }
  for (; entered < count; ++entered) {
    if (roads_[0].drawn[entered]) {
      addSamples(0, static_cast<double>(entered), static_cast<double>(entered) + 0.5);
    }
  }
}

void RoadNetwork::layCrossStreets(const Route& route, double every, std::uint64_t seed) {
  Random random(seed);
  const Path& street = route.street;
  const double last = street.closed() ? street.length() - 40.0 : route.end_s + 120.0;
  for (double s = street.closed() ? 40.0 : 30.0; s < last; s += every * random.uniform(0.8, 1.2)) {
    double bend = 0.0;
    for (double d = -14.0; d <= 14.0; d += 2.0)
      bend = std::max(bend, std::abs(street.curvature(s + d)));
    const Path axis = crossAxis(street, s);
    bool free = bend < 1.0 / 120.0 && roads_[0].drawn[static_cast<std::size_t>(s)];
    for (double t = 0.0; t < axis.length() && free; t += 4.0) {
      if (std::abs(t - kCrossLength) < 30.0) continue;  // around its own junction
      free = !nearest(axis.at(t).position.head<2>(), 28.0);
    }
    if (!free) {
      s -= every * 0.75;  // try again a little farther on
      continue;
    }
    const auto count = static_cast<std::size_t>(std::ceil(axis.length()));
    roads_.push_back({axis, std::vector<bool>(count, true), false, kCrossLength, s});
    addSamples(roads_.size() - 1, 0.0, axis.length());
  }
}

std::optional<RoadNetwork::Place> RoadNetwork::nearest(const Eigen::Vector2d& xy,
                                                       double reach) const {
  const Sample* best = nullptr;
  double best_distance = (reach + 1.0) * (reach + 1.0);
  for (const Sample* sample : samplesAround(xy, reach)) {
    const double distance = (sample->xy - xy).squaredNorm();
    if (distance < best_distance) {
      best_distance = distance;
      best = sample;
    }
  }
  if (best == nullptr) return std::nullopt;
  const Path& axis = roads_[best->road].axis;
  const PathPoint point = axis.at(best->s);
  const Eigen::Vector2d offset = xy - point.position.head<2>();
  const double c = std::cos(point.yaw), s = std::sin(point.yaw);
  const double along = c * offset.x() + s * offset.y();
  const double left = c * offset.y() - s * offset.x();
  if (std::hypot(std::max(0.0, std::abs(along) - 0.6), left) > reach) return std::nullopt;
  return Place{best->road, best->s + along, left, axis.at(best->s + along).position.z()};
}

bool RoadNetwork::nearOther(const Eigen::Vector2d& xy, double reach, std::size_t road, double s,
                            bool earlier_only) const {
  for (const Sample* sample : samplesAround(xy, reach)) {
    if ((sample->xy - xy).squaredNorm() > reach * reach) continue;
    if (sample->road != road) {
      if (!earlier_only || sample->road < road) return true;
    } else if (apart(roads_[road].axis, sample->s, s) > kStreet.revisit_after - 10.0) {
      if (!earlier_only || sample->s < s) return true;
    }
  }
  return false;
}

std::vector<const Road*> RoadNetwork::crossStreetsNear(double main_s, double reach) const {
  const Path& street = roads_[0].axis;
  const double length = street.length();
  std::vector<const Road*> near;
  const auto collect = [&](double from, double to) {
    auto road = std::lower_bound(roads_.begin() + 1, roads_.end(), from,
                                 [](const Road& r, double s) { return r.main_s < s; });
    for (; road != roads_.end() && road->main_s <= to; ++road) near.push_back(&*road);
  };
  if (!street.closed()) {
    collect(main_s - reach, main_s + reach);
  } else if (2.0 * reach >= length) {
    collect(0.0, length);
  } else {  // a window that runs over the end goes on at the beginning
    const double from = main_s - reach - std::floor((main_s - reach) / length) * length;
    collect(0.0, from + 2.0 * reach - length);
    collect(from, from + 2.0 * reach);
  }
  return near;
}

std::optional<double> RoadNetwork::lowestNear(const Eigen::Vector2d& xy, double reach) const {
  std::optional<double> lowest;
  for (const Sample* sample : samplesAround(xy, reach)) {
    if ((sample->xy - xy).squaredNorm() > reach * reach) continue;
    if (!lowest || sample->height < *lowest) lowest = sample->height;
  }
  return lowest;
}

std::vector<const RoadNetwork::Sample*> RoadNetwork::samplesAround(const Eigen::Vector2d& xy,
                                                                   double reach) const {
  const auto [cx, cy] = cellOf(xy);
  const int cells = static_cast<int>(std::ceil(reach / kSearchCell));
  std::vector<const Sample*> samples;
  for (int x = cx - cells; x <= cx + cells; ++x) {
    for (int y = cy - cells; y <= cy + cells; ++y) {
      const auto cell = cells_.find({x, y});
      if (cell == cells_.end()) continue;
      for (const Sample& sample : cell->second) samples.push_back(&sample);
    }
  }
  return samples;
}

}  // namespace headway::sim
