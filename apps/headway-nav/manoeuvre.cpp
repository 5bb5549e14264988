// SPDX-License-Identifier: BSD-3-Clause
// What a robot does where a reactive navigator finds no path: turns on the spot, steps out.
#include "manoeuvre.h"

#include <headway/core/pose.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace headway::app {
namespace {

using Eigen::Vector2d;
using mrpt::maps::CSimplePointsMap;
using mrpt::math::TPose2D;
using sim::DriveCommand;

// A forward arc of the navigator reaches a target at up to this bearing within its own length.
constexpr double kTurnFrom_rad = 1.0, kTurnTo_rad = 0.3;
constexpr double kTurn_radps = 0.8;  // slow enough to be followed by a camera at 15 Hz
constexpr double kPatience_s = 3.0;  // at rest: somebody who walks has passed
constexpr double kMoved_m = 0.1, kMoved_rad = 0.2;
constexpr double kWayOut_s = 1.0, kWayOut_mps = 0.25;
constexpr double kEnough_m = 0.2;  // more room is worth nothing
constexpr double kBehind_m = 0.1;  // of room that it must gain where it does not look
constexpr double kNear_m = 0.15;   // whoever is nearer while it turns passes first
constexpr double kTouch_m = 0.03;  // half a cell of a grid
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
  turns_ = std::abs(bearing_) > (turns_ ? kTurnTo_rad : kTurnFrom_rad);
  return turns_ || time_s < steps_out_until_s_ || time_s - stood_since_s_ > kPatience_s;
}

std::optional<DriveCommand> Manoeuvre::command(const CSimplePointsMap& obstacles,
                                               const IsAdmitted& is_admitted) {
  if (time_s_ < steps_out_until_s_) {
    if (roomAfter(obstacles, way_out_, 2.0 * kTick_s, kTouch_m)) return way_out_;
    steps_out_until_s_ = time_s_;
  }
  if (time_s_ - stood_since_s_ > kPatience_s) {
    stood_since_s_ = time_s_;
    if (const auto way_out = wayOut(obstacles, is_admitted)) {
      way_out_ = *way_out;
      steps_out_until_s_ = time_s_ + kWayOut_s;
      return way_out;
    }
  }
  const DriveCommand turn{0.0, bearing_ < 0.0 ? -kTurn_radps : kTurn_radps};
  if (turns_ && roomAt(obstacles, {}) >= kNear_m &&
      roomAfter(obstacles, turn, std::abs(bearing_) / kTurn_radps, kNear_m) && is_admitted(turn))
    return turn;
  return std::nullopt;
}

double Manoeuvre::roomAt(const CSimplePointsMap& obstacles, const TPose2D& place) const {
  const Eigen::Rotation2Dd turn(-place.phi);
  double room = kEnough_m;
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

std::optional<DriveCommand> Manoeuvre::wayOut(const CSimplePointsMap& obstacles,
                                              const IsAdmitted& is_admitted) const {
  std::optional<DriveCommand> best;
  double best_score = 0.0;
  for (const double speed : {0.0, kWayOut_mps, -kWayOut_mps}) {
    for (const double turn_rate : {-kTurn_radps, 0.0, kTurn_radps}) {
      if (speed == 0.0 && turn_rate == 0.0) continue;
      const auto room = roomAfter(obstacles, {speed, turn_rate}, kWayOut_s, kTouch_m);
      if (!room) continue;
      const double gain = *room - (speed < 0.0 ? kBehind_m : 0.0);
      // Of equal room, what turns it to its target.
      const double score =
          gain / kEnough_m + 0.25 * (1.0 + std::cos(bearing_ - turn_rate * kWayOut_s));
      if (!(score > best_score) || !is_admitted({speed, turn_rate})) continue;
      best = DriveCommand{speed, turn_rate};
      best_score = score;
    }
  }
  return best;
}

}  // namespace headway::app
