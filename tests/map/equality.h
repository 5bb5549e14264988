// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <headway/core/track.h>
#include <headway/slam/map_view.h>

namespace headway::map {

inline void expectEqual(const PredictedPath& a, const PredictedPath& b) {
  EXPECT_EQ(a.mode, b.mode);
  EXPECT_EQ(a.probability, b.probability);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].horizon_s, b.points[i].horizon_s);
    EXPECT_EQ(a.points[i].position, b.points[i].position);
    EXPECT_EQ(a.points[i].covariance, b.points[i].covariance);
  }
}

inline void expectEqual(const Track& a, const Track& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.object_class, b.object_class);
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.motion_state, b.motion_state);
  EXPECT_EQ(a.score, b.score);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.yaw, b.yaw);
  EXPECT_EQ(a.yaw_rate, b.yaw_rate);
  EXPECT_EQ(a.size, b.size);
  EXPECT_EQ(a.position_covariance, b.position_covariance);
  ASSERT_EQ(a.box2d.has_value(), b.box2d.has_value());
  if (a.box2d) {
    EXPECT_EQ(a.box2d->left, b.box2d->left);
    EXPECT_EQ(a.box2d->top, b.box2d->top);
    EXPECT_EQ(a.box2d->right, b.box2d->right);
    EXPECT_EQ(a.box2d->bottom, b.box2d->bottom);
  }
  EXPECT_EQ(a.first_seen, b.first_seen);
  EXPECT_EQ(a.last_seen, b.last_seen);
  ASSERT_EQ(a.recent_path.size(), b.recent_path.size());
  for (std::size_t i = 0; i < a.recent_path.size(); ++i) {
    EXPECT_EQ(a.recent_path[i].frame, b.recent_path[i].frame);
    EXPECT_EQ(a.recent_path[i].time, b.recent_path[i].time);
    EXPECT_EQ(a.recent_path[i].position, b.recent_path[i].position);
    EXPECT_EQ(a.recent_path[i].yaw, b.recent_path[i].yaw);
  }
  ASSERT_EQ(a.predictions.size(), b.predictions.size());
  for (std::size_t i = 0; i < a.predictions.size(); ++i) {
    expectEqual(a.predictions[i], b.predictions[i]);
  }
}

inline void expectEqual(const slam::MapView& a, const slam::MapView& b) {
  ASSERT_EQ(a.landmarks.size(), b.landmarks.size());
  for (std::size_t i = 0; i < a.landmarks.size(); ++i) {
    EXPECT_EQ(a.landmarks[i].id, b.landmarks[i].id);
    EXPECT_EQ(a.landmarks[i].position, b.landmarks[i].position);
    EXPECT_EQ(a.landmarks[i].observations, b.landmarks[i].observations);
    EXPECT_EQ(a.landmarks[i].intensity, b.landmarks[i].intensity);
  }
  ASSERT_EQ(a.keyframes.size(), b.keyframes.size());
  for (std::size_t i = 0; i < a.keyframes.size(); ++i) {
    EXPECT_EQ(a.keyframes[i].id, b.keyframes[i].id);
    EXPECT_EQ(a.keyframes[i].frame, b.keyframes[i].frame);
    EXPECT_EQ(a.keyframes[i].time, b.keyframes[i].time);
    EXPECT_EQ(a.keyframes[i].T_map_robot.matrix(), b.keyframes[i].T_map_robot.matrix());
    EXPECT_EQ(a.keyframes[i].covariance, b.keyframes[i].covariance);
    EXPECT_EQ(a.keyframes[i].landmarks, b.keyframes[i].landmarks);
  }
}

}  // namespace headway::map
