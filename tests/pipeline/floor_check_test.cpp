// SPDX-License-Identifier: BSD-3-Clause
// Mountings by the floor in view: what is a floor, and what is said about the mounting stated.
#include <gmock/gmock.h>
#include <headway_test/textured_world.h>

#include <map>
#include <string>

#include "input_health.h"

namespace headway::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A camera that looks down and is rolled.
StereoCamera camera(double height_m, double down_rad, double roll_rad) {
  StereoCamera result = test::smallCamera();
  result.T_robot_cam.linear() =
      expSo3({0.0, down_rad, 0.0}) * expSo3({roll_rad, 0.0, 0.0}) * robotFromOptical().linear();
  result.T_robot_cam.translation().z() = height_m;
  return result;
}

/// A camera at 0.6 m, 19 deg down and rolled by 9 deg, that moves for 4 s over a plane.
struct Motion {
  double height_m = 0.6;
  double down_rad = 19.0 * kDegree;
  double roll_rad = 9.0 * kDegree;
  double speed_mps = 0.5;
  double climb_m = 0.0;     ///< amplitude of its height, as of a hand
  double sway_rad = 0.0;    ///< amplitude of its roll
  double unit = 1.0;        ///< of all distances
  double seen_ratio = 1.0;  ///< of the frames
};

struct Result {
  Findings findings;
  std::optional<FloorCheck::Mounting> mounting;
  std::optional<Pose> replacement;
};

Result move(const StereoCamera& stated, const Motion& motion) {
  FloorCheck check(stated);
  Result result;
  for (int i = 0; i < 40; ++i) {
    const double phase = std::sin(0.5 * i), height = motion.height_m + motion.climb_m * phase;
    const StereoCamera real =
        camera(height, motion.down_rad, motion.roll_rad + motion.sway_rad * phase);
    std::optional<stereo::GroundPlane> floor;
    if (i < 40 * motion.seen_ratio) {
      floor.emplace();
      floor->up = stereo::mountedUp(real);
      floor->camera_height = motion.unit * height;
    }
    Pose T_odom_cam = real.T_robot_cam;
    T_odom_cam.translation() = motion.unit * Eigen::Vector3d(0.1 * i * motion.speed_mps, 0, height);
    auto found = check.add(0.1 * i, static_cast<std::size_t>(i), floor, T_odom_cam);
    if (found) result.findings.push_back(std::move(*found));
  }
  result.mounting = check.mounting();
  result.replacement = check.replacement();
  return result;
}

TEST(FloorCheckTest, AMountingThatIsRightIsConfirmed) {
  const Result result = move(camera(0.6, 19.0 * kDegree, 9.0 * kDegree), {});
  EXPECT_TRUE(result.findings.empty());
  ASSERT_TRUE(result.mounting);
  EXPECT_NEAR(0.6, result.mounting->height_m, 1e-6);
  EXPECT_NEAR(19.0 * kDegree, result.mounting->down_rad, 1e-6);
  EXPECT_GT(result.mounting->covariance.diagonal().minCoeff(), 0.0);
  EXPECT_FALSE(result.replacement);
}

TEST(FloorCheckTest, AMountingThatIsNotStatedIsSaidOnce) {
  const Result result = move(camera(0.0, 0.0, 0.0), {});
  ASSERT_EQ(1U, result.findings.size());
  EXPECT_EQ("camera_mounting", result.findings[0].name);
  EXPECT_THAT(result.findings[0].text,
              AllOf(HasSubstr("0.60 m"), HasSubstr("19.0 deg"), HasSubstr("1.65 m")));
  ASSERT_TRUE(result.replacement);
  const Pose T_robot_cam = camera(0.6, 19.0 * kDegree, 9.0 * kDegree).T_robot_cam;
  EXPECT_NEAR(0.0, (*result.replacement * T_robot_cam.inverse()).translation().norm(), 1e-6);
  // The heading of the optical axis is the assumed one.
  EXPECT_NEAR(0.0, result.replacement->linear()(1, 2), 1e-9);
  EXPECT_LT(logSo3(result.replacement->linear().transpose() * T_robot_cam.linear()).norm(), 1e-6);
}

TEST(FloorCheckTest, ACameraAsOnACarIsAssumedRightly) {
  Motion car;
  car.height_m = 1.5;
  car.down_rad = 3.0 * kDegree;
  car.roll_rad = 0.0;
  car.speed_mps = 5.0;
  const Result result = move(camera(0.0, 0.0, 0.0), car);
  ASSERT_EQ(1U, result.findings.size());
  EXPECT_THAT(result.findings[0].text, HasSubstr("level are assumed"));
  EXPECT_FALSE(result.replacement);
}

TEST(FloorCheckTest, AHeightThatNoCameraIsMountedAtReplacesNothing) {
  Motion motion;
  motion.unit = 1000.0;
  const Result result = move(camera(0.0, 0.0, 0.0), motion);
  EXPECT_EQ(1U, result.findings.size());
  EXPECT_FALSE(result.replacement);
}

TEST(FloorCheckTest, AWrongMountingIsSaidWithBothNumbers) {
  const Result height = move(camera(0.9, 19.0 * kDegree, 9.0 * kDegree), {});
  ASSERT_EQ(1U, height.findings.size());
  EXPECT_THAT(height.findings[0].text,
              AllOf(HasSubstr("0.60 m"), HasSubstr("0.90 m"), Not(HasSubstr("unit"))));
  const Result pitch = move(camera(0.6, 13.0 * kDegree, 9.0 * kDegree), {});
  ASSERT_EQ(1U, pitch.findings.size());
  EXPECT_THAT(pitch.findings[0].text, AllOf(HasSubstr("19.0 deg"), HasSubstr("13.0 deg")));
}

TEST(FloorCheckTest, AFactorOfUnitsNamesTheUnit) {
  const std::map<double, std::string> units = {{5.0, "as of 1/5000 m, read as millimetres"},
                                               {0.2, "as of millimetres, read as 1/5000 m"},
                                               {1000.0, "as of millimetres, read as metres"},
                                               {0.001, "as of metres, read as millimetres"}};
  for (const bool is_depth : {true, false}) {
    for (const auto& [unit, text] : units) {
      StereoCamera stated = camera(0.6, 19.0 * kDegree, 9.0 * kDegree);
      if (is_depth) stated.depth_reach_m = 1000.0;
      Motion motion;
      motion.unit = unit;
      const Result result = move(stated, motion);
      ASSERT_EQ(1U, result.findings.size()) << unit;
      const bool is_named = is_depth || unit == 1000.0 || unit == 0.001;
      EXPECT_THAT(result.findings[0].text, HasSubstr(is_named ? text : "as of another unit"));
      EXPECT_THAT(result.findings[0].text, HasSubstr("is stated to be 0.60 m"));
    }
  }
}

TEST(FloorCheckTest, AHandAndACameraAtRestMeasureNothing) {
  const StereoCamera stated = camera(0.0, 0.0, 0.0);
  Motion hand;
  hand.climb_m = 0.08;
  EXPECT_FALSE(move(stated, hand).mounting);
  hand = {};
  hand.sway_rad = 5.0 * kDegree;
  EXPECT_FALSE(move(stated, hand).mounting);
  Motion rest;
  rest.speed_mps = 0.0;
  EXPECT_FALSE(move(stated, rest).mounting);
  Motion seen_shortly;
  seen_shortly.seen_ratio = 0.3;
  EXPECT_FALSE(move(stated, seen_shortly).mounting);
}

}  // namespace
}  // namespace headway::pipeline
