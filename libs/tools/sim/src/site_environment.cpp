// SPDX-License-Identifier: BSD-3-Clause
#include "site_environment.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "site_scene.h"
#include "street_environment.h"

namespace headway::sim {
namespace {

enum SitePurpose : std::uint64_t {
  kGrainSeed = 501,
  kLayoutSeed,
  kRobotSeed,
  kVehicleSeed,
  kPeopleSeed,
  kBicycleSeed,
  kStartSeed
};

/// Distance of a stop to the middle of the nearest drop [m].
double distanceToDrop(const Eigen::Vector2d& stop, const std::vector<Drop>& drops) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Drop& drop : drops) {
    Eigen::AlignedBox2d bounds;
    for (const Eigen::Vector2d& corner : drop.outline) bounds.extend(corner);
    nearest = std::min(nearest, (bounds.center() - stop).norm());
  }
  return nearest;
}

/// With half of the seeds the robot starts beside a drop, which it would otherwise seldom see.
Site withStart(Site site, std::uint64_t seed) {
  Random random(seed);
  if (random.chance(0.5)) return site;
  auto& stops = site.robot_stops;
  const auto nearest = std::min_element(
      stops.begin(), stops.end(), [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        return distanceToDrop(a, site.drops) < distanceToDrop(b, site.drops);
      });
  std::iter_swap(stops.begin(), nearest);
  return site;
}

Site makeSite(WorldParams::Kind kind, const Grain& grain, std::uint64_t seed) {
  switch (kind) {
    case WorldParams::Kind::kCampus:
      return makeCampus(grain, seed);
    case WorldParams::Kind::kWarehouse:
      return makeWarehouse(grain, seed);
    case WorldParams::Kind::kHall:
    case WorldParams::Kind::kStreet:
      break;
  }
  return makeHall(grain, seed);
}

}  // namespace

SiteEnvironment::SiteEnvironment(const SimParams& params)
    : seed_(static_cast<std::uint64_t>(params.world.seed)),
      grain_(seedOf({seed_, kGrainSeed})),
      site_(withStart(makeSite(params.world.kind, grain_, seedOf({seed_, kLayoutSeed})),
                      seedOf({seed_, kStartSeed}))),
      grid_(site_),
      robot_(params, site_, grid_, seedOf({seed_, kRobotSeed})),
      vehicles_(params.traffic, site_, robot_.obstacle(), seedOf({seed_, kVehicleSeed}), next_id_),
      walkers_(params.traffic, site_, grid_, seedOf({seed_, kPeopleSeed})) {
  walkers_.populate(robot_, next_id_);
  Random random(seedOf({seed_, kBicycleSeed}));
  for (const Spot& spot : site_.bicycles) {
    Actor bicycle;
    bicycle.id = next_id_++;
    bicycle.kind = ActorKind::kBicycle;
    bicycle.look = random.below(100000);
    bicycle.size = drawSize(bicycle.kind, random);
    bicycle.position = Eigen::Vector3d(spot.position.x(), spot.position.y(), 0.0);
    bicycle.yaw = spot.yaw;
    bicycle.parked = true;
    bicycles_.push_back(bicycle);
  }
}

void SiteEnvironment::advance(double dt) {
  const auto people = obstaclesFrom(walkers_.actors());
  const auto vehicles = obstaclesFrom(vehicles_.actors());
  auto around_robot = people;
  around_robot.insert(around_robot.end(), vehicles.begin(), vehicles.end());
  auto around_vehicles = people;
  around_vehicles.push_back(robot_.obstacle());
  walkers_.advance(dt, robot_, vehicles);
  vehicles_.advance(dt, around_vehicles);
  robot_.advance(dt, around_robot);
}

std::vector<Actor> SiteEnvironment::actors(double /*reach*/) {
  std::vector<Actor> actors = walkers_.actors();
  const auto& vehicles = vehicles_.actors();
  actors.insert(actors.end(), vehicles.begin(), vehicles.end());
  actors.insert(actors.end(), bicycles_.begin(), bicycles_.end());
  return actors;
}

std::vector<PlacedMesh> SiteEnvironment::staticMeshes(double /*reach*/) {
  std::vector<PlacedMesh> meshes;
  for (const auto& [material, mesh] : site_.surfaces) meshes.push_back({&mesh});
  for (const PicturedMesh& facade : site_.facades) meshes.push_back({&facade.mesh});
  meshes.push_back({&site_.furniture});
  return meshes;
}

std::unique_ptr<Scene> SiteEnvironment::makeScene(const StereoCamera& /*camera*/) {
  return std::make_unique<SiteScene>(site_, grain_, seed_);
}

std::unique_ptr<Environment> makeEnvironment(const SimParams& params, const StereoCamera& camera) {
  if (params.world.kind != WorldParams::Kind::kStreet) {
    return std::make_unique<SiteEnvironment>(params);
  }
  return std::make_unique<StreetEnvironment>(params, camera);
}

}  // namespace headway::sim
