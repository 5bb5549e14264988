// SPDX-License-Identifier: BSD-3-Clause
// A recording with wide steps of the camera from frame to frame.
#include <gtest/gtest.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/trajectory_file.h>
#include <headway/pipeline/perception.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "replay_run.h"

namespace headway {
namespace {

constexpr double kMaxTurnError = 0.0175;  ///< one degree [rad]

class WideStepsTest : public ::testing::TestWithParam<int> {
 protected:
  explicit WideStepsTest(const std::string& recording = "hall")
      : recording_(std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/" + recording),
        truth_(io::readTum(recording_ + ".truth/trajectory.tum")) {}

  void thin() const {
    const auto thinned =
        test::runProcess(test::program("headway-import") + " rawlog -q " + recording_ +
                         ".rawlog --every " + std::to_string(GetParam()) + " -o " + rawlog());
    ASSERT_EQ(0, thinned.status) << thinned.output;
  }

  [[nodiscard]] std::string rawlog() const { return folder_ / "in.rawlog"; }

  [[nodiscard]] const Pose& trueAt(Time time) const {
    return std::min_element(truth_.begin(), truth_.end(),
                            [&](const auto& a, const auto& b) {
                              return std::abs(a.time - time) < std::abs(b.time - time);
                            })
        ->value;
  }

  /// What an estimated motion lacks to the true one, in the robot's axes.
  [[nodiscard]] Pose errorOf(const Stamped<Pose>& first, const Stamped<Pose>& now) const {
    const Pose moved = trueAt(first.time).inverse(Eigen::Isometry) * trueAt(now.time);
    const Pose estimated = first.value.inverse(Eigen::Isometry) * now.value;
    return moved.inverse(Eigen::Isometry) * estimated;
  }

  std::string recording_;
  std::vector<Stamped<Pose>> truth_;
  test::TemporaryFolder folder_;
};

class WideStepsInALoopTest : public WideStepsTest {
 protected:
  WideStepsInALoopTest() : WideStepsTest("hall_loop") {}
};

TEST_P(WideStepsTest, KeepTheHeadingOfEachFrameThatIsCalledTracked) {
  thin();
  const auto run = test::replay(rawlog(), folder_ / "out", "--snapshots 0 --detector none");
  ASSERT_EQ(0, run.process.status) << run.process.output;
  EXPECT_LE(run.summary.at("frames_lost"), GetParam() < 5 ? 0 : 3);
  EXPECT_EQ(0, run.summary.at("frames_tracked_in_new_submap"));
  const auto path = io::readTum(run.file("trajectory_online.tum"));
  ASSERT_GT(path.size(), 20U);
  for (const auto& at : path) {
    EXPECT_LT(logSo3(errorOf(path.front(), at).linear()).norm(), kMaxTurnError) << at.time;
  }
}

/// Doors and windows come again every few metres; odometry knows that it cannot have got there.
TEST_P(WideStepsInALoopTest, LeaveNoFrameThatIsCalledTrackedWhereItLooksAlike) {
  thin();
  io::RawlogSource source(rawlog(), {});
  pipeline::PerceptionParams params;
  params.detection.detector = "none";
  pipeline::Perception perception(source.camera(), params);
  std::optional<Stamped<Pose>> first;
  int tracked = 0;
  while (auto frame = source.next()) {
    const auto update = perception.process(*frame);
    const Stamped<Pose> now{frame->time, update.camera.T_map_robot};
    if (!first) first = now;
    if (update.camera.status != slam::TrackingStatus::kTracked) continue;
    ++tracked;
    EXPECT_LT(errorOf(*first, now).translation().norm(), 0.3) << frame->index;
  }
  EXPECT_GT(tracked, 30);
}

INSTANTIATE_TEST_SUITE_P(Bundled, WideStepsInALoopTest, ::testing::Values(4, 6));

/// What is said of the pose of a camera that sees nothing in the middle of its turn, and afterwards
/// until it is found, is true; and its headings are right before, and again from where it sees on.
TEST_P(WideStepsTest, CoveredInTheTurnItIsAsFarOffAsItIsSaidToBe) {
  const std::size_t begin = 20 / static_cast<std::size_t>(GetParam()), end = begin + 3;
  thin();
  io::RawlogSource source(rawlog(), {});
  pipeline::PerceptionParams params;
  params.detection.detector = "none";
  pipeline::Perception perception(source.camera(), params);
  std::optional<Stamped<Pose>> first, first_apart;
  std::size_t lost = 0, apart = 0;
  while (auto frame = source.next()) {
    const bool is_covered = frame->index >= begin && frame->index < end;
    if (is_covered) {
      StereoFrame& pair = *frame->stereo;
      pair.left = pair.right = cv::Mat(pair.left.size(), CV_8U, cv::Scalar(9));
    }
    const auto update = perception.process(*frame);
    const Stamped<Pose> now{frame->time, update.camera.T_map_robot};
    if (!first) first = now;
    const Pose error = errorOf(*first, now);
    const slam::TrackingStatus status = update.camera.status;
    if (is_covered) {
      EXPECT_EQ(slam::TrackingStatus::kLost, status) << frame->index;
    }
    if (status == slam::TrackingStatus::kTracked) {
      EXPECT_LT(logSo3(error.linear()).norm(), kMaxTurnError) << frame->index;
      continue;
    }
    if (status == slam::TrackingStatus::kTrackedInNewSubmap) {
      ++apart;
      if (!first_apart) first_apart = now;
      EXPECT_LT(logSo3(errorOf(*first_apart, now).linear()).norm(), kMaxTurnError) << frame->index;
    } else {
      ++lost;
    }
    Eigen::Matrix<double, 6, 1> off;
    off << error.translation(), logSo3(error.linear());
    const Eigen::Matrix<double, 6, 1> sigma = update.camera.covariance.diagonal().cwiseSqrt();
    for (int i = 0; i < 6; ++i) {
      EXPECT_LE(std::abs(off[i]), 3.0 * sigma[i]) << frame->index << ", state " << i;
    }
  }
  EXPECT_GE(lost, 3U);
  EXPECT_LE(lost, 5U);
  // At every third and fourth frame it sees what it knows before it has turned away.
  EXPECT_EQ(GetParam() > 4, apart > 0);
}

INSTANTIATE_TEST_SUITE_P(Bundled, WideStepsTest, ::testing::Values(3, 4, 5, 6));

}  // namespace
}  // namespace headway
