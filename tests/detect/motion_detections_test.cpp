// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/appearance.h>
#include <headway/detect/detector.h>
#include <headway/detect/stereo_motion.h>

#include <opencv2/core.hpp>

#include "appearance.h"
#include "drive.h"

namespace headway::detect {
namespace {

constexpr Time kTime = 5.0;
constexpr double kObjectDepth = 10.0;
const StereoCamera kCamera = test::testCamera();

/// One object straight ahead, covered by a single cell of the disparity grid.
MotionDetections oneObject(const Eigen::Vector3d& velocity = Eigen::Vector3d::Zero()) {
  Detection object;
  object.box2d = Box2d{600.0, 150.0, 640.0, 250.0};
  object.box3d = Box3d{{0.0, 0.0, kObjectDepth}, 0.7, 0.6, 1.7, 0.0};
  object.velocity = MeasuredVelocity{velocity, Eigen::Matrix3d::Identity()};
  object.mask = maskOf({{310, 100}}, 2);
  MotionDetections motion;
  motion.detections.emplace();
  motion.detections->time = kTime;
  motion.detections->items = {object};
  motion.max_ahead_s = 0.6;
  return motion;
}

TEST(RegionsAtTest, OfTheFrameItselfAreItsBoxesAndMasks) {
  const auto regions = oneObject({1.0, 0.0, 0.0}).regionsAt(kTime, kCamera);
  ASSERT_EQ(regions.boxes.size(), 1u);
  EXPECT_EQ(regions.boxes[0].left, 600.0);
  EXPECT_EQ(regions.boxes[0].bottom, 250.0);
  EXPECT_TRUE(regions.unsure.empty());
  EXPECT_EQ(regions.mask.size(), cv::Size(kCamera.width, kCamera.height));
  EXPECT_EQ(cv::countNonZero(regions.mask), 36) << "the cell of 2 x 2 px and one more each way";
  EXPECT_NE(regions.mask.at<unsigned char>(200, 620), 0);
}

TEST(RegionsAtTest, MoveWithTheObject) {
  const auto regions = oneObject({2.0, 0.0, 0.0}).regionsAt(kTime + 0.1, kCamera);
  const double shift = 0.2 / kObjectDepth * kCamera.fx;
  EXPECT_NEAR(regions.boxes[0].left, 600.0 + shift, 1e-6);
  EXPECT_NE(regions.mask.at<unsigned char>(200, 620 + cvRound(shift)), 0);
  EXPECT_EQ(regions.mask.at<unsigned char>(200, 618), 0);
}

TEST(RegionsAtTest, MoveAgainstTheCamera) {
  MotionDetections motion = oneObject();
  motion.camera_velocity = {-1.0, 0.0, 0.0};  // the camera moves right: points move left
  EXPECT_NEAR(motion.regionsAt(kTime + 0.1, kCamera).boxes[0].left,
              600.0 - 0.1 / kObjectDepth * kCamera.fx, 1e-6);
  motion = oneObject();
  motion.camera_turn_rate = {0.0, 0.2, 0.0};
  EXPECT_NEAR(motion.regionsAt(kTime + 0.1, kCamera).boxes[0].left,
              600.0 + std::tan(0.02) * kCamera.fx, 1e-6);
}

TEST(RegionsAtTest, AreEmptyTooLongAfterTheFrameOrWithoutObjects) {
  const auto late = oneObject().regionsAt(kTime + 0.7, kCamera);
  EXPECT_TRUE(late.boxes.empty());
  EXPECT_TRUE(late.mask.empty());
  EXPECT_TRUE(MotionDetections().regionsAt(kTime, kCamera).boxes.empty());
  MotionDetections none = oneObject();
  none.detections->items.clear();
  EXPECT_TRUE(none.regionsAt(kTime, kCamera).mask.empty());
}

TEST(RegionsAtTest, AnObjectThatPassesTheCameraKeepsItsPlace) {
  const auto regions = oneObject({0.0, 0.0, -200.0}).regionsAt(kTime + 0.1, kCamera);
  ASSERT_EQ(regions.boxes.size(), 1u);
  EXPECT_EQ(regions.boxes[0].left, 600.0);
}

TEST(RegionsAtTest, WithoutAMaskTheBoxAloneIsLeftOut) {
  MotionDetections motion = oneObject();
  motion.detections->items[0].mask = nullptr;
  const auto regions = motion.regionsAt(kTime, kCamera);
  EXPECT_EQ(regions.boxes.size(), 1u);
  EXPECT_EQ(cv::countNonZero(regions.mask), 0);
}

}  // namespace
}  // namespace headway::detect
