// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/random.h>
#include <headway/sim/sim_params.h>

#include <memory>
#include <optional>
#include <vector>

#include "driving.h"
#include "road_network.h"

namespace headway::sim {

/// Where the robot is, for those around it.
struct RobotState {
  double s = 0.0;      ///< along the route's street [m]
  double speed = 0.0;  ///< [m/s]
  Obstacle obstacle;   ///< as the other vehicles and people avoid it
};

/// Cars, vans, trucks, buses and cyclists near the robot: they keep to lanes, follow each other,
/// brake for people, slow down in curves, turn off, wait at junctions and cross.
///
/// Vehicles appear and vanish at the ends of the range, so their number stays as asked for.
class Vehicles {
 public:
  /// All references must outlive the object.
  Vehicles(const TrafficParams& params, const Route& route, const RoadNetwork& network,
           std::uint64_t seed);

  /// Fills the range around the robot.
  void populate(const RobotState& robot, std::int64_t& next_id);
  /// @param others  obstacles that follow no lane: people, the robot
  void advance(double dt, const RobotState& robot, const std::vector<Obstacle>& others,
               std::int64_t& next_id);
  [[nodiscard]] const std::vector<Actor>& actors() const { return actors_; }

 private:
  enum class Intent { kAlong, kOncoming, kCross };
  enum class Yields { kToAll, kToAlong, kToOncoming };  ///< of the street's traffic
  struct Vehicle {
    Intent intent = Intent::kAlong;
    std::shared_ptr<const Path> path;
    OnPath place;
    DriverStyle style;
    double street_s = 0.0;        ///< along the route's street, followed up from step to step [m]
    double yield_s = -1.0;        ///< on its path: where it waits for a gap; negative: nowhere
    double yield_street_s = 0.0;  ///< the junction, along the street
    Yields yields_to = Yields::kToAll;
    double standing_s = 0.0;  ///< time without moving [s]
  };

  void spawn(ActorKind kind, const RobotState& robot, bool anywhere, std::int64_t& next_id);
  [[nodiscard]] std::optional<Vehicle> along(ActorKind kind, double street_s, bool oncoming);
  [[nodiscard]] std::optional<Vehicle> crossing(const RobotState& robot, bool anywhere);
  void turnOff(Vehicle& vehicle, bool oncoming);
  [[nodiscard]] bool isFree(const Vehicle& vehicle, const RobotState& robot) const;
  /// Whether no vehicle approaches that has the right of way.
  [[nodiscard]] bool gapFor(const Vehicle& vehicle, const RobotState& robot) const;
  void place(std::size_t i, double dt);
  void retire(const RobotState& robot);
  [[nodiscard]] ActorKind drawKind();

  TrafficParams params_;
  const Route& route_;
  const RoadNetwork& network_;
  Random random_;
  std::vector<Vehicle> vehicles_;  ///< same order as actors_
  std::vector<Actor> actors_;
};

}  // namespace headway::sim
