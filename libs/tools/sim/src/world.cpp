// SPDX-License-Identifier: BSD-3-Clause
#include "world.h"

#include <algorithm>
#include <cmath>

namespace headway::sim {
namespace {

enum WorldPurpose : std::uint64_t { kWorldGrainSeed = 101, kCrossStreetSeed };

constexpr double kReach = 0.75 * kStretch;  // radius of a stretch with its houses, roughly [m]
constexpr double kKeepBeyond = 60.0;        // stretches this far out of view are removed [m]
constexpr double kLookupCell = 64.0;        // of the lookup [m]

}  // namespace

World::World(const WorldParams& params, const Route& route)
    : params_(params),
      grain_(seedOf({static_cast<std::uint64_t>(params.seed), kWorldGrainSeed})),
      network_(route, params.cross_street_every_m,
               seedOf({static_cast<std::uint64_t>(params.seed), kCrossStreetSeed})),
      builder_(network_, params_, grain_) {
  for (std::size_t road = 0; road < network_.roads().size(); ++road) {
    const double length = network_.roads()[road].axis.length();
    for (int number = 0; number * kStretch < length - 1.0; ++number) {
      const StretchKey key{road, number};
      if (!builder_.exists(key)) continue;
      const Eigen::Vector3d middle = builder_.middle(key);
      spots_[cellOf(middle.head<2>())].push_back({middle, key});
    }
  }
}

World::Cell World::cellOf(const Eigen::Vector2d& xy) {
  return {static_cast<int>(std::floor(xy.x() / kLookupCell)),
          static_cast<int>(std::floor(xy.y() / kLookupCell))};
}

std::vector<World::Spot> World::spotsNear(const Eigen::Vector3d& place, double reach) const {
  std::vector<Spot> near;
  const Eigen::Vector2d corner = Eigen::Vector2d::Constant(reach);
  const Cell first = cellOf(place.head<2>() - corner), last = cellOf(place.head<2>() + corner);
  for (int x = first.first; x <= last.first; ++x) {
    for (int y = first.second; y <= last.second; ++y) {
      const auto cell = spots_.find({x, y});
      if (cell == spots_.end()) continue;
      for (const Spot& spot : cell->second) {
        if ((spot.middle - place).head<2>().squaredNorm() < reach * reach) near.push_back(spot);
      }
    }
  }
  std::sort(near.begin(), near.end(), [](const Spot& a, const Spot& b) { return a.key < b.key; });
  return near;
}

std::vector<StretchKey> World::inView(const Eigen::Vector3d& viewpoint, const ViewCone& view) {
  std::vector<std::pair<double, StretchKey>> by_distance;
  for (const Spot& spot : spotsNear(viewpoint, params_.view_distance_m)) {
    if (!view.touches(spot.middle.head<2>(), kReach)) continue;
    by_distance.emplace_back((spot.middle - viewpoint).norm(), spot.key);
  }
  std::sort(by_distance.begin(), by_distance.end());
  std::vector<StretchKey> visible;
  for (const auto& [distance, key] : by_distance) {
    visible.push_back(key);
    if (built_.count(key) == 0) built_.emplace(key, builder_.build(key));
  }
  const double keep_within = params_.view_distance_m + kKeepBeyond;
  for (auto it = built_.begin(); it != built_.end();) {
    const double distance = (it->second.anchor - viewpoint).head<2>().norm();
    it = distance > keep_within ? built_.erase(it) : std::next(it);
  }
  return visible;
}

const StreetStretch& World::stretch(const StretchKey& key) const { return built_.at(key); }

std::vector<Actor> World::parkedNear(const Eigen::Vector3d& place, double reach) {
  std::vector<Actor> vehicles;
  std::map<StretchKey, std::vector<Actor>> near;
  for (const Spot& spot : spotsNear(place, reach + kStretch)) {
    auto known = parked_.extract(spot.key);
    if (known.empty()) {
      near.emplace(spot.key, builder_.parked(spot.key));
    } else {
      near.insert(std::move(known));
    }
    for (const Actor& vehicle : near.at(spot.key)) {
      if ((vehicle.position - place).head<2>().norm() < reach) vehicles.push_back(vehicle);
    }
  }
  parked_ = std::move(near);  // what is out of reach is removed
  return vehicles;
}

}  // namespace headway::sim
