// SPDX-License-Identifier: BSD-3-Clause
// Turns that contradict the gyroscope; images of wrong mountings: mounting_test.cpp.
#include <gmock/gmock.h>

#include "input_health.h"

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

/// A robot that yaws and pitches; the camera's turns are told in the robot frame by `R_written`,
/// its true attitude being `R_true`; the gyroscope has the given bias [rad per frame].
Findings turnAround(const Eigen::Matrix3d& R_true, const Eigen::Matrix3d& R_written, double bias,
                    const Eigen::Matrix3d& R_robot_imu = Eigen::Matrix3d::Identity()) {
  MountCheck check(camera(R_written));
  Findings findings;
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d turn(0.0, i % 2 == 0 ? 0.012 : -0.009, 0.03);
    const Eigen::Vector3d by_camera = R_written * R_true.transpose() * turn;
    const Eigen::Matrix3d by_gyroscope =
        expSo3(R_robot_imu * turn + bias * Eigen::Vector3d::Ones());
    auto found = check.addTurn(expSo3(by_camera), by_gyroscope, static_cast<std::size_t>(i));
    if (found) findings.push_back(std::move(*found));
  }
  return findings;
}

TEST(MountCheckTest, TheGyroscopeTellsAMissingOpticalTurn) {
  const Eigen::Matrix3d optical = robotFromOptical().linear();
  const Eigen::Matrix3d down(Eigen::AngleAxisd(0.17, Eigen::Vector3d::UnitY()));
  EXPECT_TRUE(turnAround(optical, optical, 0.002).empty());
  EXPECT_TRUE(turnAround(down * optical, down * optical, 0.002).empty());
  const Findings findings = turnAround(down * optical, down, 0.002);
  ASSERT_EQ(1U, findings.size());
  EXPECT_EQ(Severity::kFatal, findings[0].severity);
  EXPECT_THAT(findings[0].text, AllOf(HasSubstr("gyroscope"), HasSubstr("write cameraPose = ["),
                                      HasSubstr("-90.0 ")));
}

TEST(MountCheckTest, OtherWrongAxesAreNotTakenForAWrongCamera) {
  const Eigen::Matrix3d optical = robotFromOptical().linear();
  EXPECT_TRUE(turnAround(optical, optical, 0.0, optical.transpose()).empty());
  const Eigen::Vector3d upside_down(-1.0, -1.0, 1.0);
  EXPECT_TRUE(turnAround(optical, optical, 0.0, upside_down.asDiagonal()).empty());
}

}  // namespace
}  // namespace headway::pipeline
