// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "local_mapper.h"

namespace headway::slam {
namespace {

constexpr double kRestartAfter_s = 2.0;

/// A rate that was measured.
FrameRate rateOf(double hz) {
  FrameRate rate;
  for (int i = 0; i < 10; ++i) rate.add(i / hz);
  return rate;
}

ActiveSubmap initialisedAt(std::int64_t keyframe, int tracked, double hz = 10.0) {
  ActiveSubmap submap;
  submap.initialise(KeyframeId{keyframe});
  for (int i = 0; i < tracked; ++i) submap.addTracked(1.0 / hz);
  return submap;
}

/// Lost frames in a row that a submap outlives.
int maxLostFrames(const ActiveSubmap& submap, double hz = 10.0) {
  int lost = 0;
  while (!submap.isOver(lost + 1, (lost + 1) / hz, kRestartAfter_s, rateOf(hz))) ++lost;
  return lost;
}

TEST(ActiveSubmapTest, ThereIsNoneBeforeInitialisation) {
  ActiveSubmap submap;
  submap.addTracked(0.1);  // in a map that was loaded
  EXPECT_FALSE(submap.first().valid());
  EXPECT_FALSE(submap.isNew(rateOf(10.0)));
  EXPECT_EQ(maxLostFrames(submap), 20);
}

TEST(ActiveSubmapTest, IsNewForTheSameTimeAtAnyRate) {
  for (const auto& [hz, frames] : {std::pair(5.0, 4), {10.0, 8}, {15.0, 12}, {30.0, 24}}) {
    EXPECT_TRUE(initialisedAt(5, 0, hz).isNew(rateOf(hz))) << hz;
    EXPECT_TRUE(initialisedAt(5, frames - 1, hz).isNew(rateOf(hz))) << hz;
    EXPECT_FALSE(initialisedAt(5, frames, hz).isNew(rateOf(hz))) << hz;
  }
  EXPECT_TRUE(initialisedAt(5, 1, 1.0).isNew(rateOf(1.0))) << "one frame confirms nothing";
  EXPECT_FALSE(initialisedAt(5, 2, 1.0).isNew(rateOf(1.0)));
}

TEST(ActiveSubmapTest, IsNotLostForLongerThanItWasTracked) {
  for (const double hz : {5.0, 10.0, 15.0, 30.0}) {
    EXPECT_EQ(maxLostFrames(initialisedAt(5, 0, hz), hz), 1) << hz;
    EXPECT_EQ(maxLostFrames(initialisedAt(5, 6, hz), hz), 7) << hz;
    EXPECT_EQ(maxLostFrames(initialisedAt(5, 500, hz), hz), static_cast<int>(2.0 * hz)) << hz;
  }
}

TEST(ActiveSubmapTest, EndsWhereTheCameraIsRelocalisedInAnOlderOne) {
  ActiveSubmap submap = initialisedAt(5, 3);
  submap.relocaliseAt(KeyframeId{5});
  submap.relocaliseAt(KeyframeId{9});
  EXPECT_EQ(submap.first(), KeyframeId{5}) << "these are its own";
  submap.relocaliseAt(KeyframeId{4});
  EXPECT_FALSE(submap.first().valid());
  EXPECT_FALSE(submap.isNew(rateOf(10.0)));
  EXPECT_EQ(maxLostFrames(submap), 20);
}

TEST(ActiveSubmapTest, CountsFromItsOwnBeginning) {
  ActiveSubmap submap = initialisedAt(5, 12);
  submap.initialise(KeyframeId{30});
  EXPECT_EQ(submap.first(), KeyframeId{30});
  EXPECT_TRUE(submap.isNew(rateOf(10.0)));
  EXPECT_EQ(maxLostFrames(submap), 1);
}

}  // namespace
}  // namespace headway::slam
