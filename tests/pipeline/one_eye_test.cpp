// SPDX-License-Identifier: BSD-3-Clause
// One of two cameras fails in mid-run: the pair is not to be trusted within a second of motion, nor
// for a second after.
#include <gtest/gtest.h>
#include <headway/io/rawlog_source.h>
#include <headway_test/paths.h>

#include <functional>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "input_health.h"

namespace headway::pipeline {
namespace {

using Frames = std::vector<RecordedFrame>;

constexpr std::size_t kStreetFrames = 56, kHallFrames = 81;  // 5.5 s of both

/// The first frames of a bundled recording, reduced.
Frames recorded(const std::string& name, std::size_t count, double scale) {
  io::RawlogSourceOptions options;
  options.to_index = count - 1;
  io::RawlogSource source(std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/" + name, options);
  Frames frames;
  auto camera = std::make_shared<StereoCamera>();
  while (auto frame = source.next()) {
    StereoFrame& pair = *frame->stereo;
    if (frames.empty()) *camera = *pair.camera;
    cv::resize(pair.left, pair.left, {}, scale, scale, cv::INTER_AREA);
    cv::resize(pair.right, pair.right, {}, scale, scale, cv::INTER_AREA);
    pair.camera = camera;
    frames.push_back(std::move(*frame));
  }
  for (double* length : {&camera->fx, &camera->fy}) *length *= scale;
  for (double* centre : {&camera->cx, &camera->cy}) *centre = (*centre + 0.5) * scale - 0.5;
  camera->width = frames.front().stereo->left.cols;
  camera->height = frames.front().stereo->left.rows;
  return frames;
}

/// Makes frame i of the recording one of a rig that fails at frame `begin`.
using Failure = std::function<void(const Frames&, std::size_t begin, std::size_t i, StereoFrame&)>;

/// Frames whose images are not to be trusted.
std::vector<bool> doubtedFrames(const Frames& frames, const Failure& fail, std::size_t begin,
                                std::size_t end) {
  InputHealth health(frames.front().stereo->camera, 70.0);
  PreviousFrame previous;
  const FrameRate rate;
  std::vector<bool> doubted;
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
    RecordedFrame frame = frames[i];
    if (i >= begin && i < end) fail(frames, begin, i, *frame.stereo);
    const FrameState state(frame, previous, rate);
    (void)health.checkFrame(state);
    doubted.push_back(health.imageEvidence() != slam::ImageEvidence::kNone);
    previous.index = frame.index;
    previous.time = frame.time;
  }
  return doubted;
}

struct Case {
  const char* name;
  Failure fail;
  double seconds;  ///< in which it is noticed
};

cv::Mat turned(const cv::Mat& image) {
  cv::Mat result;
  cv::flip(image, result, -1);
  return result;
}

const std::vector<Case>& cases() {
  static const std::vector<Case> kCases = {
      {"LeftFrozen",
       [](const Frames& good, std::size_t begin, std::size_t, StereoFrame& pair) {
         pair.left = good[begin - 1].stereo->left.clone();
       },
       0.0},
      {"RightFrozen",
       [](const Frames& good, std::size_t begin, std::size_t, StereoFrame& pair) {
         pair.right = good[begin - 1].stereo->right.clone();
       },
       0.0},
      {"RightIsLeft",
       [](const Frames&, std::size_t, std::size_t, StereoFrame& pair) { pair.right = pair.left; },
       0.0},
      {"RightBlack",
       [](const Frames&, std::size_t, std::size_t, StereoFrame& pair) {
         pair.right = cv::Mat(pair.right.size(), CV_8U, cv::Scalar(0));
       },
       0.0},
      {"RightLate",
       [](const Frames& good, std::size_t, std::size_t i, StereoFrame& pair) {
         pair.right = good[i - 1].stereo->right;
       },
       1.0},
      {"RightEarly",
       [](const Frames& good, std::size_t, std::size_t i, StereoFrame& pair) {
         pair.right = good[i + 1].stereo->right;
       },
       1.0},
      {"BothUpsideDown",
       [](const Frames&, std::size_t, std::size_t, StereoFrame& pair) {
         pair.left = turned(pair.left);
         pair.right = turned(pair.right);
       },
       1.0},
  };
  return kCases;
}

class OneEyeTest : public testing::TestWithParam<std::size_t> {
 protected:
  /// Lets the rig fail for 1.5 s from several moments on, while it moves.
  static void failIn(const Frames& frames, const std::vector<std::size_t>& moments) {
    const Case& tried = cases()[GetParam()];
    const double interval_s = frames[1].time - frames[0].time;
    const auto second = static_cast<std::size_t>(std::lround(1.0 / interval_s));
    for (const std::size_t begin : moments) {
      SCOPED_TRACE(std::to_string(frames[0].stereo->left.cols) + " px, from frame " +
                   std::to_string(begin));
      const std::size_t end = begin + second + second / 2;
      const auto doubted = doubtedFrames(frames, tried.fail, begin, end);
      for (std::size_t i = 0; i < begin; ++i) EXPECT_FALSE(doubted[i]) << i;
      const auto noticed =
          begin + static_cast<std::size_t>(std::lround(tried.seconds / interval_s));
      // The right image is no longer wrong in the frame after the last one that it was late in.
      for (std::size_t i = noticed; i + 1 < end + second; ++i) EXPECT_TRUE(doubted[i]) << i;
      EXPECT_FALSE(doubted[end + second + second / 2]);
    }
  }
};

TEST_P(OneEyeTest, IsNoticedInAStreetAtTwoSizes) {
  for (const double scale : {1.0, 0.5}) {
    failIn(recorded("street.rawlog", kStreetFrames, scale), {12, 25});
  }
}

TEST_P(OneEyeTest, IsNoticedInAHallAtTwoSizes) {
  for (const double scale : {1.0, 0.5})
    failIn(recorded("hall.rawlog", kHallFrames, scale), {30, 40});
}

INSTANTIATE_TEST_SUITE_P(Pairs, OneEyeTest, testing::Range<std::size_t>(0, 7),
                         [](const auto& index) { return cases()[index.param].name; });

}  // namespace
}  // namespace headway::pipeline
