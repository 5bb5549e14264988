#include "traffic.h"

namespace headway::sim {
namespace {

std::vector<Obstacle> obstaclesFrom(const std::vector<Mover>& movers) {
  std::vector<Obstacle> obstacles;
  obstacles.reserve(movers.size());
  for (const Mover& mover : movers) obstacles.push_back(obstacleFrom(mover));
  return obstacles;
}

template <typename Item>
void append(const std::vector<Item>& more, std::vector<Item>& all) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

Traffic::Traffic(const SimParams& params, const Route& route, const RoadNetwork& network,
                 const StereoCamera& camera, const TrafficSeeds& seeds)
    : robot_(params.route, params.camera.ride_deg, params.traffic.image_share > 0.0, route,
             seeds.robot),
      escort_(params.traffic, route, camera, seeds.escort, robot_.state(), robot_.T_world_robot(),
              next_id_),
      vehicles_(escort_.others(), route, network, seeds.vehicles),
      pedestrians_(params.traffic, route, network, seeds.pedestrians) {
  vehicles_.populate(robot_.state(), next_id_);
  pedestrians_.populate(robot_.state(), next_id_);
  escort_.populate(robot_.state(), robot_.T_world_robot(), others());
}

void Traffic::advance(double dt) {
  const RobotState robot = robot_.state();
  const auto on_foot = obstaclesFrom(pedestrians_.movers());
  const auto on_wheels = obstaclesFrom(vehicles_.movers());
  auto for_robot = on_foot;
  append(on_wheels, for_robot);
  escort_.advance(dt, robot, for_robot);
  const auto escort = obstaclesFrom(escort_.movers());
  append(escort, for_robot);
  auto for_vehicles = on_foot;
  for_vehicles.push_back(robot.body);
  append(escort, for_vehicles);
  std::vector<Obstacle> for_pedestrians{robot.body};
  append(on_wheels, for_pedestrians);
  append(escort, for_pedestrians);
  pedestrians_.advance(dt, robot, for_pedestrians, next_id_);
  vehicles_.advance(dt, robot, for_vehicles, next_id_);
  robot_.advance(dt, for_robot);
}

std::vector<Mover> Traffic::others() const {
  std::vector<Mover> movers = vehicles_.movers();
  append(pedestrians_.movers(), movers);
  return movers;
}

std::vector<Mover> Traffic::movers() const {
  std::vector<Mover> movers = others();
  append(escort_.movers(), movers);
  return movers;
}

}  // namespace headway::sim
