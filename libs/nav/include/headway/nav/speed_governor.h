#pragma once

#include <headway/core/track.h>
#include <headway/map/footprint_shape.h>
#include <headway/nav/predictive_obstacles_params.h>

#include <vector>

namespace headway::nav {

/// Motion of the robot on the ground, in its own frame.
struct GroundTwist {
  double forward = 0.0;   ///< [m/s]
  double sideways = 0.0;  ///< to the left [m/s]
  double turn = 0.0;      ///< counter-clockwise [rad/s]
};

/// The robot at one moment.
struct GroundState {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< map frame [m]
  double yaw = 0.0;                                 ///< [rad]
  GroundTwist twist;
};

/// How much of its planner's commanded speed the robot may drive among what moves.
///
/// A reactive planner knows where to pass, not when: it thinks that obstacles stand. The governor
/// looks along the commanded arc at several shares of its speed. For each it works out how
/// probable a contact with any of the tracks is, at its worst moment, and takes the share of least
/// expected cost
///
///     cost(share) = contact_cost * P(contact | share) + (1 - share)
///
/// so it slows to let somebody pass, and drives on where slowing would be worse. What lies farther
/// ahead counts less: there is time to decide again.
///
/// @see  path-velocity decomposition: Kant & Zucker, IJRR 1986
class SpeedGovernor {
 public:
  explicit SpeedGovernor(const PredictiveObstaclesParams& params);

  /// @param age_s  how long ago the tracks were like this [s]
  /// @return       share of the command, 0 to 1; of equal ones the greatest
  [[nodiscard]] double share(const GroundTwist& command, const GroundState& robot,
                             const std::vector<Track>& tracks, double age_s);

 private:
  /// Where a body may be, moment by moment, if it follows one of its paths.
  struct Future {
    TrackId track;
    double probability = 1.0;
    double radius = 0.0;                     ///< of the body [m]
    std::vector<Eigen::Vector2d> places;     ///< [m]
    std::vector<Eigen::Matrix2d> variances;  ///< [m^2]
  };

  void foresee(const std::vector<Track>& tracks, const GroundState& robot, double age_s);
  void drive(const GroundTwist& command, double share, const GroundState& from);
  [[nodiscard]] double contactProbability() const;
  [[nodiscard]] double contactProbability(const Future& future) const;

  PredictiveObstaclesParams params_;
  std::size_t steps_;
  std::vector<Future> futures_;  ///< by track; only the first future_count_ count
  std::size_t future_count_ = 0;
  std::vector<GroundState> driven_;  ///< moment by moment, at the share in hand
};

}  // namespace headway::nav
