// SPDX-License-Identifier: BSD-3-Clause
// Speed of the robot among moving objects.
#pragma once

#include <headway/core/track.h>
#include <headway/map/contact_probability.h>
#include <headway/map/local_layer.h>
#include <headway/nav/moving_obstacles.h>

#include <functional>
#include <vector>

namespace headway::nav {

/// Motion of the robot on the ground, in its own frame.
struct GroundTwist {
  double forward = 0.0;   ///< [m/s]
  double sideways = 0.0;  ///< to the left [m/s]
  double turn = 0.0;      ///< counter-clockwise [rad/s]
};

/// State of the robot at one time.
struct GroundState {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< position, map frame [m]
  double yaw = 0.0;                                 ///< [rad]
  GroundTwist twist;
};

/// Scales the planner's commanded speed so that contacts with moving objects are avoided.
///
/// A reactive planner treats obstacles as static. The governor evaluates several ratios of the
/// commanded speed: for each it predicts the robot's path, computes the highest probability of a
/// contact with any of the tracks, and selects the ratio of minimum expected cost
///
///     cost(ratio) = contact_cost * P(contact | ratio) + (1 - ratio)
///
/// so that the robot slows down to give way, and continues where slowing down would be worse. The
/// cost of a contact decays with the time until it, since later steps can still avoid it. Where the
/// ground ahead is not known to be free, the robot drives no faster than it can brake before it.
///
/// @see  path-velocity decomposition: Kant & Zucker, IJRR 1986
class SpeedGovernor {
 public:
  /// @throws InputError if a parameter is out of range
  explicit SpeedGovernor(const PredictiveObstaclesParams& params);

  /// What is known now of the ground at a place of the map, kNotInView: never seen; kEntered, too,
  /// where somebody may be within a time [s].
  using GroundNow = std::function<map::LocalState(const Eigen::Vector2d&, double within_s)>;

  /// A ratio is admissible only if the robot can brake on ground that is free now, and that what
  /// left the view cannot have entered by then. Within its radius, which it may never have seen, it
  /// turns on the spot where nothing is blocked, and moves where nothing is blocked or may have
  /// been entered.
  ///
  /// @param age_s   age of the tracks and of what is known about the ground [s]
  /// @param ground  empty: all ground counts as free
  /// @return         ratio of the commanded speed, 0 to 1; the highest of equal cost
  [[nodiscard]] double speedRatio(const GroundTwist& command, const GroundState& robot,
                                  const std::vector<Track>& tracks, double age_s,
                                  const GroundNow& ground = {});

 private:
  /// Positions of an object over time along one of its predicted paths.
  struct Future {
    TrackId track;
    double probability = 1.0;
    double radius = 0.0;                     ///< of its footprint [m]
    std::vector<Eigen::Vector2d> places;     ///< [m]
    std::vector<Eigen::Matrix2d> variances;  ///< [m^2]
  };

  void predictFutures(const std::vector<Track>& tracks, const GroundState& robot, double age_s);
  /// Whether the robot, driven at a speed and a turn rate, brakes on free ground.
  [[nodiscard]] bool brakesOnFreeGround(double speed_mps, double turn_radps,
                                        const GroundState& robot, double age_s,
                                        const GroundNow& ground) const;
  void drive(const GroundTwist& command, double ratio, const GroundState& from);
  [[nodiscard]] double contactProbability() const;
  [[nodiscard]] double contactProbability(const Future& future) const;

  PredictiveObstaclesParams params_;
  std::size_t steps_;
  std::vector<Future> futures_;  ///< by track; buffer of which future_count_ are valid
  std::size_t future_count_ = 0;
  std::vector<GroundState> driven_;  ///< predicted states, one per time step
  bool rests_ = false;               ///< whether they are those of a robot commanded to rest
};

}  // namespace headway::nav
