// SPDX-License-Identifier: BSD-3-Clause
#include "street_environment.h"

#include "street_scene.h"

namespace headway::sim {
namespace {

enum TrafficPurpose : std::uint64_t {
  kStreetVehicleSeed = 301,
  kStreetPedestrianSeed,
  kStreetRobotSeed,
  kStreetEscortSeed = 308
};

TrafficSeeds trafficSeeds(const SimParams& params) {
  const auto seed = [&](TrafficPurpose purpose) {
    return seedOf({static_cast<std::uint64_t>(params.world.seed), purpose});
  };
  return {seed(kStreetVehicleSeed), seed(kStreetPedestrianSeed), seed(kStreetRobotSeed),
          seed(kStreetEscortSeed)};
}

}  // namespace

StreetEnvironment::StreetEnvironment(const SimParams& params, const StereoCamera& camera)
    : route_(makeRoute(params.route, params.world.hill_height_m)),
      world_(params.world, route_),
      traffic_(params, route_, world_.network(), camera, trafficSeeds(params)) {}

std::vector<Actor> StreetEnvironment::actors(double reach) {
  std::vector<Actor> actors = traffic_.actors();
  const auto parked = world_.parkedNear(T_world_robot().translation(), reach);
  actors.insert(actors.end(), parked.begin(), parked.end());
  return actors;
}

std::vector<PlacedMesh> StreetEnvironment::staticMeshes(double reach) {
  const Eigen::Vector3d robot = T_world_robot().translation();
  ViewCone all_around;
  all_around.viewpoint = robot.head<2>();
  std::vector<PlacedMesh> meshes;
  for (const StretchKey& key : world_.inView(robot, all_around)) {
    const StreetStretch& stretch = world_.stretch(key);
    if ((stretch.anchor - robot).head<2>().norm() > reach + kStretch) continue;
    for (const Surface& surface : stretch.surfaces) {
      meshes.push_back({&surface.mesh, stretch.anchor});
    }
    for (const Mesh& item : stretch.furniture) meshes.push_back({&item, stretch.anchor});
  }
  return meshes;
}

std::unique_ptr<Scene> StreetEnvironment::makeScene(const StereoCamera& camera) {
  return std::make_unique<StreetScene>(camera, world_);
}

}  // namespace headway::sim
