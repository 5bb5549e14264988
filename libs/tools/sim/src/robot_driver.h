// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>
#include <headway/core/random.h>

#include "lane_keeper.h"
#include "suspension.h"
#include "vehicles.h"

namespace headway::sim {

/// Drives the robot along its route as a car among the others.
class RobotDriver {
 public:
  /// All references must outlive the object.
  ///
  /// @param close_up  keeps little distance, so that what drives ahead fills the view
  RobotDriver(const RouteParams& route_params, double ride_deg, bool close_up, const Route& route,
              std::uint64_t seed);

  void advance(double dt, const std::vector<Obstacle>& others);
  /// Takes away its speed.
  void halt() { at_.speed = 0.0; }
  [[nodiscard]] RobotState state() const;
  /// Robot frame (on the ground below the cameras) in the world.
  [[nodiscard]] Pose T_world_robot() const;
  /// Whether the route is at its end.
  [[nodiscard]] bool arrived() const { return at_.s >= route_.end_s - 0.5; }

 private:
  const Route& route_;
  DriverStyle style_;
  LaneKeeper at_;
  double ride_rad_;
  Random random_;
  Suspension pitch_, roll_;
};

}  // namespace headway::sim
