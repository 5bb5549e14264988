// SPDX-License-Identifier: BSD-3-Clause
// Vehicles on the streets, and those that escort the robot.
#pragma once

#include <headway/core/random.h>
#include <headway/core/stereo_camera.h>
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

/// Vehicles that keep close to the robot, so that actors cover a given ratio of its images.
///
/// One drives ahead in the robot's lane, one passes on its left, two cyclists ride on its right;
/// which of them come, and of what kind, is drawn: as many as the ratio needs. From then on one
/// number governs them, how far they stay back, and it follows the ratio covered so far. They
/// surge and fall back a little, each at its own period, and brake for what is ahead of them.
class Escort {
 public:
  /// No vehicles are made if TrafficParams::image_share is zero.
  ///
  /// @param camera  in whose left image the ratio is meant
  /// The route must outlive the object.
  /// @throws InputError naming the key if they cannot cover as much as that
  Escort(const TrafficParams& params, const Route& route, const StereoCamera& camera,
         std::uint64_t seed, const RobotState& robot, const Pose& T_world_robot,
         std::int64_t& next_id);

  /// Takes places from which the first image has its ratio already.
  ///
  /// @param others  everybody else who moves
  void populate(const RobotState& robot, const Pose& T_world_robot,
                const std::vector<Actor>& others);
  /// @param others  who may be in the way
  void advance(double dt, const RobotState& robot, const std::vector<Obstacle>& others);
  /// Takes note of what one image shows, and comes closer or stays back.
  void observe(const Pose& T_world_robot, const std::vector<Actor>& others);

  [[nodiscard]] const std::vector<Actor>& actors() const { return actors_; }
  /// The other traffic, with the lanes left to the escort.
  [[nodiscard]] TrafficParams others() const;

 private:
  struct Member {
    LaneKeeper lane;
    double closest_m = 0.0;  ///< from the camera to its rear
    double rhythm_s = 8.0;
    double phase = 0.0;
  };

  void recruit(ActorKind kind, double left, double closest_m, std::int64_t& next_id);
  void dress(std::size_t i, ActorKind kind);
  void arrange(const RobotState& robot);
  [[nodiscard]] double slot(const Member& member) const;
  [[nodiscard]] double covered(const Pose& T_world_robot, const std::vector<Actor>& others) const;
  void place(std::size_t i, double dt);

  TrafficParams params_;
  const Route& route_;
  StereoCamera camera_;
  Random random_;
  std::vector<Member> members_;  ///< same order as actors_
  std::vector<Actor> actors_;
  double distance_ = 1.0;  ///< how far they stay back: 1 is as close as they come
  double time_s_ = 0.0;
  double images_ = 0.0;
  double covered_sum_ = 0.0;
};

}  // namespace headway::sim
