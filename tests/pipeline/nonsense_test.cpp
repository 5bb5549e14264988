// SPDX-License-Identifier: BSD-3-Clause
// Faults of cameras, clocks and calibrations in the middle of the street: each is named within a
// second.
#include <gtest/gtest.h>
#include <headway/io/rawlog_source.h>
#include <headway/pipeline/perception.h>
#include <headway/stereo/rectification.h>
#include <headway_test/paths.h>

#include <functional>
#include <opencv2/imgproc.hpp>
#include <set>
#include <string>

namespace headway::pipeline {
namespace {

constexpr std::size_t kFault = 15;   // first frame with the fault
constexpr std::size_t kSecond = 10;  // frames

using Frames = std::vector<RecordedFrame>;

const Frames& street() {
  static const Frames kStreetFrames = [] {
    io::RawlogSourceOptions options;
    options.to_index = kFault + 3 * kSecond;
    io::RawlogSource source(std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/street.rawlog", options);
    Frames frames;
    while (auto frame = source.next()) frames.push_back(std::move(*frame));
    return frames;
  }();
  return kStreetFrames;
}

/// Replaces an image, whose pixels other frames share.
void fill(cv::Mat& image, double grey) {
  image = cv::Mat(image.size(), image.type(), cv::Scalar(grey));
}

cv::Mat warped(const cv::Mat& image, double down_px, double scale) {
  const cv::Point2f centre(0.5F * static_cast<float>(image.cols - 1),
                           0.5F * static_cast<float>(image.rows - 1));
  cv::Mat warp = cv::getRotationMatrix2D(centre, 0.0, scale);
  warp.at<double>(1, 2) += down_px;
  cv::Mat result;
  cv::warpAffine(image, result, warp, image.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return result;
}

/// As a camera sees it that is turned by 2 degrees about an axis.
cv::Mat turned(const StereoFrame& frame, const Eigen::Vector3d& axis) {
  return stereo::RightTurn(-2.0 * M_PI / 180.0 * axis, *frame.camera).undone(frame.right);
}

struct Fault {
  const char* name;
  const char* warning;
  std::function<void(const Frames& good, std::size_t i, RecordedFrame& frame)> apply;
  std::size_t first = kFault;  ///< frame from which it is to be seen
};

/// Frames within which a warning comes, as doc/reliability.md promises.
std::size_t framesOf(const std::string& warning) {
  static const std::set<std::string> at_once = {"camera_frozen",     "camera_dark",
                                                "camera_bright",     "clock_set_back",
                                                "clock_jumps_ahead", "time_repeated"};
  return at_once.count(warning) > 0 ? 1 : kSecond;
}

StereoFrame& stereoOf(RecordedFrame& frame) { return *frame.stereo; }

/// For the images alone, from the frame of the fault on.
const std::vector<Fault>& faults() {
  static const std::vector<Fault> kFaults = {
      {"Frozen", "camera_frozen",
       [](const Frames& good, std::size_t, RecordedFrame& frame) {
         stereoOf(frame).left = good[kFault - 1].stereo->left.clone();
         stereoOf(frame).right = good[kFault - 1].stereo->right.clone();
       }},
      {"RightLate", "images_not_simultaneous",
       [](const Frames& good, std::size_t i, RecordedFrame& frame) {
         stereoOf(frame).right = good[i - 1].stereo->right;
       }},
      {"RightEarly", "images_not_simultaneous",
       [](const Frames& good, std::size_t i, RecordedFrame& frame) {
         stereoOf(frame).right = good[i + 1].stereo->right;
       }},
      {"OffsetGrows", "vertical_offset",
       [](const Frames&, std::size_t i, RecordedFrame& frame) {
         const double down_px = 0.4 * static_cast<double>(i - kFault);
         stereoOf(frame).right = warped(stereoOf(frame).right, down_px, 1.0);
       },
       kFault + 5},  // 2 px
      {"Dark", "camera_dark",
       [](const Frames&, std::size_t, RecordedFrame& frame) {
         fill(stereoOf(frame).left, 0.0);
         fill(stereoOf(frame).right, 0.0);
       }},
      {"RightDark", "camera_dark",
       [](const Frames&, std::size_t, RecordedFrame& frame) { fill(stereoOf(frame).right, 0.0); }},
      {"Overexposed", "camera_bright",
       [](const Frames&, std::size_t, RecordedFrame& frame) {
         fill(stereoOf(frame).left, 255.0);
         fill(stereoOf(frame).right, 255.0);
       }},
      {"Swapped", "images_swapped",
       [](const Frames&, std::size_t, RecordedFrame& frame) {
         std::swap(stereoOf(frame).left, stereoOf(frame).right);
       }},
      {"CalibrationOfAnotherLens", "images_not_simultaneous",
       [](const Frames&, std::size_t, RecordedFrame& frame) {
         stereoOf(frame).right = warped(stereoOf(frame).right, 0.0, 1.04);
       }},
      {"RightPitches", "vertical_offset",
       [](const Frames&, std::size_t, RecordedFrame& frame) {
         stereoOf(frame).right = turned(stereoOf(frame), Eigen::Vector3d::UnitX());
       }},
      {"RightYawsInwards", "images_swapped",
       [](const Frames&, std::size_t, RecordedFrame& frame) {
         stereoOf(frame).right = turned(stereoOf(frame), -Eigen::Vector3d::UnitY());
       }},
      {"RightRolls", "images_not_simultaneous",
       [](const Frames&, std::size_t, RecordedFrame& frame) {
         stereoOf(frame).right = turned(stereoOf(frame), Eigen::Vector3d::UnitZ());
       }},
      {"TimeJumpsAhead", "clock_jumps_ahead",
       [](const Frames&, std::size_t, RecordedFrame& frame) {
         frame.time += 3600.0;
         stereoOf(frame).time += 3600.0;
       }},
      {"TimeComesAgain", "time_repeated",
       [](const Frames& good, std::size_t i, RecordedFrame& frame) {
         if (i == kFault) frame.time = stereoOf(frame).time = good[i - 1].time;
       }},
      {"TimeJumpsBack", "clock_set_back",
       [](const Frames&, std::size_t, RecordedFrame& frame) {
         frame.time -= 3600.0;
         stereoOf(frame).time -= 3600.0;
       }},
  };
  return kFaults;
}

PerceptionParams quickParams() {
  PerceptionParams params;
  params.detection.detector = "none";
  params.grid.period_s = 0.0;
  return params;
}

class NonsenseTest : public testing::TestWithParam<std::size_t> {};

TEST_P(NonsenseTest, IsNamedWithinASecond) {
  const Fault& fault = faults()[GetParam()];
  Perception perception(street().front().stereo->camera, quickParams());
  std::vector<std::string> lines;
  perception.setLog([&](LogLevel level, const std::string& text) {
    if (level == LogLevel::kWarn) lines.push_back(text);
  });
  for (std::size_t i = 0; i + 1 < street().size(); ++i) {
    RecordedFrame frame = street()[i];
    if (i >= kFault) fault.apply(street(), i, frame);
    (void)perception.process(frame);
    if (i + 1 == kFault) {
      EXPECT_TRUE(perception.warnings().empty()) << perception.warnings().begin()->first;
    }
  }
  ASSERT_EQ(1u, perception.warnings().count(fault.warning)) << testing::PrintToString(lines);
  const Warning& warning = perception.warnings().at(fault.warning);
  EXPECT_GE(warning.first_frame, kFault);
  EXPECT_LT(warning.first_frame, fault.first + framesOf(fault.warning));
  const std::string line = "frame " + std::to_string(warning.first_frame) + ": " + warning.text;
  EXPECT_EQ(1, std::count(lines.begin(), lines.end(), line)) << "said once";
}

INSTANTIATE_TEST_SUITE_P(Street, NonsenseTest, testing::Range<std::size_t>(0, 15),
                         [](const auto& index) { return faults()[index.param].name; });

/// Frames of the street with odometry that measures `step_m` in each, at most a second.
Warnings warningsWith(double step_m, double max_speed_mps) {
  PerceptionParams params = quickParams();
  params.slam.max_speed_mps = max_speed_mps;
  Perception perception(street().front().stereo->camera, params);
  for (std::size_t i = 0; i <= kSecond; ++i) {
    RecordedFrame frame = street()[i];
    Pose step = Pose::Identity();
    step.translation().x() = step_m;
    if (i > 0 && step_m > 0.0) stereoOf(frame).motion_prior.T_previous_current = step;
    (void)perception.process(frame);
  }
  return perception.warnings();
}

TEST(NonsenseAtTheStartTest, AScaleThatContradictsOdometryIsNamedWithinASecond) {
  EXPECT_EQ(1u, warningsWith(20.0, 70.0).count("odometry_scale"));
}

TEST(NonsenseAtTheStartTest, ASpeedBeyondTheRobotsIsNamedWithinASecond) {
  const auto warnings = warningsWith(0.0, 1.0);
  ASSERT_EQ(1u, warnings.count("speed"));
  EXPECT_LE(warnings.at("speed").first_frame, 3u);
  EXPECT_TRUE(warningsWith(0.0, 70.0).empty());
}

}  // namespace
}  // namespace headway::pipeline
