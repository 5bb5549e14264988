// SPDX-License-Identifier: BSD-3-Clause
#include "anchored_trajectory.h"

#include <gtest/gtest.h>
#include <headway/core/error.h>

#include <vector>

#include "make_map_view.h"

namespace headway::slam {
namespace {

using Kind = TrajectoryRecord::Kind;

constexpr int kRunFrames = 1000;
constexpr int kFramesOfKeyframe = 10;

Pose poseAlong(double x) {
  return Pose(Eigen::Translation3d(x, 0.1 * x, 0.0) *
              Eigen::AngleAxisd(0.01 * x, Eigen::Vector3d::UnitY()));
}

TrajectoryReader readerOf(const std::vector<TrajectoryRecord>& records) {
  return [records, next = std::size_t{0}]() mutable -> std::optional<TrajectoryRecord> {
    if (next == records.size()) return std::nullopt;
    return records[next++];
  };
}

/// A run in which every keyframe but each fifth is removed soon after.
class AnchoredTrajectoryTest : public testing::Test {
 protected:
  void run(AnchoredTrajectory& trajectory) {
    trajectory.setLog([this](const TrajectoryRecord& record) { records_.push_back(record); });
    std::optional<KeyframeId> reference;
    for (int i = 0; i < kRunFrames; ++i) {
      if (i % kFramesOfKeyframe == kFramesOfKeyframe - 1) {
        const KeyframeId id = map_.addKeyframe(i, 0.1 * i, poseAlong(i)).id;
        if (reference && reference->value % 5 != 0) {
          trajectory.reassign(*reference, id, map_);
          map_.removeKeyframe(*reference);
        }
        reference = id;
      }
      trajectory.add(i, 0.1 * i, i % 7 != 0, poseAlong(i), reference, map_);
    }
  }

  [[nodiscard]] std::vector<FrameEstimate> all(const AnchoredTrajectory& trajectory) const {
    std::vector<FrameEstimate> estimates;
    trajectory.visit(map_, Pose::Identity(),
                     [&](const FrameEstimate& estimate) { estimates.push_back(estimate); });
    return estimates;
  }

  void expectRefused(const std::vector<TrajectoryRecord>& records) const {
    AnchoredTrajectory trajectory(100);
    EXPECT_THROW(trajectory.restore(readerOf(records), map_), InputError);
  }

  SparseMap map_;
  std::vector<TrajectoryRecord> records_;
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
  EXPECT_NEAR(trajectory.find(0, map_)->T_map_cam.translation().x(), 0.6, 1e-12);
  EXPECT_NEAR(trajectory.find(1, map_)->T_map_cam.translation().x(), 0.4, 1e-12);
}

TEST_F(AnchoredTrajectoryTest, ItsRecordsRestoreItInTheCorrectedMap) {
  for (const std::size_t in_memory : {10U, 5000U}) {
    map_ = SparseMap();
    records_.clear();
    AnchoredTrajectory trajectory(in_memory);
    run(trajectory);
    AnchoredTrajectory restored(40);
    restored.restore(readerOf(records_), map_);
    for (const auto& [id, keyframe] : map_.keyframes()) {  // a later correction
      map_.keyframe(id).T_map_cam = poseAlong(0.3) * keyframe.T_map_cam;
    }
    const auto expected = all(trajectory);
    const auto found = all(restored);
    ASSERT_EQ(expected.size(), static_cast<std::size_t>(kRunFrames));
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].frame, expected[i].frame);
      EXPECT_EQ(found[i].time, expected[i].time);
      EXPECT_EQ(found[i].tracked, expected[i].tracked);
      EXPECT_EQ(found[i].T_map_robot.matrix(), expected[i].T_map_robot.matrix()) << i;
    }
    const auto last = restored.find(kRunFrames - 1, map_);
    ASSERT_TRUE(last);
    EXPECT_EQ(last->T_map_cam.matrix(), trajectory.find(kRunFrames - 1, map_)->T_map_cam.matrix());
  }
}

TEST_F(AnchoredTrajectoryTest, ItsRecordsAndAViewOfTheMapGiveAllPoses) {
  AnchoredTrajectory trajectory(10);
  run(trajectory);
  for (const auto& [id, keyframe] : map_.keyframes()) {  // a later correction
    map_.keyframe(id).T_map_cam = poseAlong(0.3) * keyframe.T_map_cam;
  }
  const Pose T_robot_cam = poseAlong(-0.7);
  const Pose T_cam_robot = T_robot_cam.inverse(Eigen::Isometry);
  std::vector<FrameEstimate> expected;
  trajectory.visit(map_, T_cam_robot,
                   [&](const FrameEstimate& estimate) { expected.push_back(estimate); });
  records_.push_back({Kind::kGiven, kRunFrames, 7.0, true, {}, {}, stored(poseAlong(2.0))});
  expected.push_back({kRunFrames, 7.0, true, poseAlong(2.0)});
  std::size_t found = 0;
  visitTrajectory([this] { return readerOf(records_); }, makeMapView(map_, T_cam_robot),
                  T_robot_cam,
                  [&](const FrameEstimate& estimate) {
                    ASSERT_LT(found, expected.size());
                    const FrameEstimate& other = expected[found++];
                    EXPECT_EQ(estimate.frame, other.frame);
                    EXPECT_EQ(estimate.time, other.time);
                    EXPECT_EQ(estimate.tracked, other.tracked);
                    EXPECT_TRUE(estimate.T_map_robot.isApprox(other.T_map_robot, 1e-12));
                  });
  EXPECT_EQ(found, expected.size());
  map_.removeKeyframe(map_.keyframes().rbegin()->first);  // its frames have no pose any more
  std::size_t left = 0;
  visitTrajectory([this] { return readerOf(records_); }, makeMapView(map_, T_cam_robot),
                  T_robot_cam, [&](const FrameEstimate&) { ++left; });
  EXPECT_LT(left, found);
  EXPECT_GT(left, found / 2);
}

TEST_F(AnchoredTrajectoryTest, RecordsThatContradictEachOtherAreRefused) {
  const KeyframeId kept = map_.addKeyframe(0, 0.0, Pose::Identity()).id;
  const StoredPose pose = stored(Pose::Identity());
  const auto frame = [&](std::size_t index, KeyframeId reference) {
    return TrajectoryRecord{Kind::kFrame, index, 0.1, true, {}, reference, pose};
  };
  const auto move = [&](std::int64_t from, std::int64_t to) {
    return TrajectoryRecord{Kind::kMove, 0, 0.0, false, KeyframeId{from}, KeyframeId{to}, pose};
  };
  AnchoredTrajectory good(100);
  good.restore(readerOf({frame(0, {}), frame(1, KeyframeId{7}), move(7, 3), move(3, kept.value)}),
               map_);
  EXPECT_EQ(2U, all(good).size());
  expectRefused({frame(1, kept), frame(1, kept)});
  expectRefused({frame(1, KeyframeId{9})});
  expectRefused({move(7, 3), move(3, 7)});
  expectRefused({move(7, 7)});
  expectRefused({move(7, 3), move(7, kept.value)});
  expectRefused({move(7, 3), frame(1, KeyframeId{7})});
  expectRefused({TrajectoryRecord{Kind::kGiven, 1, 0.1, true, {}, {}, pose}});
  auto wrong = frame(1, kept);
  wrong.pose.values[3] = std::numeric_limits<double>::quiet_NaN();
  expectRefused({wrong});
}

}  // namespace
}  // namespace headway::slam
