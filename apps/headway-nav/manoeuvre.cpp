// SPDX-License-Identifier: BSD-3-Clause
// What a robot does where a reactive navigator finds no path: turns on the spot, steps out.
#include "manoeuvre.h"

#include <headway/core/pose.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace headway::app {
namespace {

using Eigen::Vector2d;
using mrpt::maps::CSimplePointsMap;
using mrpt::math::TPose2D;
using sim::DriveCommand;

// A forward arc of the navigator reaches a target at up to this bearing within its own length.
constexpr double kTurnFrom_rad = 1.0, kTurnTo_rad = 0.3;
constexpr double kTurn_radps = 0.8;  // slow enough to be followed by a camera at 15 Hz
// At rest: somebody who walks has passed; ways round who walks change sides.
constexpr double kPatience_s = 3.0, kSettled_s = 0.4;
constexpr double kMoved_m = 0.1, kMoved_rad = 0.2;
constexpr double kWayOut_s = 1.0, kWayOut_mps = 0.25;
constexpr double kTurnedBefore = 0.1;  // ratio of its worth where it has not helped

/// Space beside the robot [m].
struct Space {
  double enough = 0.2;  ///< more is worth nothing
  double behind = 0.1;  ///< it must gain where it does not look
  double near = 0.15;   ///< whoever is nearer while it turns passes first
  double touch = 0.03;  ///< half a cell of a grid
};
constexpr Space kSpace_m;
constexpr double kTick_s = 0.1;

}  // namespace

bool Manoeuvre::isDue(double time_s, const TPose2D& robot, const Vector2d& target) {
  time_s_ = time_s;
  bearing_ = wrapAngle(std::atan2(target.y() - robot.y, target.x() - robot.x) - robot.phi);
  if (std::hypot(robot.x - stood_.x, robot.y - stood_.y) > kMoved_m ||
      std::abs(wrapAngle(robot.phi - stood_.phi)) > kMoved_rad) {
    stood_ = robot;
    stood_since_s_ = time_s;
  }
  const bool turned = turns_, was_left = std::exchange(is_left_, bearing_ > 0.0);
  turns_ = std::abs(bearing_) > (turns_ ? kTurnTo_rad : kTurnFrom_rad);
  if (turned && is_left_ != was_left) changed_side_at_s_ = time_s;
  return turns_ || time_s < steps_out_until_s_ || time_s - stood_since_s_ > kPatience_s;
}

std::optional<DriveCommand> Manoeuvre::command(const CSimplePointsMap& obstacles,
                                               const IsAdmitted& is_admitted) {
  if (time_s_ < steps_out_until_s_) {
    if (roomAfter(obstacles, way_out_, 2.0 * kTick_s, kSpace_m.touch)) return way_out_;
    steps_out_until_s_ = time_s_;
  }
  if (time_s_ - stood_since_s_ > kPatience_s) {
    stood_since_s_ = time_s_;
    const Vector2d here(stood_.x, stood_.y);
    const bool leaves = left_from_ && (*left_from_ - here).norm() < kMoved_m;
    left_from_ = here;
    if (const auto way_out = wayOut(obstacles, leaves, is_admitted)) {
      way_out_ = *way_out;
      steps_out_until_s_ = time_s_ + kWayOut_s;
      return way_out;
    }
  }
  const DriveCommand turn{0.0, bearing_ < 0.0 ? -kTurn_radps : kTurn_radps};
  if (turns_ && time_s_ - changed_side_at_s_ >= kSettled_s &&
      roomAt(obstacles, {}) >= kSpace_m.near &&
      roomAfter(obstacles, turn, std::abs(bearing_) / kTurn_radps, kSpace_m.near) &&
      is_admitted(turn))
    return turn;
  return std::nullopt;
}

double Manoeuvre::roomAt(const CSimplePointsMap& obstacles, const TPose2D& place) const {
  const Eigen::Rotation2Dd turn(-place.phi);
  double room = kSpace_m.enough;
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    double x = 0.0, y = 0.0;
    obstacles.getPoint(i, x, y);
    const Vector2d local = turn * Vector2d(x - place.x, y - place.y);
    room = std::min(room, (local.cwiseAbs() - 0.5 * size_).cwiseMax(0.0).norm());
  }
  return room;
}

std::optional<double> Manoeuvre::roomAfter(const CSimplePointsMap& obstacles,
                                           const DriveCommand& motion, double duration_s,
                                           double needed) const {
  const double least = std::min(needed, roomAt(obstacles, {}));
  TPose2D place;
  double room = 0.0;
  for (double t = 0.0; t < duration_s; t += kTick_s) {
    place.phi += kTick_s * motion.turn_rate;
    place.x += kTick_s * motion.speed * std::cos(place.phi);
    place.y += kTick_s * motion.speed * std::sin(place.phi);
    room = roomAt(obstacles, place);
    if (room < least) return std::nullopt;
  }
  return room;
}

std::optional<DriveCommand> Manoeuvre::wayOut(const CSimplePointsMap& obstacles, bool leaves,
                                              const IsAdmitted& is_admitted) const {
  std::optional<DriveCommand> best;
  double best_score = 0.0;
  for (const double speed : {0.0, kWayOut_mps, -kWayOut_mps}) {
    for (const double turn_rate : {-kTurn_radps, 0.0, kTurn_radps}) {
      if (speed == 0.0 && turn_rate == 0.0) continue;
      const auto room = roomAfter(obstacles, {speed, turn_rate}, kWayOut_s, kSpace_m.touch);
      if (!room) continue;
      const double gain = *room - (speed < 0.0 ? kSpace_m.behind : 0.0);
      // Of equal room, what turns it to its target.
      double score =
          gain / kSpace_m.enough + 0.25 * (1.0 + std::cos(bearing_ - turn_rate * kWayOut_s));
      if (leaves && speed == 0.0) score *= kTurnedBefore;
      if (!(score > best_score) || !is_admitted({speed, turn_rate})) continue;
      best = DriveCommand{speed, turn_rate};
      best_score = score;
    }
  }
  return best;
}

}  // namespace headway::app
