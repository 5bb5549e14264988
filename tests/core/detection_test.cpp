// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/detection.h>

#include <cmath>
#include <limits>

namespace headway {
namespace {

TEST(OpticalBoxTest, OfAnObjectAheadThatDrivesAway) {
  const Box3d box =
      opticalBox({10.0, 2.0, 0.5}, {4.0, 1.8, 1.5}, 0.0, robotFromOptical().inverse());
  EXPECT_TRUE(box.centre.isApprox(Eigen::Vector3d(-2.0, -0.5, 10.0), 1e-12));
  EXPECT_DOUBLE_EQ(box.length, 4.0);
  EXPECT_DOUBLE_EQ(box.width, 1.8);
  EXPECT_DOUBLE_EQ(box.height, 1.5);
  EXPECT_NEAR(box.yaw, -M_PI / 2.0, 1e-12);  // KITTI: along the camera's view
}

TEST(OpticalBoxTest, ItsFrontIsTheObjectsFront) {
  const double yaw = 0.7;
  const Pose T_optical_map = robotFromOptical().inverse();
  const Box3d box = opticalBox({10.0, 2.0, 0.5}, {4.0, 1.8, 1.5}, yaw, T_optical_map);
  const Eigen::Vector3d front = T_optical_map.linear().inverse() * frontOf(box);
  EXPECT_TRUE(front.isApprox(Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0), 1e-12));
}

TEST(IsFiniteTest, ChecksEveryNumberOfABox) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(isFinite(Box2d{1.0, 2.0, 3.0, 4.0}));
  EXPECT_FALSE(isFinite(Box2d{1.0, nan, 3.0, 4.0}));
  EXPECT_FALSE(isFinite(Box2d{1.0, 2.0, -infinite, infinite}));
  const Box3d box{{0.0, 0.0, 5.0}, 4.0, 2.0, 1.5, 0.1};
  EXPECT_TRUE(isFinite(box));
  for (double Box3d::*number : {&Box3d::length, &Box3d::width, &Box3d::height, &Box3d::yaw}) {
    Box3d broken = box;
    broken.*number = nan;
    EXPECT_FALSE(isFinite(broken));
  }
  Box3d nowhere = box;
  nowhere.centre.y() = infinite;
  EXPECT_FALSE(isFinite(nowhere));
}

Detections oneDetection() {
  Detection detection;
  detection.box2d = Box2d{10.0, 20.0, 30.0, 40.0};
  detection.box3d = Box3d{{1.0, 0.5, 12.0}, 4.0, 1.8, 1.5, 0.3};
  detection.centre_covariance = Eigen::Vector3d(0.1, 0.2, 0.9).asDiagonal();
  detection.velocity = MeasuredVelocity{{1.0, 0.0, 2.0}, Eigen::Matrix3d::Identity()};
  Detections detections;
  detections.items = {detection};
  return detections;
}

Pose otherSensor() {
  Pose T_robot_sensor = robotFromOptical();
  T_robot_sensor.linear() = expSo3({0.0, 0.0, 0.4}) * T_robot_sensor.linear();
  T_robot_sensor.translation() = Eigen::Vector3d(0.5, -0.3, 1.2);
  return T_robot_sensor;
}

TEST(InSensorFrameTest, KeepsWhereThingsAreOnTheRobot) {
  const Detections before = oneDetection();
  const Detections after = inSensorFrame(before, otherSensor());
  const Detection& old_one = before.items.front();
  const Detection& new_one = after.items.front();
  const Eigen::Matrix3d R_old = before.T_robot_sensor.linear();
  const Eigen::Matrix3d R_new = after.T_robot_sensor.linear();
  EXPECT_TRUE(after.T_robot_sensor.isApprox(otherSensor()));
  EXPECT_TRUE((after.T_robot_sensor * new_one.box3d->centre)
                  .isApprox(before.T_robot_sensor * old_one.box3d->centre, 1e-12));
  EXPECT_TRUE((R_new * frontOf(*new_one.box3d)).isApprox(R_old * frontOf(*old_one.box3d), 1e-12));
  EXPECT_TRUE((R_new * new_one.velocity->value).isApprox(R_old * old_one.velocity->value, 1e-12));
  EXPECT_TRUE((R_new * *new_one.centre_covariance * R_new.transpose())
                  .isApprox(R_old * *old_one.centre_covariance * R_old.transpose(), 1e-12));
  EXPECT_EQ(old_one.box2d->left, new_one.box2d->left);
}

