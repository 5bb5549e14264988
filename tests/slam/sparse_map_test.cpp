// SPDX-License-Identifier: BSD-3-Clause
#include "sparse_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace headway::slam {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Three keyframes; landmark 0 is seen by all, 1 by the first two, 2 by the last alone.
class SparseMapTest : public testing::Test {
 protected:
  SparseMapTest() {
    for (std::size_t i = 0; i < 3; ++i) keyframes_.push_back(addKeyframe(i));
    for (const std::size_t first : {0U, 0U, 2U}) {
      landmarks_.push_back(
          map_.addLandmark(Eigen::Vector3d::Zero(), keyframes_[first], stereo::StereoMeasurement{})
              .id);
    }
    map_.observe(keyframes_[1], landmarks_[0], {});
    map_.observe(keyframes_[2], landmarks_[0], {});
    map_.observe(keyframes_[1], landmarks_[1], {});
  }
  KeyframeId addKeyframe(std::size_t i) {
    return map_.addKeyframe(i, 0.1 * static_cast<double>(i), Pose::Identity()).id;
  }
  SparseMap map_;
  std::vector<KeyframeId> keyframes_;
  std::vector<LandmarkId> landmarks_;
};

TEST_F(SparseMapTest, ReadingMarksNothingAsChanged) {
  (void)map_.takeChangedLandmarks();
  (void)map_.takeChangedKeyframes();
  EXPECT_EQ(map_.find(landmarks_[0])->id, landmarks_[0]);
  EXPECT_EQ(map_.keyframe(keyframes_[0]).id, keyframes_[0]);
  EXPECT_THAT(map_.takeChangedLandmarks(), IsEmpty());
  EXPECT_THAT(map_.takeChangedKeyframes(), IsEmpty());
  map_.findToChange(landmarks_[0])->tried = 1;
  map_.keyframeToChange(keyframes_[0]).time = 1.0;
  EXPECT_THAT(map_.takeChangedLandmarks(), ElementsAre(0));
  EXPECT_THAT(map_.takeChangedKeyframes(), ElementsAre(0));
}

TEST_F(SparseMapTest, LinksBothWays) {
  EXPECT_THAT(map_.keyframe(keyframes_[0]).landmarks, ElementsAre(landmarks_[0], landmarks_[1]));
  EXPECT_EQ(map_.find(landmarks_[0])->observations.size(), 3U);
  EXPECT_THAT(map_.seenBy({keyframes_[1], keyframes_[2]}),
              ElementsAre(landmarks_[0], landmarks_[1], landmarks_[2]));
}

TEST_F(SparseMapTest, NeighboursShareMostLandmarks) {
  EXPECT_THAT(map_.neighbourhood(keyframes_[1], 2), ElementsAre(keyframes_[0], keyframes_[1]));
  EXPECT_THAT(map_.neighbourhood(keyframes_[1], 9),
              ElementsAre(keyframes_[0], keyframes_[1], keyframes_[2]));
}

TEST_F(SparseMapTest, RemovingTheLastObservationRemovesTheLandmark) {
  map_.removeObservation(keyframes_[2], landmarks_[2]);
  EXPECT_EQ(map_.find(landmarks_[2]), nullptr);
  EXPECT_THAT(map_.keyframe(keyframes_[2]).landmarks, ElementsAre(landmarks_[0]));
}

TEST_F(SparseMapTest, RemovingALandmarkUnlinksItEverywhere) {
  map_.removeLandmark(landmarks_[0]);
  EXPECT_THAT(map_.keyframe(keyframes_[0]).landmarks, ElementsAre(landmarks_[1]));
  EXPECT_THAT(map_.keyframe(keyframes_[2]).landmarks, ElementsAre(landmarks_[2]));
}

TEST_F(SparseMapTest, RemovingAKeyframeLeavesNoTraceOfIt) {
  map_.removeKeyframe(keyframes_[2]);
  EXPECT_EQ(map_.keyframes().count(keyframes_[2]), 0U);
  EXPECT_EQ(map_.find(landmarks_[2]), nullptr);
  EXPECT_EQ(map_.find(landmarks_[0])->observations.size(), 2U);
}

TEST_F(SparseMapTest, IdsAreNeverUsedAgain) {
  map_.removeLandmark(landmarks_[2]);
  EXPECT_NE(map_.addLandmark(Eigen::Vector3d::Zero(), keyframes_[2], {}).id, landmarks_[2]);
}

TEST_F(SparseMapTest, FusedLandmarksAreSeenByTheKeyframesOfBoth) {
  const auto other = addKeyframe(3);
  const auto same = map_.addLandmark(Eigen::Vector3d::Zero(), other, {}).id;
  EXPECT_TRUE(map_.fuse(landmarks_[0], same));
  EXPECT_EQ(map_.find(same), nullptr);
  EXPECT_THAT(map_.keyframe(other).landmarks, ElementsAre(landmarks_[0]));
  EXPECT_EQ(map_.find(landmarks_[0])->observations.size(), 4U);
}

TEST_F(SparseMapTest, LandmarksThatOneKeyframeSeesBothAreNotFused) {
  EXPECT_FALSE(map_.fuse(landmarks_[0], landmarks_[1]));
  EXPECT_EQ(map_.find(landmarks_[1])->observations.size(), 2U);
}

}  // namespace
}  // namespace headway::slam
