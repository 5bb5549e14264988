// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/sim/sim_params.h>

#include <cstdint>
#include <vector>

#include "escort.h"
#include "pedestrians.h"
#include "robot_driver.h"
#include "vehicles.h"

namespace headway::sim {

struct TrafficSeeds {
  std::uint64_t vehicles = 0;
  std::uint64_t pedestrians = 0;
  std::uint64_t robot = 0;
  std::uint64_t escort = 0;
};

/// The robot and all who move around it: each sees those who may be in its way, and then all go on.
class Traffic {
 public:
  /// Route and network must outlive the object.
  ///
  /// @param camera  in whose left image the escort covers its ratio
  /// @throws InputError as Escort
  Traffic(const SimParams& params, const Route& route, const RoadNetwork& network,
          const StereoCamera& camera, const TrafficSeeds& seeds);

  void advance(double dt);
  /// The camera takes a frame: the escort sees how much of it actors cover.
  void observe() { escort_.observe(robot_.T_world_robot(), others()); }

  [[nodiscard]] const RobotDriver& robot() const { return robot_; }
  [[nodiscard]] const Vehicles& vehicles() const { return vehicles_; }
  [[nodiscard]] const Pedestrians& pedestrians() const { return pedestrians_; }
  /// All but the robot: vehicles, people, the escort.
  [[nodiscard]] std::vector<Actor> actors() const;

 private:
  [[nodiscard]] std::vector<Actor> others() const;  ///< but for the escort

  bool standing_;
  RobotDriver robot_;
  std::int64_t next_id_ = 0;
  Escort escort_;
  Vehicles vehicles_;
  Pedestrians pedestrians_;
};

}  // namespace headway::sim
