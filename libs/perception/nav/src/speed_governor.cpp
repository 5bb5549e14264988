// SPDX-License-Identifier: BSD-3-Clause
// Speed of the robot among moving objects.
#include <headway/map/contact_probability.h>
#include <headway/nav/moving_obstacles.h>
#include <headway/nav/speed_governor.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace headway::nav {
namespace {

using Eigen::Vector2d;

constexpr double kStep_s = 0.1;
constexpr int kSpeedSteps = 10;        ///< steps of the speed ratio
constexpr double kTurnMemory_s = 1.0;  ///< decay time of the commanded turn rate
constexpr double kMinSigma_m = 0.05;
constexpr double kFarSigmas = 4.0;
constexpr double kStandstill_mps = 0.02;  ///< [m/s]
constexpr double kUnderRobot_m = 0.01;    ///< about its outline: where it stands
constexpr double kOutlineStep = 0.25;     ///< between points of a side, of half its length

bool isStanding(const GroundTwist& twist, double corner_m) {
  return std::abs(twist.forward) < kStandstill_mps && std::abs(twist.sideways) < kStandstill_mps &&
         std::abs(twist.turn) * corner_m < kStandstill_mps;
}

/// The probability that a standard normal value is above x.
double above(double x) { return 0.5 * std::erfc(x / std::sqrt(2.0)); }

}  // namespace

SpeedGovernor::SpeedGovernor(const PredictiveObstaclesParams& params)
    : params_(validated(params)),
      steps_(static_cast<std::size_t>(std::lround(params.governor.horizon_s / kStep_s))) {}

double SpeedGovernor::speedRatio(const GroundTwist& command, const GroundState& robot,
                                 const std::vector<Track>& tracks, double age_s,
                                 const GroundNow& ground) {
  predictFutures(tracks, robot, age_s);
  if (future_count_ == 0 && !ground) return 1.0;
  double best_ratio = 0.0;
  double min_cost = std::numeric_limits<double>::infinity();
  for (int i = kSpeedSteps; i >= 0; --i) {
    const double ratio = static_cast<double>(i) / kSpeedSteps;
    drive(command, ratio, robot);
    const double speed = ratio * std::hypot(command.forward, command.sideways);
    const double turn_rate = ratio * std::abs(command.turn);
    if (ground && !brakesOnFreeGround(speed, turn_rate, robot, age_s, ground)) continue;
    const double cost = params_.governor.contact_cost * contactProbability() + (1.0 - ratio);
    if (cost >= min_cost) continue;
    min_cost = cost;
    best_ratio = ratio;
  }
  return best_ratio;
}

bool SpeedGovernor::brakesOnFreeGround(double speed_mps, double turn_radps,
                                       const GroundState& robot, double age_s,
                                       const GroundNow& ground) const {
  const Vector2d half = 0.5 * Vector2d(params_.robot.length_m, params_.robot.width_m);
  const auto wayOf = [&](double speed) {
    return speed * (params_.governor.lag_s + age_s) +
           0.5 * speed * speed / params_.robot.deceleration_mps2;
  };
  const double way_m = wayOf(speed_mps), corner_way_m = wayOf(turn_radps * half.norm());
  const double turns_within_m = std::max(params_.robot.radius_m, half.norm() + kMinSigma_m);
  const Eigen::Rotation2Dd back(-robot.yaw);
  const auto isFree = [&](const Vector2d& place, double within_s) {
    const Vector2d offset = place - robot.place;
    const Vector2d outside = (back * offset).cwiseAbs() - half;
    if (outside.maxCoeff() < kUnderRobot_m) return true;
    const map::LocalState state = ground(place, within_s);
    if (state == map::LocalState::kFree || offset.norm() > turns_within_m) {
      return state == map::LocalState::kFree;
    }
    return state == map::LocalState::kNotInView ||
           (state == map::LocalState::kUnknown && speed_mps == 0.0);
  };
  const auto isOutlineFree = [&](const GroundState& at, double within_s) {
    const Eigen::Rotation2Dd turn(at.yaw);
    const auto isFreeAt = [&](double x, double y) {
      return isFree(at.place + turn * Vector2d(x, y), within_s);
    };
    for (double s = -1.0; s <= 1.0; s += kOutlineStep) {
      const bool is_free_here =
          isFreeAt(half.x(), s * half.y()) && isFreeAt(-half.x(), s * half.y()) &&
          isFreeAt(s * half.x(), half.y()) && isFreeAt(s * half.x(), -half.y());
      if (!is_free_here) return false;
    }
    return true;
  };
  double driven_m = 0.0, corner_m = 0.0;
  double time_s = age_s;
  const GroundState* last = &robot;
  for (const GroundState& at : driven_) {
    driven_m += (at.place - last->place).norm();
    corner_m += std::abs(at.yaw - last->yaw) * half.norm();
    last = &at;
    time_s += kStep_s;
    if (!isOutlineFree(at, time_s)) return false;
    if (driven_m >= way_m && corner_m >= corner_way_m) return true;
  }
  return true;
}

