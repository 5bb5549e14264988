// SPDX-License-Identifier: BSD-3-Clause
// What a robot does where a reactive navigator finds no path: turns on the spot, steps out.
#pragma once

#include <headway/sim/driven_world.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/math/TPose2D.h>

#include <Eigen/Core>
#include <functional>
#include <optional>

namespace headway::app {

/// Slow motions of a robot that drives forwards, where its navigator's arcs lead nowhere.
///
/// It turns on the spot towards a target that is beside or behind it, not at once back. When it has
/// stood for 3 s it moves for a second to where it has more room: arcs begin in free space only;
/// if it stands there again, it leaves the place rather than turn once more.
/// The former keeps 15 cm from obstacles, so that whoever comes near passes, the latter 3 cm, or
/// what there is.
class Manoeuvre {
 public:
  /// @param size  length and width of the robot [m]
  explicit Manoeuvre(const Eigen::Vector2d& size) : size_(size) {}

  /// Whether command() is to be asked instead of the navigator.
  [[nodiscard]] bool isDue(double time_s, const mrpt::math::TPose2D& robot,
                           const Eigen::Vector2d& target);
  /// Whether a motion would be let pass, at some speed.
  using IsAdmitted = std::function<bool(const sim::DriveCommand&)>;

  /// What to do now; nullopt: there is no room for it, it would not be let pass, or it is done.
  ///
  /// @param obstacles  robot's frame [m]
  [[nodiscard]] std::optional<sim::DriveCommand> command(
      const mrpt::maps::CSimplePointsMap& obstacles, const IsAdmitted& is_admitted);

 private:
  [[nodiscard]] double roomAt(const mrpt::maps::CSimplePointsMap& obstacles,
                              const mrpt::math::TPose2D& place) const;
  /// Room after a motion; nullopt if there is less than needed, and less than now, during it.
  [[nodiscard]] std::optional<double> roomAfter(const mrpt::maps::CSimplePointsMap& obstacles,
                                                const sim::DriveCommand& motion, double duration_s,
                                                double needed) const;
  /// @param leaves  rather than to turn on the spot
  [[nodiscard]] std::optional<sim::DriveCommand> wayOut(
      const mrpt::maps::CSimplePointsMap& obstacles, bool leaves,
      const IsAdmitted& is_admitted) const;

  Eigen::Vector2d size_;
  double time_s_ = 0.0;
  double bearing_ = 0.0;  ///< of the target [rad]
  bool turns_ = false;    ///< towards it
  bool is_left_ = false;  ///< of the robot
  double changed_side_at_s_ = -1.0e9;
  mrpt::math::TPose2D stood_;  ///< where it stands or stood last
  double stood_since_s_ = 0.0;
  sim::DriveCommand way_out_;                 ///< until then
  std::optional<Eigen::Vector2d> left_from_;  ///< where the last one began
  double steps_out_until_s_ = -1.0;
};

}  // namespace headway::app
