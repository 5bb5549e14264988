// SPDX-License-Identifier: BSD-3-Clause
#include "anchored_trajectory.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace headway::slam {
namespace {

constexpr int kRunFrames = 1000;
constexpr int kFramesOfKeyframe = 10;

Pose poseAlong(double x) {
  return Pose(Eigen::Translation3d(x, 0.1 * x, 0.0) *
              Eigen::AngleAxisd(0.01 * x, Eigen::Vector3d::UnitY()));
}

std::vector<FrameEstimate> allOf(const TrajectoryVisit& visit) {
  std::vector<FrameEstimate> estimates;
  visit([&](const FrameEstimate& estimate) { estimates.push_back(estimate); });
  return estimates;
}

/// A run in which every keyframe but each fifth is removed soon after.
class AnchoredTrajectoryTest : public testing::Test {
 protected:
  /// Adds frames from `next_` on.
  void run(AnchoredTrajectory& trajectory, int frames = kRunFrames) {
    for (const int end = next_ + frames; next_ < end; ++next_) {
      if (next_ % kFramesOfKeyframe == kFramesOfKeyframe - 1) {
        const KeyframeId id = map_.addKeyframe(next_, 0.1 * next_, poseAlong(next_)).id;
        if (reference_ && reference_->value % 5 != 0) {
          trajectory.reassign(*reference_, id, map_);
          map_.removeKeyframe(*reference_);
        }
        reference_ = id;
      }
      trajectory.add(next_, 0.1 * next_, next_ % 7 != 0, poseAlong(next_), reference_, map_);
    }
  }

  [[nodiscard]] std::vector<FrameEstimate> all(const AnchoredTrajectory& trajectory) const {
    return allOf(trajectory.snapshot(map_, Pose::Identity()));
  }

