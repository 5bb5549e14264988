#include "world.h"

#include <algorithm>
#include <cmath>

namespace headway::sim {
namespace {

enum Purpose : std::uint64_t { kGrainSeed = 101, kCrossStreetSeed };

constexpr double kReach = 0.75 * kStretch;  // radius of a stretch with its houses, roughly [m]
constexpr double kKeepBeyond = 60.0;        // stretches this far out of view are forgotten [m]

}  // namespace

World::World(const WorldParams& params, const Route& route)
    : params_(params),
      grain_(seedOf({static_cast<std::uint64_t>(params.seed), kGrainSeed})),
      network_(route, params.cross_street_every_m,
               seedOf({static_cast<std::uint64_t>(params.seed), kCrossStreetSeed})),
      builder_(network_, params_, grain_) {
  for (std::size_t road = 0; road < network_.roads().size(); ++road) {
    const double length = network_.roads()[road].axis.length();
    for (int number = 0; number * kStretch < length - 1.0; ++number) {
      const StretchKey key{road, number};
      if (builder_.exists(key)) all_.emplace_back(builder_.middle(key), key);
    }
  }
}

std::vector<StretchKey> World::keysNear(const Eigen::Vector3d& place, double reach) const {
  std::vector<StretchKey> keys;
  for (const auto& [middle, key] : all_) {
    if ((middle - place).head<2>().squaredNorm() < reach * reach) keys.push_back(key);
  }
  return keys;
}

std::vector<StretchKey> World::inView(const Eigen::Vector3d& eye, const ViewCone& view) {
  std::vector<StretchKey> visible;
  for (const StretchKey& key : keysNear(eye, params_.view_distance_m)) {
    if (view.touches(builder_.middle(key).head<2>(), kReach)) visible.push_back(key);
  }
  std::sort(visible.begin(), visible.end(), [&](const StretchKey& a, const StretchKey& b) {
    const double to_a = (builder_.middle(a) - eye).norm(), to_b = (builder_.middle(b) - eye).norm();
    return to_a != to_b ? to_a < to_b : a < b;
  });
  for (const StretchKey& key : visible) {
    if (built_.count(key) == 0) built_.emplace(key, builder_.build(key));
  }
  const double forget = params_.view_distance_m + kKeepBeyond;
  for (auto it = built_.begin(); it != built_.end();) {
    const double distance = (it->second.anchor - eye).head<2>().norm();
    it = distance > forget ? built_.erase(it) : std::next(it);
  }
  return visible;
}

const StreetStretch& World::stretch(const StretchKey& key) const { return built_.at(key); }

std::vector<Mover> World::parkedNear(const Eigen::Vector3d& place, double reach) {
  std::vector<Mover> vehicles;
  for (const StretchKey& key : keysNear(place, reach + kStretch)) {
    auto known = parked_.find(key);
    if (known == parked_.end()) known = parked_.emplace(key, builder_.parked(key)).first;
    for (const Mover& vehicle : known->second) {
      if ((vehicle.position - place).head<2>().norm() < reach) vehicles.push_back(vehicle);
    }
  }
  return vehicles;
}

}  // namespace headway::sim
