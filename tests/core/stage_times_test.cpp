// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/stage_times.h>

namespace headway {
namespace {

TEST(StageTimesTest, IsEmptyAtFirst) {
  EXPECT_TRUE(StageTimes().summary().empty());
  EXPECT_TRUE(StageTimes().empty());
}

TEST(StageTimesTest, SummarisesEachStageByItsSamples) {
  StageTimes times;
  for (int i = 100; i >= 1; --i) times.add("track", i);
  times.add("map", 7.0);
  const auto summary = times.summary();
  ASSERT_EQ(2u, summary.size());
  EXPECT_EQ(100u, summary.at("track").count);
  EXPECT_DOUBLE_EQ(50.0, summary.at("track").median_ms);
  EXPECT_DOUBLE_EQ(95.0, summary.at("track").p95_ms);
  EXPECT_DOUBLE_EQ(100.0, summary.at("track").max_ms);
  EXPECT_DOUBLE_EQ(5050.0, summary.at("track").total_ms);
  EXPECT_EQ(1u, summary.at("map").count);
  EXPECT_DOUBLE_EQ(7.0, summary.at("map").median_ms);
}

TEST(StageTimesTest, MergesStageByStage) {
  StageTimes times;
  times.add("track", 1.0);
  StageTimes other;
  other.add("track", 2.0);
  other.add("map", 3.0);
  times.merge(other);
  const auto summary = times.summary();
  EXPECT_EQ(2u, summary.at("track").count);
  EXPECT_DOUBLE_EQ(3.0, summary.at("track").total_ms);
  EXPECT_DOUBLE_EQ(2.0, summary.at("track").max_ms);
  EXPECT_DOUBLE_EQ(3.0, summary.at("map").median_ms);
  EXPECT_EQ(2u, other.summary().size());
}

TEST(StageTimesTest, WatchAddsTheTimeOfItsScope) {
  StageTimes times;
  double elapsed_ms = 0.0;
  {
    const auto watch = times.watch("track");
    while (watch.elapsedMs() < 0.01) {
    }
    elapsed_ms = watch.elapsedMs();
    EXPECT_TRUE(times.empty()) << "nothing is added before the end of the scope";
  }
  ASSERT_EQ(1u, times.summary().at("track").count);
  EXPECT_GE(times.summary().at("track").max_ms, elapsed_ms);
}

TEST(StageTimesTest, WatchesOfTwoStagesMayNest) {
  StageTimes times;
  {
    const auto outer = times.watch("frame");
    const auto inner = times.watch("track");
  }
  EXPECT_GE(times.summary().at("frame").max_ms, times.summary().at("track").max_ms);
}

TEST(ProcessorSecondsTest, GrowsWithWork) {
  const double before = processorSeconds();
  volatile double sum = 0.0;
  while (processorSeconds() - before < 1e-3) sum = sum + 1.0;
  EXPECT_GT(processorSeconds(), before);
  EXPECT_GT(sum, 0.0);
}

}  // namespace
}  // namespace headway
