// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway_test/repeats.h>
#include <headway_test/textured_world.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>

#include "loop_closer.h"

namespace headway::slam {
namespace {

/// Once round a square block of walls in a large hall, looking ahead, and on over the beginning.
Pose roundTheBlock(int i, int lap) {
  const double angle = 2.0 * M_PI * i / lap;
  Pose pose = Pose::Identity();
  pose.linear() = expSo3({0.0, 0.0, angle});
  pose.translation() << 4.0 * std::sin(angle), 4.0 - 4.0 * std::cos(angle), 0.0;
  return pose;
}

test::TexturedWorld hall() {
  test::TexturedWorld world(test::smallCamera(), 4);
  world.addRoom(16.0, 16.0, 4.0);
  using V = Eigen::Vector3d;  // a block in the middle of the way hides the other side
  const V low(-2.0, 2.0, -2.0);
  world.boards.push_back({low, V::UnitX(), V::UnitZ(), 4.0, 4.0, {1.1, 8.2}});
  world.boards.push_back({low + 4.0 * V::UnitY(), V::UnitX(), V::UnitZ(), 4.0, 4.0, {6.1, 5.2}});
  world.boards.push_back({low, V::UnitY(), V::UnitZ(), 4.0, 4.0, {2.1, 3.2}});
  world.boards.push_back({low + 4.0 * V::UnitX(), V::UnitY(), V::UnitZ(), 4.0, 4.0, {9.1, 7.2}});
  return world;
}

constexpr int kLap = 110;     ///< frames once round
constexpr int kFrames = 125;  ///< a little more than once round

/// The frames of the drive, rendered once for all tests.
const std::vector<StereoFrame>& framesRoundTheBlock() {
  static const std::vector<StereoFrame> frames = [] {
    const auto world = hall();
    std::vector<StereoFrame> rendered;
    for (int i = 0; i < kFrames; ++i) {
      rendered.push_back(world.frame(i, 0.1 * i, roundTheBlock(i, kLap)));
    }
    return rendered;
  }();
  return frames;
}

struct Lap {
  int loops = 0;
  double rmse_m = 0.0;
  std::vector<SlamUpdate> updates;
};

Lap driveRound(bool loop_closing, bool in_background = false) {
  SlamParams params;
  params.loop_closing = loop_closing;
  params.adjust_in_background = in_background;
  params.features = 250;
  StereoSlam slam(framesRoundTheBlock().front().camera, params);
  Lap lap;
  for (const StereoFrame& frame : framesRoundTheBlock()) {
    const auto update = slam.process(frame, {});
    lap.updates.push_back(update);
    EXPECT_EQ(update.status, TrackingStatus::kTracked) << frame.index;
    EXPECT_TRUE((update.T_map_odom * update.T_odom_robot).isApprox(update.T_map_robot, 1e-9));
    for (const LoopAttempt& attempt : update.loops) {
      const bool closed = attempt.outcome == LoopOutcome::kClosed;
      EXPECT_EQ(closed, attempt.inliers >= attempt.inliers_needed &&
                            attempt.offset_m <= attempt.offset_allowed_m)
          << "a rejection must be explained by a figure";
      lap.loops += closed ? 1 : 0;
      if (in_background) {
        EXPECT_TRUE(!closed || update.revision.cause == MapChange::kLoop)
            << "a loop comes with its correction";
      }
    }
    // A camera's interval, in which the threads beside the tracking go on; under sanitizers they
    // need ten times as long.
    constexpr std::chrono::milliseconds kInterval(test::kSanitized ? 300 : 30);
    if (in_background) std::this_thread::sleep_for(kInterval);
  }
  slam.finish();
  double sum = 0.0;
  for (const auto& estimate : slam.trajectory()) {
    const Pose truth = roundTheBlock(static_cast<int>(estimate.frame), kLap);
    sum += (estimate.T_map_robot.translation() - truth.translation()).squaredNorm();
  }
  lap.rmse_m = std::sqrt(sum / kFrames);
  return lap;
}

TEST(LoopCloserTest, FindsTheBeginningAgainAndPullsThePathTogether) {
  const Lap open = driveRound(false);
  const Lap closed = driveRound(true);
  EXPECT_EQ(open.loops, 0);
  EXPECT_GE(closed.loops, 1);
  EXPECT_LT(closed.rmse_m, 0.7 * open.rmse_m);
  for (std::size_t i = 0; i < open.updates.size(); ++i) {
    const SlamUpdate& a = open.updates[i];
    const SlamUpdate& b = closed.updates[i];
    EXPECT_EQ(a.T_odom_robot.matrix(), b.T_odom_robot.matrix()) << i;
    EXPECT_NE(a.revision.cause, MapChange::kLoop);
    const bool closes = std::any_of(b.loops.begin(), b.loops.end(), [](const auto& attempt) {
      return attempt.outcome == LoopOutcome::kClosed;
    });
    EXPECT_TRUE(!closes || b.revision.cause == MapChange::kLoop) << i;
  }
}

TEST(LoopCloserTest, ClosesTheLoopBesideTheTracking) {
  const Lap open = driveRound(false);
  const Lap closed = driveRound(true, true);
  EXPECT_GE(closed.loops, 1);
  EXPECT_LT(closed.rmse_m, 0.8 * open.rmse_m);
  // Where the camera looks along a wall that it touches, with fewer than 20 corners in view, it
  // moves as it is tracked in the map, whose adjustments come at other times.
  int like_open = 0;
  for (std::size_t i = 1; i < open.updates.size(); ++i) {
    const auto step = [i](const Lap& lap) -> Pose {
      return lap.updates[i - 1].T_odom_robot.inverse() * lap.updates[i].T_odom_robot;
    };
    const Pose difference = step(open).inverse() * step(closed);
    const double metres = difference.translation().norm();
    const double degrees = logSo3(difference.linear()).norm() * 180.0 / M_PI;
    like_open += metres < 0.002 && degrees < 0.02 ? 1 : 0;
    EXPECT_LT(metres, 0.1) << i;
    EXPECT_LT(degrees, 1.0) << i;
  }
  EXPECT_GE(like_open, kFrames * 8 / 10);
}

/// The camera is in a submap of its own, and what is in the first one stays as it was.
void expectApart(StereoSlam& slam, const MapView& before) {
  EXPECT_EQ(slam.submaps(), (std::vector<int>{0, 1}));
  for (const KeyframeView& keyframe : slam.map().keyframes) EXPECT_GE(keyframe.frame, 60U);
  std::set<LandmarkId> here;
  for (const LandmarkView& landmark : slam.map().landmarks) here.insert(landmark.id);
  EXPECT_FALSE(here.empty());
  const MapView first = slam.map(0);
  ASSERT_EQ(first.keyframes.size(), before.keyframes.size());
  for (std::size_t i = 0; i < before.keyframes.size(); ++i) {
    EXPECT_EQ(first.keyframes[i].T_map_robot.matrix(), before.keyframes[i].T_map_robot.matrix());
  }
  ASSERT_EQ(first.landmarks.size(), before.landmarks.size());
  for (std::size_t i = 0; i < before.landmarks.size(); ++i) {
    EXPECT_EQ(first.landmarks[i].position, before.landmarks[i].position);
    EXPECT_EQ(here.count(first.landmarks[i].id), 0U);
  }
}

/// The camera is covered while it is driven round the first corners, so that a new submap is
/// initialised with an arbitrary pose.
TEST(LoopCloserTest, MergesSubmapsWhereOneObservesTheOther) {
  constexpr int kJoinedBy = 122;
  SlamParams params;
  params.restart_after_s = 0.5;
  params.features = 250;
  StereoSlam slam(framesRoundTheBlock().front().camera, params);
  int joined = 0;
  MapView before;  // the first submap, as it was left
  for (int i = 0; i < kJoinedBy; ++i) {
    StereoFrame frame = framesRoundTheBlock()[static_cast<std::size_t>(i)];
    const bool covered = i >= 20 && i < 60;
    if (i == 20) before = slam.map();
    if (covered) frame.left = frame.right = cv::Mat(frame.left.size(), CV_8U, cv::Scalar(0));
    const auto update = slam.process(frame, {});
    for (const LoopAttempt& attempt : update.loops) {
      if (attempt.outcome != LoopOutcome::kClosed) continue;
      if (joined++ > 0) continue;
      EXPECT_TRUE(attempt.joins_submaps);
      EXPECT_EQ(update.revision.cause, MapChange::kSubmapJoined);
    }
    const bool is_apart = i >= 60 && joined == 0;
    EXPECT_EQ(update.status, covered    ? TrackingStatus::kLost
                             : is_apart ? TrackingStatus::kTrackedInNewSubmap
                                        : TrackingStatus::kTracked)
        << i;
    EXPECT_EQ(update.submap, is_apart ? 1 : 0) << i;
    if (i == 60) {
      EXPECT_EQ(update.revision.cause, MapChange::kNewSubmap);
    }
    if (is_apart && i % 10 == 0) expectApart(slam, before);
  }
  EXPECT_GE(joined, 1);
  EXPECT_EQ(slam.submaps(), std::vector<int>{0});
  EXPECT_EQ(slam.map().keyframes.front().frame, 0U);
  for (const auto& estimate : slam.trajectory()) {
    if (!estimate.tracked) continue;
    const Pose truth = roundTheBlock(static_cast<int>(estimate.frame), kLap);
    EXPECT_LT((estimate.T_map_robot.translation() - truth.translation()).norm(), 0.4)
        << estimate.frame;
  }
}

TEST(ApplyCorrectionTest, TakesLandmarksAlong) {
  SparseMap map;
  const KeyframeId a = map.addKeyframe(0, 0.0, Pose::Identity()).id;
  const LandmarkId landmark = map.addLandmark({1.0, 2.0, 3.0}, a, {}).id;
  Pose moved = Pose::Identity();
  moved.translation() << 5.0, 0.0, -1.0;
  moved.linear() = expSo3({0.0, M_PI / 2.0, 0.0});
  applyCorrection({{a, moved}}, map);
  EXPECT_LT((map.find(landmark)->position - moved * Eigen::Vector3d(1.0, 2.0, 3.0)).norm(), 1e-12);
  EXPECT_EQ(map.keyframe(a).T_map_cam.matrix(), moved.matrix());
}

}  // namespace
}  // namespace headway::slam
