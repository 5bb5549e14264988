#include "contrast.h"

#include <gtest/gtest.h>
#include <headway/slam/stereo_slam.h>
#include <headway_test/textured_world.h>

#include <opencv2/core.hpp>

namespace headway::slam {
namespace {

double deviationOf(const cv::Mat& image) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  return deviation[0];
}

TEST(ContrastStretch, LeavesAnImageInGoodLightAsItIs) {
  cv::Mat image(50, 50, CV_8U);
  cv::randu(image, 0, 256);
  EXPECT_EQ(stretched(image, stretchFor(image)).data, image.data);
}

TEST(ContrastStretch, GivesADarkImageTheContrastOfGoodLight) {
  cv::Mat image(50, 50, CV_8U);
  cv::randu(image, 20, 60);
  const double before = deviationOf(image);
  ASSERT_LT(before, 15.0);
  EXPECT_NEAR(deviationOf(stretched(image, stretchFor(image))), 40.0, 1.0);
}

TEST(ContrastStretch, MakesNothingOutOfNothing) {
  const cv::Mat black(50, 50, CV_8U, cv::Scalar(3));
  EXPECT_EQ(deviationOf(stretched(black, stretchFor(black))), 0.0);
}

TEST(StereoSlam, SeesInTheDark) {
  test::TexturedWorld world(test::smallCamera());
  world.addRoom(12.0, 8.0, 4.0);
  StereoSlam slam(world.camera(), SlamParams{});
  for (int i = 0; i < 12; ++i) {
    Pose pose = Pose::Identity();
    pose.translation().x() = 0.05 * i;
    StereoFrame frame = world.frame(i, 0.1 * i, pose);
    for (cv::Mat* image : {&frame.left, &frame.right}) image->convertTo(*image, CV_8U, 0.1, 4.0);
    const auto update = slam.process(frame, {});
    ASSERT_EQ(update.status, TrackingStatus::kTracked) << i;
    EXPECT_LT((update.T_map_robot.translation() - pose.translation()).norm(), 0.03) << i;
  }
}

}  // namespace
}  // namespace headway::slam
