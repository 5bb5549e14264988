// SPDX-License-Identifier: BSD-3-Clause
#include "satellite_receiver.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace headway::sim {
namespace {

constexpr double kHeightOverHorizontal = 1.7;  // standard deviation of heights
constexpr int kSatellites = 9;

}  // namespace

SatelliteReceiver::SatelliteReceiver(const GnssParams& params, std::uint64_t seed)
    : params_(params),
      random_(seed),
      frame_({params.latitude_deg, params.longitude_deg, params.altitude_m}) {
  const double yaw = (90.0 - params.heading_deg) * M_PI / 180.0;
  T_enu_world_.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

void SatelliteReceiver::observe(Time time, const Pose& T_world_robot) {
  if (!params_.enabled) return;
  if (!due_) due_ = time;
  if (time < *due_) return;
  *due_ = std::max(*due_ + 1.0 / params_.rate_hz, time);
  io::RecordedGnss fix;
  fix.time = time;
  fix.T_robot_antenna.translation() << params_.forward_m, 0.0, params_.height_m;
  Eigen::Vector3d enu = T_enu_world_ * (T_world_robot * fix.T_robot_antenna.translation());
  for (int axis = 0; axis < 3; ++axis) {
    enu[axis] += params_.sigma_m * (axis < 2 ? 1.0 : kHeightOverHorizontal) * random_.normal();
  }
  if (random_.chance(params_.outlier_ratio)) {
    const double direction = random_.uniform(0.0, 2.0 * M_PI);
    const double distance = random_.uniform(0.0, params_.outlier_m);
    enu += distance * Eigen::Vector3d(std::cos(direction), std::sin(direction), 0.0);
  }
  const auto position = frame_.positionOf(enu);
  fix.latitude_deg = position.latitude_deg;
  fix.longitude_deg = position.longitude_deg;
  fix.altitude_m = position.altitude_m;
  fix.satellites = kSatellites;
  fix.sigma_m = params_.sigma_m;
  fixes_.push_back(fix);
}

std::vector<io::RecordedGnss> SatelliteReceiver::take() { return std::exchange(fixes_, {}); }

TruePlace SatelliteReceiver::placeOf(Time time, const Pose& T_world_robot) const {
  const Pose T_enu_robot = T_enu_world_ * T_world_robot;
  const auto position = frame_.positionOf(T_enu_robot.translation());
  const double heading = 90.0 - yawOf(T_enu_robot) * 180.0 / M_PI;
  return {time, position.latitude_deg, position.longitude_deg, position.altitude_m,
          heading - 360.0 * std::floor(heading / 360.0)};
}

}  // namespace headway::sim
