// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "local_mapper.h"

namespace headway::slam {
namespace {

constexpr int kRestartAfter = 20;

ActiveSubmap initialisedAt(std::int64_t keyframe, int tracked) {
  ActiveSubmap submap;
  submap.initialise(KeyframeId{keyframe});
  for (int i = 0; i < tracked; ++i) submap.countTrackedFrame();
  return submap;
}

TEST(ActiveSubmapTest, ThereIsNoneBeforeInitialisation) {
  ActiveSubmap submap;
  submap.countTrackedFrame();  // in a map that was loaded
  EXPECT_FALSE(submap.first().valid());
  EXPECT_FALSE(submap.isNew());
  EXPECT_EQ(submap.maxLostFrames(kRestartAfter), kRestartAfter);
}

TEST(ActiveSubmapTest, IsNewForEightFrames) {
  EXPECT_TRUE(initialisedAt(5, 0).isNew());
  EXPECT_TRUE(initialisedAt(5, 7).isNew());
  EXPECT_FALSE(initialisedAt(5, 8).isNew());
}

TEST(ActiveSubmapTest, AllowsNoMoreLostFramesThanWereTracked) {
  EXPECT_EQ(initialisedAt(5, 0).maxLostFrames(kRestartAfter), 1);
  EXPECT_EQ(initialisedAt(5, 6).maxLostFrames(kRestartAfter), 7);
  EXPECT_EQ(initialisedAt(5, 500).maxLostFrames(kRestartAfter), kRestartAfter);
}

TEST(ActiveSubmapTest, EndsWhereTheCameraIsRelocalisedInAnOlderOne) {
  ActiveSubmap submap = initialisedAt(5, 3);
  submap.relocaliseAt(KeyframeId{5});
  submap.relocaliseAt(KeyframeId{9});
  EXPECT_EQ(submap.first(), KeyframeId{5}) << "these are its own";
  submap.relocaliseAt(KeyframeId{4});
  EXPECT_FALSE(submap.first().valid());
  EXPECT_FALSE(submap.isNew());
  EXPECT_EQ(submap.maxLostFrames(kRestartAfter), kRestartAfter);
}

TEST(ActiveSubmapTest, CountsFromItsOwnBeginning) {
  ActiveSubmap submap = initialisedAt(5, 12);
  submap.initialise(KeyframeId{30});
  EXPECT_EQ(submap.first(), KeyframeId{30});
  EXPECT_TRUE(submap.isNew());
  EXPECT_EQ(submap.maxLostFrames(kRestartAfter), 1);
}

}  // namespace
}  // namespace headway::slam
