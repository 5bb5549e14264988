// SPDX-License-Identifier: BSD-3-Clause
#include "traffic.h"

namespace headway::sim {
namespace {

template <typename Item>
void append(const std::vector<Item>& more, std::vector<Item>& all) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

Traffic::Traffic(const SimParams& params, const Route& route, const RoadNetwork& network,
                 const StereoCamera& camera, const TrafficSeeds& seeds)
    : standing_(params.robot.standing),
      robot_(params.route, params.camera.ride_deg, params.traffic.image_share > 0.0, route,
             seeds.robot),
      escort_(params.traffic, route, camera, seeds.escort, robot_.state(), robot_.T_world_robot(),
              next_id_),
      vehicles_(escort_.others(), route, network, seeds.vehicles),
      pedestrians_(params.traffic, route, network, seeds.pedestrians) {
  if (standing_) robot_.halt();
  vehicles_.populate(robot_.state(), next_id_);
  pedestrians_.populate(robot_.state(), next_id_);
  escort_.populate(robot_.state(), robot_.T_world_robot(), others());
}

void Traffic::advance(double dt) {
  const RobotState robot = robot_.state();
  const auto on_foot = obstaclesFrom(pedestrians_.actors());
  const auto on_wheels = obstaclesFrom(vehicles_.actors());
  auto for_robot = on_foot;
  append(on_wheels, for_robot);
  escort_.advance(dt, robot, for_robot);
  const auto escort = obstaclesFrom(escort_.actors());
  append(escort, for_robot);
  auto for_vehicles = on_foot;
  for_vehicles.push_back(robot.obstacle);
  append(escort, for_vehicles);
  std::vector<Obstacle> for_pedestrians{robot.obstacle};
  append(on_wheels, for_pedestrians);
  append(escort, for_pedestrians);
  pedestrians_.advance(dt, robot, for_pedestrians, next_id_);
  vehicles_.advance(dt, robot, for_vehicles, next_id_);
  if (!standing_) robot_.advance(dt, for_robot);
}

std::vector<Actor> Traffic::others() const {
  std::vector<Actor> actors = vehicles_.actors();
  append(pedestrians_.actors(), actors);
  return actors;
}

std::vector<Actor> Traffic::actors() const {
  std::vector<Actor> actors = others();
  append(escort_.actors(), actors);
  return actors;
}

}  // namespace headway::sim
