// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "trial_pictures.h"

namespace headway::app {
namespace {

/// A robot that makes a wide detour on its way to the goal.
TrialRecord detour(const RobotParams& robot, double side_m) {
  TrialRecord record;
  record.policy = "sweep";
  const auto scene = std::make_shared<TrialScene>(TrialScene{{robot.goal_m, 0.0}, {}, {}});
  for (int i = 0; i <= 40; ++i) {
    TrialMoment moment;
    moment.scene = scene;
    moment.time_s = 0.25 * i;
    const double ratio = i / 40.0;
    moment.robot = {ratio * robot.goal_m, side_m * std::sin(ratio * 3.14159), 0.0};
    record.moments.push_back(moment);
  }
  return record;
}

int bluePixels(const cv::Mat& picture) {
  cv::Mat robot;
  cv::inRange(picture, cv::Scalar(150, 75, 10), cv::Scalar(190, 115, 50), robot);
  return cv::countNonZero(robot);
}

TEST(TopViewTest, ADetourStaysInItsPanel) {
  const RobotParams robot;
  const auto record = detour(robot, 12.0);
  const cv::Mat picture = drawWhole({record, record, record}, robot);
  const int width = picture.cols / 3;
  for (int panel = 0; panel < 3; ++panel) {
    const cv::Mat left = picture(cv::Rect(panel * width, 70, width / 2, 560));
    const cv::Mat edge = picture(cv::Rect(panel * width, 70, 4, 560));
    EXPECT_GT(bluePixels(left), 200) << "the way to the left is drawn";
    EXPECT_EQ(0, bluePixels(edge)) << "and does not reach the edge of the panel";
  }
}

TEST(TopViewTest, EachRecordFillsItsPanel) {
  const RobotParams robot;
  const cv::Mat picture = drawWhole({detour(robot, 0.5), detour(robot, 60.0)}, robot);
  const int width = picture.cols / 2;
  for (int panel = 0; panel < 2; ++panel) {
    const cv::Mat half = picture(cv::Rect(panel * width, 64, width, 602));
    cv::Mat drawn;
    cv::inRange(half, cv::Scalar(150, 75, 10), cv::Scalar(190, 115, 50), drawn);
    const cv::Rect covered = cv::boundingRect(drawn);
    const int middle = covered.y + covered.height / 2;
    EXPECT_NEAR(301, middle, 40) << "in the middle";
    EXPECT_GT(std::max(covered.width / double(width), covered.height / 602.0), 0.8) << "whole";
  }
}

TEST(TopViewTest, TheGroundIsDrawnByWhatIsSeenNowAndByTheMap) {
  auto layer = std::make_shared<map::LocalLayer>(5.0, map::RobotFootprint{0.5, 0.4});
  GroundScan scan;
  scan.obstacles = {{{2.0F, 0.0F, 0.0F}, 0.03F}};
  for (int frame = 0; frame < 3; ++frame) layer->add(1.0, Pose::Identity(), scan, std::nullopt);
  map::PerceptionMap map;
  map.update(1.0, {}, Pose::Identity());
  map.update(std::shared_ptr<const map::LocalLayer>(layer));
  const cv::Mat picture = drawGround(groundAbout({}, map, map::kCaution), {});
  cv::Mat blocked;
  cv::inRange(picture, cv::Scalar(60, 60, 215), cv::Scalar(60, 60, 215), blocked);
  const cv::Mat now = blocked.colRange(0, picture.cols / 2);
  ASSERT_GT(cv::countNonZero(now), 0);
  EXPECT_EQ(0, cv::countNonZero(blocked.colRange(picture.cols / 2, picture.cols))) << "no grid";
  const cv::Moments middle = cv::moments(now, true);
  EXPECT_NEAR(0.5 * now.cols, middle.m10 / middle.m00, 6.0) << "straight ahead";
  EXPECT_LT(middle.m01 / middle.m00, 0.4 * now.rows) << "which is upwards";
}

}  // namespace
}  // namespace headway::app