void SpeedGovernor::predictFutures(const std::vector<Track>& tracks, const GroundState& robot,
                                   double age_s) {
  future_count_ = 0;
  const double span_s = params_.governor.horizon_s;
  for (const auto& track : tracks) {
    if (!isMovingObstacle(track)) continue;
    const double radius = map::footprintOf(track).radius();
    const double reach = span_s * (params_.robot.max_speed_mps + track.velocity.norm()) +
                         params_.robot.radius_m + radius;
    if (!((track.position.head<2>() - robot.place).norm() < reach + 1.0)) continue;
    for (const auto& path : track.predictions) {
      if (futures_.size() == future_count_) futures_.emplace_back();
      Future& future = futures_[future_count_++];
      future.track = track.id;
      future.probability = path.probability;
      future.radius = radius;
      future.places.resize(steps_);
      future.variances.resize(steps_);
      for (std::size_t i = 0; i < steps_; ++i) {
        const auto sample =
            map::samplePath(track, path, age_s + (static_cast<double>(i) + 1) * kStep_s);
        future.places[i] = sample.centre;
        future.variances[i] = sample.covariance;
      }
    }
  }
}

void SpeedGovernor::drive(const GroundTwist& command, double ratio, const GroundState& from) {
  driven_.resize(steps_);
  rests_ = isStanding({ratio * command.forward, ratio * command.sideways, ratio * command.turn},
                      0.5 * std::hypot(params_.robot.length_m, params_.robot.width_m));
  GroundState state = from;
  const double keep = std::exp(-kStep_s / std::max(1e-3, params_.governor.lag_s));
  const double keep_turn = std::exp(-kStep_s / kTurnMemory_s);
  double turn = ratio * command.turn;
  const double gain = params_.robot.acceleration_mps2 * kStep_s;
  for (auto& moment : driven_) {
    const auto approach = [keep](double wanted, double most_gain, double& value) {
      const double before = value;
      value = wanted + keep * (value - wanted);
      if (std::abs(value) > std::abs(before)) {
        value = std::clamp(value, before - most_gain, before + most_gain);
      }
      return 0.5 * (before + value);
    };
    const double forward = approach(ratio * command.forward, gain, state.twist.forward);
    const double sideways = approach(ratio * command.sideways, gain, state.twist.sideways);
    const double turned = approach(turn, std::numeric_limits<double>::infinity(), state.twist.turn);
    const double middle_yaw = state.yaw + 0.5 * kStep_s * turned;
    state.yaw = 2.0 * middle_yaw - state.yaw;
    const double c = std::cos(middle_yaw), s = std::sin(middle_yaw);
    state.place += kStep_s * Vector2d(c * forward - s * sideways, s * forward + c * sideways);
    turn *= keep_turn;
    moment = state;
  }
}

double SpeedGovernor::contactProbability() const {
  map::ContactSum contacts;
  for (std::size_t i = 0; i < future_count_; ++i) {
    const Future& future = futures_[i];
    contacts.add(future.track, future.probability, contactProbability(future));
  }
  return contacts.total();
}

double SpeedGovernor::contactProbability(const Future& future) const {
  double worst = 0.0;
  const Vector2d half = 0.5 * Vector2d(params_.robot.length_m, params_.robot.width_m);
  for (std::size_t i = 0; i < steps_; ++i) {
    const GroundState& robot = driven_[i];
    const Vector2d offset = future.places[i] - robot.place;
    const double far = params_.robot.radius_m + future.radius;
    const double spread = kMinSigma_m * kMinSigma_m + future.variances[i].trace();
    const double beyond = offset.norm() - far;
    if (beyond > 0.0 && beyond * beyond > kFarSigmas * kFarSigmas * spread) continue;
    const double c = std::cos(robot.yaw), s = std::sin(robot.yaw);
    const Vector2d local(std::abs(c * offset.x() + s * offset.y()),
                         std::abs(c * offset.y() - s * offset.x()));
    const Vector2d outside = (local - half).cwiseMax(0.0);
    const double inside = std::min(0.0, (local - half).maxCoeff());
    const double gap = outside.norm() + inside - future.radius - params_.governor.margin_m;
    const Vector2d towards = offset.normalized();
    const double sigma = std::sqrt(kMinSigma_m * kMinSigma_m +
                                   std::max(0.0, towards.dot(future.variances[i] * towards)));
    const bool stands = rests_ && isStanding(robot.twist, half.norm());
    const double weight =
        (stands ? params_.governor.standing_ratio : 1.0) *
        std::exp(-static_cast<double>(i + 1) * kStep_s / params_.governor.patience_s);
    worst = std::max(worst, weight * above(gap / sigma));
  }
  return worst;
}

}  // namespace headway::nav
