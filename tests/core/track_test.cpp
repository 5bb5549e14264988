// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/track.h>

namespace headway {
namespace {

TEST(TrackTest, StartsWithoutMotionClassification) {
  const Track track;
  EXPECT_EQ(track.motion_state, MotionState::kUnknown);
  EXPECT_FALSE(isMoving(track));
}

TEST(TrackTest, OnlyTheMovingStateIsMoving) {
  Track track;
  track.motion_state = MotionState::kMoving;
  EXPECT_TRUE(isMoving(track));
  track.motion_state = MotionState::kStatic;
  EXPECT_FALSE(isMoving(track));
}

TEST(TrackTest, NamesItsMotionStates) {
  EXPECT_EQ(toString(MotionState::kUnknown), "unknown");
  EXPECT_EQ(toString(MotionState::kMoving), "moving");
  EXPECT_EQ(toString(MotionState::kStatic), "static");
}

/// A track with a different value in every field that a frame changes.
Track movingTrack() {
  Track track;
  track.id = TrackId{7};
  track.motion_state = MotionState::kMoving;
  track.position = {4.0, -2.0, 0.8};
  track.velocity = {1.5, 0.5, 0.1};
  track.yaw = 3.0;
  track.yaw_rate = 0.2;
  track.size = {4.0, 1.8, 1.5};
  track.position_covariance = Eigen::Vector3d(0.4, 0.1, 0.02).asDiagonal();
  track.velocity_covariance = Eigen::Vector2d(0.9, 0.3).asDiagonal();
  track.box2d = Box2d{1.0, 2.0, 30.0, 40.0};
  track.recent_path.push_back({3, 0.3, {3.0, -2.5, 0.8}, -3.0});
  PredictedPath path;
  path.probability = 0.6;
  path.points.push_back({1.0, {5.5, -1.5, 0.9}, Eigen::Vector2d(0.5, 0.2).asDiagonal()});
  track.predictions.push_back(path);
  return track;
}

void expectEqual(const Track& a, const Track& b) {
  constexpr double kRounding = 1e-12;
  EXPECT_TRUE(a.position.isApprox(b.position, kRounding));
  EXPECT_TRUE(a.velocity.isApprox(b.velocity, kRounding));
  EXPECT_NEAR(a.yaw, b.yaw, kRounding);
  EXPECT_EQ(a.yaw_rate, b.yaw_rate);
  EXPECT_EQ(a.size, b.size);
  EXPECT_TRUE(a.position_covariance.isApprox(b.position_covariance, kRounding));
  EXPECT_TRUE(a.velocity_covariance.isApprox(b.velocity_covariance, kRounding));
  EXPECT_TRUE(a.recent_path[0].position.isApprox(b.recent_path[0].position, kRounding));
  EXPECT_NEAR(a.recent_path[0].yaw, b.recent_path[0].yaw, kRounding);
  const auto& point = a.predictions[0].points[0];
  const auto& other = b.predictions[0].points[0];
  EXPECT_TRUE(point.position.isApprox(other.position, kRounding));
  EXPECT_TRUE(point.covariance.isApprox(other.covariance, kRounding));
}

TEST(TransformedTrackTest, TurnsAndMovesAllThatIsInTheFrame) {
  Pose T_map_odom = Pose::Identity();
  T_map_odom.translation() << 10.0, 20.0, 1.0;
  T_map_odom.linear() = expSo3({0.0, 0.0, M_PI / 2.0});
  Track expected = movingTrack();
  expected.position << 12.0, 24.0, 1.8;
  expected.velocity << -0.5, 1.5, 0.1;
  expected.yaw = 3.0 + M_PI / 2.0 - 2.0 * M_PI;
  expected.position_covariance = Eigen::Vector3d(0.1, 0.4, 0.02).asDiagonal();
  expected.velocity_covariance = Eigen::Vector2d(0.3, 0.9).asDiagonal();
  expected.recent_path[0] = {3, 0.3, {12.5, 23.0, 1.8}, M_PI / 2.0 - 3.0};
  expected.predictions[0].points[0] = {
      1.0, {11.5, 25.5, 1.9}, Eigen::Vector2d(0.2, 0.5).asDiagonal()};
  const Track moved = transformed(movingTrack(), T_map_odom);
  expectEqual(moved, expected);
  EXPECT_EQ(moved.id, TrackId{7});
  EXPECT_TRUE(isMoving(moved));
  EXPECT_EQ(moved.box2d->right, 30.0) << "in the image";
}

TEST(TransformedTrackTest, ThereAndBackChangesNothing) {
  Pose T_map_odom = Pose::Identity();
  T_map_odom.translation() << -3.0, 8.0, 0.5;
  T_map_odom.linear() = expSo3({0.0, 0.0, -2.4});
  const auto there = transformed(std::vector<Track>{movingTrack(), movingTrack()}, T_map_odom);
  ASSERT_EQ(there.size(), 2U);
  const auto back = transformed(there, T_map_odom.inverse());
  expectEqual(back[0], movingTrack());
  expectEqual(back[1], movingTrack());
}

}  // namespace
}  // namespace headway