TEST(InSensorFrameTest, ThereAndBackIsTheSame) {
  const Detections before = oneDetection();
  const Detections after =
      inSensorFrame(inSensorFrame(before, otherSensor()), before.T_robot_sensor);
  EXPECT_TRUE(after.items[0].box3d->centre.isApprox(before.items[0].box3d->centre, 1e-12));
  EXPECT_NEAR(before.items[0].box3d->yaw, after.items[0].box3d->yaw, 1e-12);
}

TEST(RotatedTest, TurnsTheCovarianceWithTheVelocity) {
  const Eigen::Matrix3d R = expSo3({0.0, M_PI / 2.0, 0.0});
  const Eigen::Matrix3d covariance = Eigen::Vector3d(1.0, 2.0, 3.0).asDiagonal();
  const MeasuredVelocity velocity = rotated({{1.0, 0.0, 0.0}, covariance}, R);
  EXPECT_TRUE(velocity.value.isApprox(Eigen::Vector3d(0.0, 0.0, -1.0), 1e-12));
  EXPECT_TRUE(velocity.covariance.isApprox(
      Eigen::Matrix3d(Eigen::Vector3d(3.0, 2.0, 1.0).asDiagonal()), 1e-12));
}

TEST(OpticalYawTest, IsInverseToFrontOf) {
  for (double yaw = -3.1; yaw < 3.1; yaw += 0.31) {
    EXPECT_NEAR(yaw, opticalYaw(frontOf({{}, 4.0, 2.0, 1.5, yaw})), 1e-12);
  }
}

TEST(IsCovarianceTest, AcceptsWhatIsPositiveUpToRounding) {
  const Eigen::Vector3d ray(1.0, 0.2, 30.0);
  const Eigen::Matrix3d singular = ray * ray.transpose();
  EXPECT_TRUE(isCovariance(Eigen::Matrix3d::Identity()));
  EXPECT_TRUE(isCovariance(Eigen::Matrix3d::Zero()));
  EXPECT_TRUE(isCovariance(singular));
  EXPECT_TRUE(isCovariance(singular - 1e-5 * Eigen::Matrix3d::Identity())) << "rounded";
  EXPECT_FALSE(isCovariance(singular - 0.1 * Eigen::Matrix3d::Identity()));
  EXPECT_FALSE(isCovariance(-Eigen::Matrix3d::Identity()));
  EXPECT_FALSE(isCovariance(1e7 * Eigen::Matrix3d::Identity()));
  EXPECT_FALSE(isCovariance(1e300 * Eigen::Matrix3d::Identity()));
  EXPECT_FALSE(isCovariance(Eigen::Matrix3d::Constant(std::nan(""))));
}

TEST(DetectionChecksTest, ACovarianceThatIsNoneIsCountedAndRemovedFromItsBox) {
  DropCounts dropped;
  Detection detection;
  removeBadCovariance(detection, dropped);
  detection.centre_covariance = Eigen::Matrix3d::Identity();
  removeBadCovariance(detection, dropped);
  EXPECT_TRUE(detection.centre_covariance);
  EXPECT_TRUE(dropped.empty());
  for (const double variance : {-1.0, 1e7, std::nan("")}) {
    detection.centre_covariance = variance * Eigen::Matrix3d::Identity();
    removeBadCovariance(detection, dropped);
    EXPECT_FALSE(detection.centre_covariance) << variance;
  }
  EXPECT_EQ((DropCounts{{"bad_covariance", 3}}), dropped);
}

TEST(IsPlausibleTest, JudgesFiniteNumbers) {
  Detection detection;
  detection.box3d = Box3d{{1.0, 0.5, 12.0}, 5.0, 2.0, 2.0, 0.0};
  EXPECT_TRUE(isPlausible(detection));
  detection.box3d->centre.x() = std::nan("");
  EXPECT_TRUE(isPlausible(detection));
  detection.box3d->length = 1e7;
  EXPECT_FALSE(isPlausible(detection));
  detection.box3d.reset();
  detection.box2d = Box2d{0.0, 0.0, 1e9, 1.0};
  EXPECT_FALSE(isPlausible(detection));
  detection.box2d.reset();
  detection.score = -1e154;
  EXPECT_FALSE(isPlausible(detection));
}

TEST(Box2dTest, ContainsItsEdges) {
  const Box2d box{1.0, 2.0, 5.0, 8.0};
  EXPECT_DOUBLE_EQ(4.0, box.width());
  EXPECT_DOUBLE_EQ(6.0, box.height());
  EXPECT_TRUE(box.contains(1.0, 2.0));
  EXPECT_TRUE(box.contains(5.0, 8.0));
  EXPECT_FALSE(box.contains(5.1, 8.0));
  EXPECT_FALSE(box.contains(3.0, 1.9));
}

}  // namespace
}  // namespace headway
