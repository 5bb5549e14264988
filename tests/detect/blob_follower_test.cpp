#include "blob_follower.h"

#include <gtest/gtest.h>

#include "drive.h"

namespace headway::detect {
namespace {

constexpr int kFrames = 7;
const Eigen::Vector3d kUp(0.0, -1.0, 0.0);

/// A walker 12 m ahead who crosses at 1.4 m/s, seen by a camera that stands.
UprightBlob walkerIn(int frame, double speed, const StereoCamera& camera) {
  UprightBlob blob;
  blob.uvd = *project({-0.5 + speed * test::kFrameStep * frame, 0.3, 12.0}, camera);
  blob.width_px = frame % 2 == 0 ? 60.0 : 24.0;  // legs
  blob.cells.push_back({{0, 0}, *triangulate(blob.uvd, camera)});
  return blob;
}

struct Followed {
  test::Drive drive;
  BlobFollower follower{drive.camera};

  /// @param hidden  frame in which something stands before half of the walker
  Followed(double speed, int hidden) {
    for (int frame = 0; frame < kFrames; ++frame) {
      drive.path.advance(test::kFrameStep * frame, Pose::Identity());
      UprightBlob blob = walkerIn(frame, speed, drive.camera);
      if (frame == hidden) {
        blob.hidden = true;
        blob.uvd.x() += 8.0;  // the middle of what is seen of him
      }
      follower.follow({blob}, drive.path, kUp);
    }
  }

  [[nodiscard]] bool moves() { return BlobFollower::moves(follower.tracks()[0], kUp, {}, 0.6); }
};

TEST(BlobFollowerTest, TellsAWalkerFromAPostByTheirOutlines) {
  Followed walker(1.4, -1);
  ASSERT_EQ(walker.follower.tracks().size(), 1u);
  EXPECT_TRUE(walker.moves());
  EXPECT_NEAR(walker.follower.tracks()[0].track.motion->velocity.x(), 1.4, 0.2);
  Followed post(0.0, -1);
  EXPECT_FALSE(post.moves());
}

TEST(BlobFollowerTest, GoesOnThroughAFrameInWhichSomethingHidesTheBody) {
  Followed walker(1.4, 4);
  ASSERT_EQ(walker.follower.tracks().size(), 1u);
  const auto& track = walker.follower.tracks()[0];
  EXPECT_EQ(track.track.sightings.size(), kFrames - 1u) << "all but the one that tells nothing";
  EXPECT_EQ(track.last_frame, kFrames - 1);
  EXPECT_TRUE(walker.moves());
}

TEST(BlobFollowerTest, AnOutlineThatIsHiddenOnceDoesNotMakeAPostMove) {
  Followed post(0.0, 4);
  ASSERT_EQ(post.follower.tracks().size(), 1u);
  EXPECT_FALSE(post.moves());
}

TEST(BlobFollowerTest, StereosErrorsOfDistanceDoNotBreakATrack) {
  // 24 m off an error of one pixel of disparity is 1.5 m along the line of sight.
  for (const bool along : {true, false}) {
    test::Drive drive;
    BlobFollower follower{drive.camera};
    for (int frame = 0; frame < 2; ++frame) {
      drive.path.advance(test::kFrameStep * frame, Pose::Identity());
      Eigen::Vector3d place(-0.5, 0.3, 24.0);
      (along ? place.z() : place.x()) += 1.4 * frame;
      UprightBlob blob = walkerIn(frame, 0.0, drive.camera);
      blob.uvd = *project(place, drive.camera);
      follower.follow({blob}, drive.path, kUp);
    }
    EXPECT_EQ(follower.tracks().size(), along ? 1u : 2u);
  }
}

TEST(BlobFollowerTest, ABodyThatIsNotSeenAgainIsForgotten) {
  Followed walker(1.4, -1);
  for (int frame = kFrames; frame < kFrames + 5; ++frame) {
    walker.drive.path.advance(test::kFrameStep * frame, Pose::Identity());
    walker.follower.follow({}, walker.drive.path, kUp);
  }
  EXPECT_TRUE(walker.follower.tracks().empty());
}

}  // namespace
}  // namespace headway::detect
