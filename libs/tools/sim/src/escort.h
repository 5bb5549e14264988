// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/random.h>
#include <headway/core/stereo_camera.h>
#include <headway/sim/sim_params.h>

#include <vector>

#include "lane_keeper.h"
#include "vehicles.h"

namespace headway::sim {

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
