// SPDX-License-Identifier: BSD-3-Clause
// What a host program hears of the pipeline, and may change in it.
#include <gmock/gmock.h>
#include <headway/pipeline/perception.h>
#include <headway_test/painted_street.h>

#include <opencv2/imgproc.hpp>

#include "input_health.h"

namespace headway::pipeline {
namespace {

using test::PaintedBox;
using test::PaintedStreet;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<PaintedBox> kBoxes = {{{3.5, 1.6, 16.0}, 1.8, 1.5, {0.0, 0.0, 0.0}, 12},
                                        {{-2.0, 1.6, 17.0}, 1.8, 1.5, {2.5, 0.0, 4.0}, 11}};

class PerceptionEventsTest : public ::testing::Test {
 protected:
  PerceptionEventsTest() {
    params_.detection.detector = "stereo_motion";
    perception_ = std::make_unique<Perception>(street_.camera(), params_);
    perception_->setLog(
        [this](LogLevel level, const std::string& text) { messages_[level].push_back(text); });
  }

  /// Processes a frame whose images were changed.
  PerceptionUpdate process(int i, const std::function<void(cv::Mat&)>& change = {}) {
    RecordedFrame frame;
    frame.index = static_cast<std::size_t>(i);
    frame.time = street_.timeOf(i);
    frame.stereo = street_.frame(i);
    if (change) {
      change(frame.stereo->left);
      change(frame.stereo->right);
    }
    return perception_->process(frame);
  }

  /// The warning about a camera that is lost by such images.
  std::string warningFor(const std::function<void(cv::Mat&)>& change) {
    for (int i = 0; i < 6; ++i) (void)process(i);
    for (int i = 6; i < 9; ++i) {
      EXPECT_EQ(slam::TrackingStatus::kLost, process(i, change).camera.status);
    }
    for (const auto& [name, warning] : perception_->warnings()) {
      if (name.rfind("lost_", 0) == 0) return name;
    }
    return "none";
  }

