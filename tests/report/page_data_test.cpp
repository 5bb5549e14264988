// SPDX-License-Identifier: BSD-3-Clause
#include "page_data.h"

#include <gmock/gmock.h>
#include <headway/report/replay_page.h>

#include <opencv2/core.hpp>
#include <sstream>

namespace headway::report {
namespace {

using ::testing::ElementsAre;

TEST(PackedPointsTest, KeepThePlacesToAHalfStep) {
  std::vector<ColouredPoint> points;
  for (int i = 0; i < 500; ++i) {
    points.push_back({{0.37f * static_cast<float>(i), -5.0f, 0.01f * static_cast<float>(i % 7)},
                      {static_cast<std::uint8_t>(i % 256), 7, 9}});
  }
  const PackedPoints result = packed(points);
  ASSERT_EQ(500u, result.count);
  ASSERT_EQ(9u * 500u, result.bytes.size());
  EXPECT_LT(result.step.x(), 0.003);
  EXPECT_NEAR(0.37, result.spacing, 0.001);
  std::vector<bool> found(500);
  bool is_shuffled = false;
  for (std::size_t i = 0; i < 500; ++i) {
    const auto u16 = [&](std::size_t axis) {
      const std::size_t at = 2 * (3 * i + axis);
      return result.bytes[at] + 256 * result.bytes[at + 1];
    };
    const double x = result.origin.x() + result.step.x() * u16(0);
    const auto original = static_cast<std::size_t>(std::lround(x / 0.37));
    EXPECT_NEAR(0.37 * static_cast<double>(original), x, 0.51 * result.step.x() + 1e-5);
    EXPECT_EQ(original % 256, result.bytes[6 * 500 + 3 * i]) << "colours stay with their points";
    found[original] = true;
    is_shuffled = is_shuffled || original != i;
  }
  EXPECT_EQ(500, std::count(found.begin(), found.end(), true));
  EXPECT_TRUE(is_shuffled) << "the first points are a sample of all";
  EXPECT_EQ(result.bytes, packed(points).bytes);
}

TEST(PackedPointsTest, LeaveOutWhatIsNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(1u, packed({{{1, 2, 3}, {}}, {{nan, 0, 0}, {}}}).count);
  EXPECT_EQ(0u, packed({}).count);
  EXPECT_EQ(0.0, packed({}).spacing);
}

TEST(PageImagesTest, ALongRecordingKeepsAnEvenSample) {
  PageImages images;
  const cv::Mat image(30, 1000, CV_8U, cv::Scalar(50));
  for (std::size_t frame = 0; frame < 1000; ++frame) images.add(frame, image);
  images.add(1000, cv::Mat());
  std::vector<std::size_t> frames;
  for (const auto& [frame, jpeg] : images.jpegs()) frames.push_back(frame);
  ASSERT_GT(frames.size(), 60u);
  ASSERT_LE(frames.size(), 160u);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    EXPECT_EQ(frames[1] - frames[0], frames[i] - frames[i - 1]);
  }
  EXPECT_GT(frames.back(), 980u);
}

TEST(PageDataTest, StatesAndPredictionsAreWholeNumbers) {
  Track track;
  track.id = TrackId{42};
  track.object_class = ObjectClass::kCar;
  track.status = TrackStatus::kCoasting;
  track.motion_state = MotionState::kMoving;
  track.position << 1.234, -2.0, 0.5;
  track.yaw = -0.25;
  track.velocity << 3.0, 4.0, 0.0;
  track.size << 4.0, 1.8, 1.5;
  PredictedPoint point{1.0, {4.2, 2.0, 0.5}, Eigen::Vector2d(4.0, 1.0).asDiagonal()};
  track.predictions = {{0, 0.7, {point}}};
  ReplayFrame frame{9, 100.5, Pose::Identity(), {track}, {}};
  ReplayFrame before{8, 100.0, Pose::Identity(), {}, {}};
  const std::vector<ReplayFrame> frames = {before, frame};
  std::ostringstream text;
  writePageData(text, pageData("/nonexistent", frames, {}, {}, [](const auto&) {}), frames);
  const auto data = nlohmann::json::parse(text.str());
  EXPECT_EQ(0.5, data["frames"][1]["time"]);
  EXPECT_EQ(9, data["frames"][1]["frame"]);
  EXPECT_THAT(data["frames"][1]["states"][0].get<std::vector<int>>(),
              ElementsAre(0, 1, 3, 123, -200, 50, -250, 300, 400, 400, 180, 150));
  EXPECT_THAT(data["frames"][1]["predictions"][0].get<std::vector<int>>(),
              ElementsAre(0, 70, 10, 420, 200, 50, 200, 100, 0));
  EXPECT_EQ(42, data["tracks"][0]["id"]);
  EXPECT_EQ(1, data["tracks"][0]["votes"]["1"]);
  EXPECT_TRUE(data["truth"].is_null());
  EXPECT_TRUE(data["camera"].is_null());
}

TEST(PageDataTest, OfVeryManyTrueBoxesTheNearestAreShownAndTheRestIsSaid) {
  ReplayTruth truth;
  truth.path = {{100.0, Pose::Identity()}};
  truth.objects[0].resize(20100);
  for (std::size_t i = 0; i < truth.objects[0].size(); ++i) {
    truth.objects[0][i].position.x() = 1.0 + 0.01 * static_cast<double>((7 * i) % 20100);
  }
  std::string noted;
  const auto data = pageData("/nonexistent", {{0, 100.0, Pose::Identity(), {}, {}}}, truth, {},
                             [&](const auto& note) { noted += note; });
  EXPECT_EQ("100 true boxes are left out: at most the nearest 20000 of each frame are shown",
            noted);
  const auto& boxes = data["truth"]["objects"][0];
  ASSERT_EQ(20000U, boxes.size());
  EXPECT_EQ(100, boxes[0][0]);
  EXPECT_EQ(100 + 19999, boxes[19999][0]);
}

}  // namespace
}  // namespace headway::report
