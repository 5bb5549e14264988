// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/track.h>
#include <headway/slam/map_view.h>

#include <cmath>

namespace headway::map {

/// A confirmed, moving track with a history and two predictions; every field differs from its
/// default.
inline Track exampleTrack(std::int64_t id, ObjectClass object_class,
                          const Eigen::Vector3d& position, double yaw) {
  Track track;
  track.id = TrackId{id};
  track.object_class = object_class;
  track.status = TrackStatus::kConfirmed;
  track.motion_state = MotionState::kMoving;
  track.score = 0.75;
  track.position = position;
  track.yaw = yaw;
  track.velocity = 5.0 * Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0);
  track.yaw_rate = 0.1;
  track.size = {4.2, 1.8, 1.5};
  track.position_covariance = 0.04 * Eigen::Matrix3d::Identity();
  track.box2d = Box2d{100.0, 50.0, 180.0, 95.0};
  track.first_seen = 1.0;
  track.last_seen = 3.0;
  for (int i = 20; i > 0; --i) {
    track.recent_path.push_back({static_cast<std::size_t>(30 - i), 3.0 - 0.1 * i,
                                 position - 0.1 * i * track.velocity, yaw});
  }
  for (int mode = 0; mode < 2; ++mode) {
    PredictedPath path;
    path.mode = mode;
    path.probability = mode == 0 ? 0.7 : 0.3;
    for (int i = 1; i <= 30; ++i) {
      const double horizon = 0.1 * i;
      path.points.push_back({horizon, position + horizon * track.velocity,
                             (0.01 + 0.1 * horizon) * Eigen::Matrix2d::Identity()});
    }
    track.predictions.push_back(path);
  }
  return track;
}

inline slam::MapView exampleStaticMap(int landmarks = 40) {
  std::vector<slam::LandmarkView> seen;
  std::vector<slam::KeyframeView> keyframes;
  for (int i = 0; i < landmarks; ++i) {
    seen.push_back({LandmarkId{2 * i}, Eigen::Vector3d(i, 0.5 * i - 3.0, 0.1 * i), 3 + i % 4,
                    static_cast<std::uint8_t>(6 * i)});
  }
  for (int i = 0; i < 3; ++i) {
    slam::KeyframeView keyframe;
    keyframe.id = KeyframeId{i};
    keyframe.frame = static_cast<std::size_t>(10 * i);
    keyframe.time = 100.0 + i;
    keyframe.T_map_robot = Eigen::Translation3d(2.0 * i, 0.1, 0.0) *
                           Eigen::AngleAxisd(0.2 * i, Eigen::Vector3d::UnitZ());
    keyframe.covariance = 0.01 * (i + 1) * PoseCovariance::Identity();
    for (int j = i; j < landmarks; j += 2) keyframe.landmarks.push_back(LandmarkId{2 * j});
    keyframes.push_back(keyframe);
  }
  return {seen, keyframes};
}

}  // namespace headway::map
