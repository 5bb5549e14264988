#include "newest_part.h"

#include <gtest/gtest.h>

namespace headway::slam {
namespace {

constexpr int kRestartAfter = 20;

NewestPart begunAt(std::int64_t keyframe, int tracked) {
  NewestPart part;
  part.begin(KeyframeId{keyframe});
  for (int i = 0; i < tracked; ++i) part.addTracked();
  return part;
}

TEST(NewestPartTest, ThereIsNoneBeforeOneIsBegun) {
  NewestPart part;
  part.addTracked();  // in a map that was loaded
  EXPECT_FALSE(part.first().valid());
  EXPECT_FALSE(part.isYoung());
  EXPECT_EQ(part.patience(kRestartAfter), kRestartAfter);
}

TEST(NewestPartTest, IsYoungForEightFrames) {
  EXPECT_TRUE(begunAt(5, 0).isYoung());
  EXPECT_TRUE(begunAt(5, 7).isYoung());
  EXPECT_FALSE(begunAt(5, 8).isYoung());
}

TEST(NewestPartTest, IsWaitedForNoLongerThanItTook) {
  EXPECT_EQ(begunAt(5, 0).patience(kRestartAfter), 1);
  EXPECT_EQ(begunAt(5, 6).patience(kRestartAfter), 7);
  EXPECT_EQ(begunAt(5, 500).patience(kRestartAfter), kRestartAfter);
}

TEST(NewestPartTest, EndsWhereTheCameraIsBackInAnOlderOne) {
  NewestPart part = begunAt(5, 3);
  part.returnTo(KeyframeId{5});
  part.returnTo(KeyframeId{9});
  EXPECT_EQ(part.first(), KeyframeId{5}) << "these are its own";
  part.returnTo(KeyframeId{4});
  EXPECT_FALSE(part.first().valid());
  EXPECT_FALSE(part.isYoung());
  EXPECT_EQ(part.patience(kRestartAfter), kRestartAfter);
}

TEST(NewestPartTest, CountsFromItsOwnBeginning) {
  NewestPart part = begunAt(5, 12);
  part.begin(KeyframeId{30});
  EXPECT_EQ(part.first(), KeyframeId{30});
  EXPECT_TRUE(part.isYoung());
  EXPECT_EQ(part.patience(kRestartAfter), 1);
}

}  // namespace
}  // namespace headway::slam
