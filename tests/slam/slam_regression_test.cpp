#include <gtest/gtest.h>
#include <headway/slam/stereo_slam.h>
#include <headway_test/folders.h>
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

// Limits are what the room promises, not what it reaches today.

TEST(SlamRegression, KittiStreetStaysWithin8Cm) {
  HEADWAY_REQUIRE_DATA(data);
  const auto outcome = runOver(test::kittiSequence(data / "kitti_odometry", "06"));
  EXPECT_EQ(outcome.lost, 0U);
  EXPECT_LE(outcome.ate_m, 0.08);
}

TEST(SlamRegression, KittiMotorwayIsTrackedThroughout) {
  HEADWAY_REQUIRE_DATA(data);
  const auto outcome = runOver(test::kittiSequence(data / "kitti_odometry", "01"));
  EXPECT_EQ(outcome.lost, 0U);
  EXPECT_LE(outcome.ate_m, 1.3);
}

TEST(SlamRegression, EurocHallStaysWithin8Mm) {
  HEADWAY_REQUIRE_DATA(data);
  const auto outcome = runOver(test::eurocSequence(data / "euroc" / "MH_01_easy"));
  EXPECT_EQ(outcome.lost, 0U);
  EXPECT_LE(outcome.ate_m, 0.008);
}

}  // namespace
}  // namespace headway::slam
