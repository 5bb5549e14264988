// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/bags/bag_selection.h>
#include <headway_test/input_error.h>

namespace headway::bags {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<BagTopic> topicsOf(std::initializer_list<std::pair<const char*, const char*>> list) {
  std::vector<BagTopic> topics;
  for (const auto& [name, type] : list) {
    topics.push_back({name, std::string("sensor_msgs/") + type, Encoding::kCdr, 10});
  }
  return topics;
}

TEST(BagSelectionTest, RawImagesArePreferred) {
  const auto selection =
      selectTopics(topicsOf({{"/s/left/image_rect", "Image"},
                             {"/s/right/image_rect", "Image"},
                             {"/s/left/image_raw/compressed", "CompressedImage"},
                             {"/s/right/image_raw/compressed", "CompressedImage"},
                             {"/s/left/image_raw", "Image"},
                             {"/s/right/image_raw", "Image"}}),
                   {});
  EXPECT_EQ("/s/left/image_raw", selection.left);
  EXPECT_EQ("/s/right/image_raw", selection.right);
}

TEST(BagSelectionTest, KnowsUsualNames) {
  for (const auto& [left, right] :
       {std::pair("/cam0/image_raw", "/cam1/image_raw"),
        std::pair("/camera/infra1/image_rect_raw", "/camera/infra2/image_rect_raw"),
        std::pair("/left/left_image", "/right/right_image")}) {
    const auto selection = selectTopics(topicsOf({{right, "Image"}, {left, "Image"}}), {});
    EXPECT_EQ(left, selection.left);
    EXPECT_EQ(right, selection.right);
  }
  EXPECT_EQ("/camera/left/camera_info", cameraInfoTopicOf("/camera/left/image_raw/compressed"));
}

TEST(BagSelectionTest, AlignedDepthIsPreferredAndStereoToBoth) {
  auto topics = topicsOf({{"/camera/depth/image_rect_raw", "Image"},
                          {"/camera/color/image_raw", "Image"},
                          {"/camera/aligned_depth_to_color/image_raw", "Image"}});
  const auto depth = selectTopics(topics, {});
  EXPECT_EQ("/camera/aligned_depth_to_color/image_raw", depth.depth);
  EXPECT_EQ("/camera/color/image_raw", depth.color);
  EXPECT_TRUE(depth.left.empty());
  topics.push_back({"/camera/infra1/image", "sensor_msgs/Image", Encoding::kCdr, 10});
  topics.push_back({"/camera/infra2/image", "sensor_msgs/Image", Encoding::kCdr, 10});
  EXPECT_EQ("/camera/infra1/image", selectTopics(topics, {}).left);
  BagWishes wishes;
  wishes.color = "/camera/color/image_raw";
  EXPECT_TRUE(selectTopics(topics, wishes).left.empty());
  wishes.left = "/camera/infra1/image";
  EXPECT_THAT(headway::test::inputErrorOf([&] { (void)selectTopics(topics, wishes); }),
              HasSubstr("give one of the two"));
}

TEST(BagSelectionTest, OneInertialSensorAndWheelOdometry) {
  auto topics = topicsOf({{"/left", "Image"},
                          {"/right", "Image"},
                          {"/zed/imu", "Imu"},
                          {"/camera/gyro/sample", "Imu"},
                          {"/camera/accel/sample", "Imu"}});
  topics.push_back({"/visual/odom", "nav_msgs/Odometry", Encoding::kCdr, 99});
  topics.push_back({"/odometry/filtered", "nav_msgs/Odometry", Encoding::kCdr, 99});
  topics.push_back({"/headway/odometry", "nav_msgs/Odometry", Encoding::kCdr, 99});
  topics.push_back({"/wheels/odom", "nav_msgs/Odometry", Encoding::kCdr, 9});
  const auto selection = selectTopics(topics, {});
  EXPECT_THAT(selection.imu, ElementsAre("/camera/gyro/sample", "/camera/accel/sample"));
  EXPECT_EQ("/wheels/odom", selection.odometry);
  BagWishes wishes;
  wishes.imu = "/zed/imu";
  wishes.odometry = "none";
  EXPECT_THAT(selectTopics(topics, wishes).imu, ElementsAre("/zed/imu"));
  EXPECT_EQ("", selectTopics(topics, wishes).odometry);
}

TEST(BagSelectionTest, AmbiguousCamerasAreListed) {
  const auto topics = topicsOf({{"/front/image_raw", "Image"}, {"/back/image_raw", "Image"}});
  EXPECT_THAT(headway::test::inputErrorOf([&] { (void)selectTopics(topics, {}); }),
              HasSubstr("images are in: /back/image_raw, /front/image_raw"));
}

}  // namespace
}  // namespace headway::bags
