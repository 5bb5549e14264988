// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "local_mapper.h"

namespace headway::slam {
namespace {

constexpr int kWidth = 1000;  // of the image [px]
constexpr int kSeen = 20;     // landmarks of each keyframe

/// Keyframes that each see landmarks of their own, all at the same place of the image.
class ReferenceChoiceTest : public testing::Test {
 protected:
  ReferenceChoiceTest() { params.window = 2; }

  KeyframeId addKeyframe() {
    const KeyframeId id = map.addKeyframe(0, 0.0, Pose::Identity()).id;
    for (int i = 0; i < kSeen; ++i) map.addLandmark({0.0, 0.0, 10.0}, id, {});
    return id;
  }

  /// A frame that sees the first landmarks of a keyframe, moved along the row.
  [[nodiscard]] std::vector<TrackedLandmark> frameOf(KeyframeId keyframe, int count,
                                                     double flow_px) const {
    std::vector<TrackedLandmark> frame;
    for (int i = 0; i < count; ++i) {
      TrackedLandmark seen;
      seen.id = map.keyframe(keyframe).landmarks[static_cast<std::size_t>(i)];
      seen.measurement.uv.x() = flow_px;
      frame.push_back(seen);
    }
    return frame;
  }

  [[nodiscard]] std::optional<KeyframeId> chosen(const std::vector<TrackedLandmark>& frame,
                                                 KeyframeId before) const {
    return referenceOf(frame, before, params, kWidth, map);
  }

  SparseMap map;
  SlamParams params;
};

TEST_F(ReferenceChoiceTest, StaysWhileAFrameShowsMostOfIt) {
  const KeyframeId before = addKeyframe();
  EXPECT_EQ(chosen(frameOf(before, 14, 59.0), before), before);
}

TEST_F(ReferenceChoiceTest, AFrameThatShowsTooLittleBecomesAKeyframe) {
  const KeyframeId before = addKeyframe();
  EXPECT_FALSE(chosen(frameOf(before, 13, 0.0), before)) << "under keyframe_overlap";
  EXPECT_FALSE(chosen(frameOf(before, kSeen, 61.0), before)) << "over keyframe_flow_ratio";
}

TEST_F(ReferenceChoiceTest, GoesOverToAnOldKeyframeThatSawThePlaceFromHere) {
  const KeyframeId old = addKeyframe();
  addKeyframe();
  const KeyframeId before = addKeyframe();
  EXPECT_EQ(chosen(frameOf(old, 14, 10.0), before), old);
  EXPECT_FALSE(chosen(frameOf(old, 13, 10.0), before)) << "too few of its landmarks";
  EXPECT_FALSE(chosen(frameOf(old, kSeen, 61.0), before)) << "seen from elsewhere";
}

TEST_F(ReferenceChoiceTest, LandmarksOfOtherTimesCountForAnOldKeyframe) {
  const KeyframeId old = addKeyframe();
  addKeyframe();
  const KeyframeId before = addKeyframe();
  auto frame = frameOf(old, 10, 10.0);
  const auto others = frameOf(before, 6, 10.0);
  frame.insert(frame.end(), others.begin(), others.end());
  EXPECT_EQ(chosen(frame, before), old);
}

TEST_F(ReferenceChoiceTest, KeyframesOfTheWindowAreNotOld) {
  const KeyframeId last_but_one = addKeyframe();
  const KeyframeId before = addKeyframe();
  EXPECT_FALSE(chosen(frameOf(last_but_one, kSeen, 0.0), before));
}

TEST_F(ReferenceChoiceTest, WithoutMappingItIsTheNearestThatThereIs) {
  params.mapping = false;
  const KeyframeId other = addKeyframe();
  const KeyframeId before = addKeyframe();
  EXPECT_EQ(chosen(frameOf(other, 5, 300.0), before), other);
  EXPECT_EQ(chosen({}, before), before) << "and the same as before where nothing is known";
}

}  // namespace
}  // namespace headway::slam