  SparseMap map_;
  std::optional<KeyframeId> reference_;
  int next_ = 0;
};

TEST_F(AnchoredTrajectoryTest, FramesFollowTheScaleOfTheirKeyframes) {
  AnchoredTrajectory trajectory(2 * kRunFrames);
  Pose way = Pose::Identity();
  const KeyframeId first = map_.addKeyframe(0, 0.0, way).id;
  const KeyframeId second = map_.addKeyframe(1, 0.1, way).id;
  way.translation() << 0.4, 0.0, 0.0;
  trajectory.add(0, 0.0, true, way, first, map_);
  trajectory.add(1, 0.1, true, way, second, map_);
  trajectory.scale({{first, 1.5}});
  const auto frames = all(trajectory);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_NEAR(frames[0].T_map_robot.translation().x(), 0.6, 1e-12);
  EXPECT_NEAR(frames[1].T_map_robot.translation().x(), 0.4, 1e-12);
}

TEST_F(AnchoredTrajectoryTest, FramesBeforeAKeyframeFollowItsAdjustmentByTime) {
  AnchoredTrajectory trajectory(100);
  const KeyframeId older = map_.addKeyframe(0, 0.0, poseAlong(0.0)).id;
  const KeyframeId before = map_.addKeyframe(1, 0.1, poseAlong(0.1)).id;
  trajectory.add(0, 0.0, true, poseAlong(0.0), older, map_);
  for (const int i : {1, 2, 3, 4}) {
    trajectory.add(static_cast<std::size_t>(i), 0.1 * i, true, poseAlong(0.1 * i), before, map_);
  }
  const Pose T_before_map = poseAlong(0.1).inverse();
  const Pose tracked = T_before_map * poseAlong(0.5);
  trajectory.followAdjustment(before, tracked, T_before_map * poseAlong(0.9), 0.5);
  const auto frames = all(trajectory);
  ASSERT_EQ(frames.size(), 5U);
  for (int i = 0; i < 5; ++i) {
    const double moved = i < 2 ? 0.0 : 0.1 * (i - 1);  // up to 0.4 at the keyframe
    const auto& at = frames[static_cast<std::size_t>(i)].T_map_robot;
    EXPECT_NEAR(at.translation().x(), 0.1 * i + moved, 2e-3) << i;
    EXPECT_NEAR(logSo3(at.linear()).y(), 0.01 * (0.1 * i + moved), 1e-5) << i;
  }
}

TEST_F(AnchoredTrajectoryTest, AFrameThatStoodLongBeforeDoesNotFollow) {
  AnchoredTrajectory trajectory(100);
  const KeyframeId before = map_.addKeyframe(0, 0.0, Pose::Identity()).id;
  for (const double time : {0.0, 8.5, 9.0}) {
    trajectory.add(0, time, true, Pose::Identity(), before, map_);
  }
  trajectory.followAdjustment(before, Pose::Identity(), poseAlong(0.3), 10.0);
  const auto frames = all(trajectory);
  EXPECT_EQ(frames[0].T_map_robot.translation().x(), 0.0);
  EXPECT_EQ(frames[1].T_map_robot.translation().x(), 0.0);
  EXPECT_NEAR(frames[2].T_map_robot.translation().x(), 0.1, 1e-9);
}

TEST_F(AnchoredTrajectoryTest, FramesFollowTheCorrectionOfTheMap) {
  for (const std::size_t in_memory : {10U, 5000U}) {
    map_ = SparseMap();
    reference_.reset();
    next_ = 0;
    AnchoredTrajectory trajectory(in_memory);
    run(trajectory);
    const Pose correction = poseAlong(0.3);
    for (const auto& [id, keyframe] : map_.keyframes()) {
      map_.keyframeToChange(id).T_map_cam = correction * keyframe.T_map_cam;
    }
    const auto found = all(trajectory);
    ASSERT_EQ(found.size(), static_cast<std::size_t>(kRunFrames));
    for (int i = 0; i < kRunFrames; ++i) {
      const FrameEstimate& frame = found[static_cast<std::size_t>(i)];
      EXPECT_EQ(frame.frame, static_cast<std::size_t>(i));
      EXPECT_EQ(frame.time, 0.1 * i);
      EXPECT_EQ(frame.tracked, i % 7 != 0);
      // The frames before the first keyframe are in the map frame itself.
      const Pose expected = i < kFramesOfKeyframe - 1 ? poseAlong(i) : correction * poseAlong(i);
      EXPECT_TRUE(frame.T_map_robot.isApprox(expected, 1e-9)) << i;
    }
  }
}

TEST_F(AnchoredTrajectoryTest, AFrameWithoutItsKeyframeIsLeftOut) {
  AnchoredTrajectory trajectory(10);
  run(trajectory);
  const std::size_t before = all(trajectory).size();
  map_.removeKeyframe(map_.keyframes().rbegin()->first);
  EXPECT_LT(all(trajectory).size(), before);
  EXPECT_GT(all(trajectory).size(), before / 2);
}

TEST_F(AnchoredTrajectoryTest, ASnapshotIsReadInAnotherThreadWhileTheRunGoesOn) {
  AnchoredTrajectory trajectory(10);
  run(trajectory);
  const auto expected = all(trajectory);
  const auto snapshot = trajectory.snapshot(map_, Pose::Identity());
  std::vector<FrameEstimate> found;
  std::thread reader([&] { found = allOf(snapshot); });
  run(trajectory);
  for (const auto& [id, keyframe] : map_.keyframes()) {
    map_.keyframeToChange(id).T_map_cam = poseAlong(0.3) * keyframe.T_map_cam;
  }
  reader.join();
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].frame, expected[i].frame);
    EXPECT_EQ(found[i].T_map_robot.matrix(), expected[i].T_map_robot.matrix()) << i;
  }
  EXPECT_EQ(all(trajectory).size(), 2U * kRunFrames);
}

}  // namespace
}  // namespace headway::slam
