// SPDX-License-Identifier: BSD-3-Clause
// Motions that contradict odometry or the gyroscope; images of wrong mountings: mounting_test.cpp.
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/pipeline/mount_check.h>

namespace headway::pipeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

StereoCamera camera(const Eigen::Matrix3d& R_robot_cam = robotFromOptical().linear()) {
  StereoCamera result;
  result.fx = result.fy = 450.0;
  result.cx = 320.0;
  result.cy = 240.0;
  result.width = 640;
  result.height = 480;
  result.baseline_m = 0.12;
  result.T_robot_cam.linear() = R_robot_cam;
  return result;
}

Pose step(double x) {
  Pose pose = Pose::Identity();
  pose.translation().x() = x;
  return pose;
}

/// Warnings after 3 m by odometry, of which the camera measured `ratio` times as much.
Warnings afterRatio(double ratio) {
  MountCheck check(camera());
  Warnings warnings;
  for (std::size_t i = 0; i < 30; ++i) {
    check.addMotion(step(0.1 * ratio), step(0.1), i, warnings);
  }
  return warnings;
}

TEST(MountCheckTest, EqualMotionsGiveNoWarning) {
  EXPECT_TRUE(afterRatio(1.0).empty());
  EXPECT_TRUE(afterRatio(2.0).empty());
  EXPECT_TRUE(afterRatio(0.5).empty());
}

TEST(MountCheckTest, ADifferentScaleIsAWarningOnce) {
  for (const double ratio : {4.0, 0.2, 0.0}) {
    const Warnings warnings = afterRatio(ratio);
    ASSERT_EQ(1u, warnings.count("odometry_scale")) << ratio;
    EXPECT_EQ(1u, warnings.at("odometry_scale").count);
    EXPECT_NEAR(20.0, static_cast<double>(warnings.at("odometry_scale").first_frame), 1.0);
    EXPECT_THAT(warnings.at("odometry_scale").text,
                AllOf(HasSubstr("check the baseline (0.12 m)"), HasSubstr("where odometry")));
  }
}

TEST(MountCheckTest, AThousandfoldScaleIsAnErrorWithTheBaselineToWrite) {
  try {
    afterRatio(1000.0);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("as if in another unit"), HasSubstr("0.00012 m")));
  }
}

TEST(MountCheckTest, WithoutOdometryNothingIsCompared) {
  MountCheck check(camera());
  Warnings warnings;
  for (std::size_t i = 0; i < 100; ++i) check.addMotion(step(100.0), std::nullopt, i, warnings);
  EXPECT_TRUE(warnings.empty());
}

/// A robot that yaws and pitches; the camera's turns are told in the robot frame by `R_written`,
/// its true attitude being `R_true`; the gyroscope has the given bias [rad per frame].
void turnAround(const Eigen::Matrix3d& R_true, const Eigen::Matrix3d& R_written, double bias,
                const Eigen::Matrix3d& R_robot_imu = Eigen::Matrix3d::Identity()) {
  MountCheck check(camera(R_written));
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d turn(0.0, i % 2 == 0 ? 0.012 : -0.009, 0.03);
    const Eigen::Vector3d by_camera = R_written * R_true.transpose() * turn;
    check.addTurn(expSo3(by_camera), expSo3(R_robot_imu * turn + bias * Eigen::Vector3d::Ones()));
  }
}

TEST(MountCheckTest, TheGyroscopeTellsAMissingOpticalTurn) {
  const Eigen::Matrix3d optical = robotFromOptical().linear();
  const Eigen::Matrix3d down(Eigen::AngleAxisd(0.17, Eigen::Vector3d::UnitY()));
  EXPECT_NO_THROW(turnAround(optical, optical, 0.002));
  EXPECT_NO_THROW(turnAround(down * optical, down * optical, 0.002));
  try {
    turnAround(down * optical, down, 0.002);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("gyroscope"), HasSubstr("write cameraPose = ["),
                                    HasSubstr("-90.0 ")));
  }
}

TEST(MountCheckTest, OtherWrongAxesAreNotTakenForAWrongCamera) {
  const Eigen::Matrix3d optical = robotFromOptical().linear();
  EXPECT_NO_THROW(turnAround(optical, optical, 0.0, optical.transpose()));
  const Eigen::Vector3d upside_down(-1.0, -1.0, 1.0);
  EXPECT_NO_THROW(turnAround(optical, optical, 0.0, upside_down.asDiagonal()));
}

}  // namespace
}  // namespace headway::pipeline