  PaintedStreet street_{kBoxes};
  PerceptionParams params_;
  std::unique_ptr<Perception> perception_;
  std::map<LogLevel, std::vector<std::string>> messages_;
};

TEST_F(PerceptionEventsTest, ALossInTheDarkIsExplainedAndItsEndIsLogged) {
  EXPECT_EQ("lost_too_dark", warningFor([](cv::Mat& image) { image.setTo(4); }));
  EXPECT_THAT(messages_[LogLevel::kWarn], Contains(HasSubstr("frame 6: the camera is lost: the "
                                                             "image is too dark; lengthen")));
  EXPECT_EQ(slam::TrackingStatus::kTracked, process(9).camera.status);
  EXPECT_THAT(messages_[LogLevel::kInfo],
              Contains(HasSubstr("frame 9: localised again after 3 lost frames, ")));
  EXPECT_THAT(messages_[LogLevel::kInfo].back(), HasSubstr(" m from keyframe "));
  EXPECT_EQ(3u, perception_->warnings().at("lost_too_dark").count);
}

TEST_F(PerceptionEventsTest, AMapThatGoesOnWhereOdometryLedIsNotCalledLocalised) {
  params_.slam.restart_after_s = 0.4;
  perception_ = std::make_unique<Perception>(street_.camera(), params_);
  std::vector<std::string> said;
  perception_->setLog([&](LogLevel, const std::string& text) { said.push_back(text); });
  for (int i = 0; i < 38; ++i) {
    RecordedFrame frame;
    frame.index = static_cast<std::size_t>(i);
    frame.time = street_.timeOf(i);
    frame.stereo = street_.frame(i);
    for (cv::Mat* image : {&frame.stereo->left, &frame.stereo->right}) {
      const bool is_covered = i < 3 || (i >= 25 && i < 28);
      if (is_covered) image->setTo(4);
      if (i >= 28) cv::flip(*image, *image, 0);  // the map has no such place
    }
    if (i > 0) {
      const Pose before = street_.T_map_robot(i - 1);
      frame.stereo->motion_prior.T_previous_current = before.inverse() * street_.T_map_robot(i);
    }
    (void)perception_->process(frame);
  }
  EXPECT_THAT(
      said,
      Contains(HasSubstr("frame 3: the map begins after 3 frames that could not be localised")));
  EXPECT_THAT(said, Contains(HasSubstr("the map goes on where odometry led in ")));
  EXPECT_THAT(said, Not(Contains(HasSubstr("localised again"))));
}

TEST_F(PerceptionEventsTest, ACoveredLensIsRecognised) {
  EXPECT_EQ("lost_covered", warningFor([](cv::Mat& image) { image = image / 200 + 90; }));
}

TEST_F(PerceptionEventsTest, SurfacesWithoutTextureAreRecognised) {
  std::uint64_t seed = 0;
  EXPECT_EQ("lost_few_features", warningFor([&](cv::Mat& image) {
              image.setTo(80);
              image.colRange(0, image.cols / 2).setTo(140);
              cv::Mat noise(image.size(), CV_8U);
              cv::RNG random(++seed);  // the same image again is a frozen camera
              random.fill(noise, cv::RNG::NORMAL, 8, 4);
              image += noise;
            }));
}

/// Reason by an image after ten frames of a street.
std::string reasonOf(const std::function<void(cv::Mat&)>& change) {
  const PaintedStreet street(kBoxes);
  CameraCheck check;
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(check.addTracked(street.frame(i), 200));
  StereoFrame frame = street.frame(10);
  change(frame.left);
  return check.lossOf(frame).name;
}

TEST(LostReasonTest, BlurIsRecognisedByMotionOrFocus) {
  EXPECT_EQ("lost_blurred",
            reasonOf([](cv::Mat& image) { cv::blur(image, image, cv::Size(9, 9)); }));
  EXPECT_EQ("lost_blurred",
            reasonOf([](cv::Mat& image) { cv::blur(image, image, cv::Size(25, 3)); }));
}

/// A wall of squares, blurred by a motion along rows and with the noise of a Kinect.
cv::Mat wallOfSquares(int blur_px, int seed) {
  cv::Mat image(480, 640, CV_8U), noise(480, 640, CV_16S);
  cv::RNG squares(3), random(static_cast<std::uint64_t>(seed));
  for (int v = 0; v < 480; v += 24) {
    for (int u = 0; u < 640; u += 24)
      image(cv::Rect(u, v, 24, 24) & cv::Rect(0, 0, 640, 480)) = squares.uniform(60, 200);
  }
  cv::GaussianBlur(image, image, {}, 0.7);
  if (blur_px > 0) cv::blur(image, image, {blur_px, 1});
  random.fill(noise, cv::RNG::NORMAL, 0, 3);
  cv::add(image, noise, image, cv::noArray(), CV_8U);
  return image;
}

TEST(LostReasonTest, BlurWithTheNoiseOfACameraIsNoBareWall) {
  CameraCheck check;
  StereoFrame frame;
  for (int i = 0; i < 30; ++i) {
    frame.index = static_cast<std::size_t>(i);
    frame.time = i / 30.0;
    frame.left = wallOfSquares(i < 10 ? 0 : 9, i);
    const auto finding = check.addTracked(frame, i == 20 ? 60 : 200);
    ASSERT_EQ(i == 20, finding.has_value()) << i;
    if (finding) {
      EXPECT_EQ("blurred", finding->name);
      EXPECT_THAT(finding->text, HasSubstr("60 landmarks are tracked where 200 are usual"));
    }
  }
  frame.left = wallOfSquares(15, 30);
  EXPECT_EQ("lost_blurred", check.lossOf(frame).name);
  EXPECT_THAT(check.lossOf(frame).text, HasSubstr("times as wide as usual"));
  frame.left = wallOfSquares(0, 31);
  EXPECT_EQ("lost_moved_too_fast", check.lossOf(frame).name);
}

TEST(LostReasonTest, AUsableImageShowsAnotherView) {
  EXPECT_EQ("lost_moved_too_fast",
            reasonOf([](cv::Mat& image) { cv::rotate(image, image, cv::ROTATE_180); }));
  EXPECT_EQ("lost_moved_too_fast", reasonOf([](cv::Mat& image) { image = image / 2; }))
      << "less light alone is no blur";
}

TEST_F(PerceptionEventsTest, CallbacksBringPoseTracksAndMapOfEachFrame) {
  std::vector<std::string> order;
  PerceptionCallbacks callbacks;
  callbacks.on_pose = [&](Time, const slam::SlamUpdate& camera) {
    EXPECT_EQ(slam::TrackingStatus::kTracked, camera.status);
    order.push_back("pose");
  };
  callbacks.on_tracks = [&](Time, const std::vector<Track>&) { order.push_back("tracks"); };
  callbacks.on_map = [&](const map::PerceptionMap& map) {
    EXPECT_GT(map.landmarks().size(), 0u);
    order.push_back("map");
  };
  perception_->setCallbacks(callbacks);
  (void)process(0);
  EXPECT_THAT(order, ::testing::ElementsAre("pose", "tracks", "map"));
  for (int i = 1; i < 6; ++i) (void)process(i);
  EXPECT_EQ(6, std::count(order.begin(), order.end(), "pose"));
  EXPECT_EQ(6, std::count(order.begin(), order.end(), "tracks"));
}

TEST_F(PerceptionEventsTest, EveryFrameIsLoggedForDebugging) {
  (void)process(0);
  ASSERT_FALSE(messages_[LogLevel::kDebug].empty());
  EXPECT_THAT(messages_[LogLevel::kDebug].back(), HasSubstr("frame 0: tracked, "));
  EXPECT_THAT(messages_[LogLevel::kDebug].back(), HasSubstr("keyframe"));
}

TEST_F(PerceptionEventsTest, TheGroundIsScannedInTheSamePeriodAtAnyRate) {
  for (const auto& [hz, scans] : {std::pair(10.0, 4U), {30.0, 2U}}) {
    Perception perception(street_.frame(0).camera, params_);
    for (int i = 0; i < 12; ++i) {
      RecordedFrame frame;
      frame.index = static_cast<std::size_t>(i);
      frame.stereo = street_.frame(i);
      frame.time = frame.stereo->time = i / hz;
      (void)perception.process(frame);
    }
    EXPECT_EQ(perception.times().summary().at("grid").count, scans) << hz;
    EXPECT_NEAR(perception.rig()->rate_hz, hz, 1e-2);
  }
}

TEST_F(PerceptionEventsTest, ParametersChangeBeforeTheNextFrame) {
  params_.detection.detector = "hog";
  perception_ = std::make_unique<Perception>(street_.camera(), params_);
  for (int i = 0; i < 6; ++i) (void)process(i);
  const auto detected = [this] { return perception_->times().summary().at("detect").count; };
  const auto scanned = [this] { return perception_->times().summary().at("grid").count; };
  const auto detected_before = detected();
  const auto scanned_before = scanned();
  RuntimeParams params;
  params.detect_period_s = 100.0;
  params.grid_period_s = 0.0;
  perception_->change(params);
  for (int i = 6; i < 10; ++i) (void)process(i);
  EXPECT_EQ(detected_before, detected());
  EXPECT_EQ(scanned_before, scanned());
  params.detect_period_s = -1.0;
  EXPECT_ANY_THROW(perception_->change(params));
}

}  // namespace
}  // namespace headway::pipeline
