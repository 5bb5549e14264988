// SPDX-License-Identifier: BSD-3-Clause
// A camera that starts in a stored map, most of whose view is covered.
#include <gtest/gtest.h>
#include <headway/slam/stereo_slam.h>
#include <headway_test/paths.h>

#include <opencv2/imgproc.hpp>
#include <string>

#include "failing_rig.h"

namespace headway::pipeline {
namespace {

constexpr int kDisparity_px = 24;  // of what covers the view

/// Six tenths of both images are those of another world, near and flat.
StereoFrame covered(StereoFrame frame, const StereoFrame& by) {
  frame.left = frame.left.clone();
  frame.right = frame.right.clone();
  const int width = 6 * frame.left.cols / 10;
  const cv::Rect here(kDisparity_px, 0, width, frame.left.rows);
  const cv::Rect in_right(0, 0, width, frame.left.rows);
  cv::Mat image;
  cv::resize(by.left, image, frame.left.size());
  image(here).copyTo(frame.left(here));
  image(here).copyTo(frame.right(in_right));
  return frame;
}

/// The beginning of a bundled recording.
Frames recorded(const std::string& name, std::size_t count) {
  return recordedFrames(std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/" + name, count, 320);
}

TEST(CoveredViewTest, APlaceIsFoundBehindWhatCoversSixTenthsOfIt) {
  constexpr std::size_t kStarts = 6, kFrames = 30, kStep = 12;
  const auto frames = recorded("hall.rawlog", 150);
  const auto others = recorded("street.rawlog", 100);
  slam::SlamParams params;
  slam::StereoSlam first(frames.front().stereo->camera, params);
  for (const auto& frame : frames) static_cast<void>(first.process(*frame.stereo, {}));
  const auto mapped = first.trajectory();
  ASSERT_EQ(frames.size(), mapped.size());
  const std::string saved = first.save();
  params.mapping = false;
  std::size_t found = 0;
  for (std::size_t start = 0; start < kStarts * kStep; start += kStep) {
    slam::StereoSlam slam(frames.front().stereo->camera, params);
    slam.load(saved);
    for (std::size_t i = start; i < start + kFrames; ++i) {
      const auto& other = *others[i % others.size()].stereo;
      const auto update = slam.process(covered(*frames[i].stereo, other), {});
      if (!isTracked(update.status)) continue;
      ++found;
      const Pose T_found_mapped =
          update.T_map_robot.inverse(Eigen::Isometry) * mapped[i].T_map_robot;
      EXPECT_LT(T_found_mapped.translation().norm(), 0.1) << start;
      break;
    }
  }
  EXPECT_EQ(kStarts, found) << "the one of frame 36 by a keyframe that is not most alike";
}

}  // namespace
}  // namespace headway::pipeline
