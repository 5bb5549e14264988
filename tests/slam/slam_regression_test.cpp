// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/slam/stereo_slam.h>
#include <headway_test/folders.h>
#include <headway_test/limits.h>
#include <headway_test/stereo_sequence.h>

namespace headway::slam {
namespace {

struct Outcome {
  std::size_t lost = 0;
  double ate_m = 0.0;
};

Outcome runOver(const test::StereoSequence& sequence) {
  StereoSlam slam(sequence.camera, SlamParams{});
  Outcome outcome;
  for (std::size_t i = 0; i < sequence.times.size(); ++i) {
    const auto update = slam.process(sequence.frame(i), {});
    outcome.lost += update.status == TrackingStatus::kLost ? 1 : 0;
  }
  std::vector<std::pair<Time, Eigen::Vector3d>> path;
  for (const auto& estimate : slam.trajectory()) {
    path.emplace_back(estimate.time, estimate.T_map_robot.translation());
  }
  outcome.ate_m = test::absoluteTrajectoryError(path, sequence.truth);
  return outcome;
}

TEST(SlamRegressionTest, FollowsAKittiStreet) {
  HEADWAY_REQUIRE_DATA(data);
  const auto outcome = runOver(test::kittiSequence(data / "kitti_odometry", "06"));
  EXPECT_EQ(outcome.lost, 0U);
  test::expectWithin("ate_rmse_m", outcome.ate_m, test::kKitti06AteM);
}

TEST(SlamRegressionTest, FollowsAKittiMotorway) {
  HEADWAY_REQUIRE_DATA(data);
  const auto outcome = runOver(test::kittiSequence(data / "kitti_odometry", "01"));
  EXPECT_EQ(outcome.lost, 0U);
  test::expectWithin("ate_rmse_m", outcome.ate_m, test::kKitti01AteM);
}

TEST(SlamRegressionTest, FollowsTheEurocHall) {
  HEADWAY_REQUIRE_DATA(data);
  const auto outcome = runOver(test::eurocSequence(data / "euroc" / "MH_01_easy"));
  EXPECT_EQ(outcome.lost, 0U);
  test::expectWithin("ate_rmse_m", outcome.ate_m, test::kEurocMh01AteM);
}

}  // namespace
}  // namespace headway::slam
