// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/track.h>

#include <cmath>

namespace headway::test {

/// A confirmed pedestrian who walks straight on.
inline Track walkingTrack(std::int64_t id, const Eigen::Vector2d& place,
                          const Eigen::Vector2d& velocity, double sigma_m = 0.0) {
  Track track;
  track.id = TrackId{id};
  track.object_class = ObjectClass::kPedestrian;
  track.status = TrackStatus::kConfirmed;
  track.motion_state = MotionState::kMoving;
  track.position = {place.x(), place.y(), 0.85};
  track.velocity = {velocity.x(), velocity.y(), 0.0};
  track.yaw = std::atan2(velocity.y(), velocity.x());
  track.size = {0.5, 0.5, 1.7};
  track.position_covariance = sigma_m * sigma_m * Eigen::Matrix3d::Identity();
  PredictedPath path;
  for (int i = 1; i <= 30; ++i) {
    const double t = 0.1 * i;
    path.points.push_back(
        {t, track.position + t * track.velocity, sigma_m * sigma_m * Eigen::Matrix2d::Identity()});
  }
  track.predictions.push_back(path);
  return track;
}

}  // namespace headway::test
