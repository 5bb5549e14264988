// SPDX-License-Identifier: BSD-3-Clause
#include "segment_follower.h"

#include <gtest/gtest.h>

#include "drive.h"

namespace headway::detect {
namespace {

constexpr int kFrames = 7;
using test::kUp;

/// A walker 12 m ahead who crosses at 1.4 m/s, seen by a camera that stands.
UprightSegment walkerIn(int frame, double speed, const StereoCamera& camera) {
  UprightSegment segment;
  segment.uvd = *project({-0.5 + speed * test::kFrameStep * frame, 0.3, 12.0}, camera);
  segment.width_px = frame % 2 == 0 ? 60.0 : 24.0;  // legs
  segment.cells.push_back({{0, 0}, *triangulate(segment.uvd, camera)});
  return segment;
}

struct Followed {
  test::Drive drive;
  SegmentFollower follower{drive.camera};

  /// @param cut  frame in which his flow alone tells the walker from what stands beside him
  Followed(double speed, int cut) {
    for (int frame = 0; frame < kFrames; ++frame) {
      drive.path.advance(test::kFrameStep * frame, Pose::Identity());
      UprightSegment segment = walkerIn(frame, speed, drive.camera);
      if (frame == cut) {
        segment.cut_by_flow = true;
        segment.uvd.x() += 8.0;  // the middle of what is seen of him
      }
      follower.follow({segment}, drive.path, kUp);
    }
  }

  /// By its outline [m/s].
  [[nodiscard]] double speed() {
    return SegmentFollower::outlineMotion(follower.tracks()[0]).value().velocity.norm();
  }
};

TEST(SegmentFollowerTest, DistinguishesAWalkerFromAPostByTheirOutlines) {
  Followed walker(1.4, -1);
  ASSERT_EQ(walker.follower.tracks().size(), 1u);
  EXPECT_NEAR(walker.speed(), 1.4, 0.2);
  Followed post(0.0, -1);
  EXPECT_LT(post.speed(), 0.2);
}

TEST(SegmentFollowerTest, GoesOnThroughAFrameInWhichTheSegmentIsCutByItsFlow) {
  Followed walker(1.4, 4);
  ASSERT_EQ(walker.follower.tracks().size(), 1u);
  const auto& track = walker.follower.tracks()[0];
  EXPECT_EQ(track.track.observations.size(), kFrames - 1u) << "all but the one that tells nothing";
  EXPECT_EQ(track.last_frame, kFrames - 1);
  EXPECT_NEAR(walker.speed(), 1.4, 0.2);
}

TEST(SegmentFollowerTest, WhereTheFlowEndsIsNoOutline) {
  Followed post(0.0, 4);
  ASSERT_EQ(post.follower.tracks().size(), 1u);
  EXPECT_LT(post.speed(), 0.2);
}

TEST(SegmentFollowerTest, StereosErrorsOfDistanceDoNotBreakATrack) {
  // 24 m off an error of one pixel of disparity is 1.5 m along the line of sight.
  for (const bool along : {true, false}) {
    test::Drive drive;
    SegmentFollower follower{drive.camera};
    for (int frame = 0; frame < 2; ++frame) {
      drive.path.advance(test::kFrameStep * frame, Pose::Identity());
      Eigen::Vector3d place(-0.5, 0.3, 24.0);
      (along ? place.z() : place.x()) += 1.4 * frame;
      UprightSegment segment = walkerIn(frame, 0.0, drive.camera);
      segment.uvd = *project(place, drive.camera);
      follower.follow({segment}, drive.path, kUp);
    }
    EXPECT_EQ(follower.tracks().size(), along ? 1u : 2u);
  }
}

TEST(SegmentFollowerTest, ASegmentIsMissedForTheSameTimeAtEveryRate) {
  for (const double rate_hz : {5.0, 10.0, 15.0, 30.0}) {
    test::Drive drive;
    SegmentFollower follower{drive.camera};
    int frame = 0;
    for (; frame < 4; ++frame) {
      drive.path.advance(frame / rate_hz, Pose::Identity());
      follower.follow({walkerIn(frame, 0.0, drive.camera)}, drive.path, kUp);
    }
    for (; !follower.tracks().empty() && frame < 100; ++frame) {
      drive.path.advance(frame / rate_hz, Pose::Identity());
      follower.follow({}, drive.path, kUp);
    }
    const double missed_s = (frame - 4) / rate_hz;
    EXPECT_GT(missed_s, 0.3) << rate_hz << " Hz";
    EXPECT_LE(missed_s, 0.35 + 1.0 / rate_hz) << rate_hz << " Hz";
  }
}

TEST(SegmentFollowerTest, ASegmentOfTheFrameBeforeIsFollowedAtAnyRate) {
  test::Drive drive;
  SegmentFollower follower{drive.camera};
  for (int frame = 0; frame < 3; ++frame) {
    drive.path.advance(0.5 * frame, Pose::Identity());
    follower.follow({walkerIn(0, 0.0, drive.camera)}, drive.path, kUp);
  }
  ASSERT_EQ(1U, follower.tracks().size());
  EXPECT_EQ(3U, follower.tracks()[0].track.observations.size());
}

TEST(SegmentFollowerTest, OverlappingFlowsCountOnce) {
  test::Drive drive;
  SegmentFollower follower{drive.camera};
  for (int frame = 0; frame < 10; ++frame) {  // at 30 Hz, each flow over 0.1 s
    drive.path.advance(frame / 30.0, Pose::Identity());
    UprightSegment segment = walkerIn(frame % 2, 0.0, drive.camera);
    segment.across = LateralSpeed{0.5, 0.1, 0.1};
    follower.follow({segment}, drive.path, kUp);
  }
  ASSERT_EQ(1U, follower.tracks().size());
  EXPECT_LE(follower.tracks()[0].across.size(), 5U) << "in 0.3 s, half overlapping at most";
}

TEST(SegmentFollowerTest, ASegmentThatIsNotObservedAgainIsRemoved) {
  Followed walker(1.4, -1);
  for (int frame = kFrames; frame < kFrames + 5; ++frame) {
    walker.drive.path.advance(test::kFrameStep * frame, Pose::Identity());
    walker.follower.follow({}, walker.drive.path, kUp);
  }
  EXPECT_TRUE(walker.follower.tracks().empty());
}

}  // namespace
}  // namespace headway::detect
