// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/random.h>
#include <headway/sim/sim_params.h>

#include <vector>

#include "driving.h"
#include "site.h"

namespace headway::sim {

/// Forklifts, cyclists and delivery robots that go round the loops of a site, and brake for
/// everybody in their way.
class LoopVehicles {
 public:
  /// Vehicles spread over the loops, each far enough from the robot to brake for it.
  LoopVehicles(const TrafficParams& params, const Site& site, const Obstacle& robot,
               std::uint64_t seed, std::int64_t& next_id);

  void advance(double dt, const std::vector<Obstacle>& others);
  [[nodiscard]] const std::vector<Actor>& actors() const { return actors_; }

 private:
  void add(const VehicleLoop& loop, double ratio, const Obstacle& robot, std::int64_t& next_id);
  void place(std::size_t i, double dt);

  struct Vehicle {
    Path path;
    OnPath at;
    DriverStyle style;
  };
  Random random_;
  std::vector<Vehicle> vehicles_;  ///< same order as actors_
  std::vector<Actor> actors_;
};

}  // namespace headway::sim
