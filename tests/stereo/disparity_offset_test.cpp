// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/stereo/rectification.h>

namespace headway::stereo {
namespace {

/// Evidence of points that all ask for one offset, given the estimate so far.
std::vector<OffsetEvidence> pointsFor(double true_offset_px, const DisparityOffset& estimate,
                                      int count) {
  constexpr double kInformation = 4.0;
  const double left = true_offset_px - estimate.value();
  return std::vector<OffsetEvidence>(count, {kInformation, kInformation * left, 1.0});
}

TEST(DisparityOffsetTest, ConvergesToTheOffsetOfStaticPoints) {
  DisparityOffset offset;
  for (int frame = 0; frame < 40; ++frame) offset.update(pointsFor(0.8, offset, 200));
  EXPECT_NEAR(offset.value(), 0.8, 0.01);
}

TEST(DisparityOffsetTest, FollowsASlowChange) {
  DisparityOffset offset;
  double truth = 0.0;
  for (int frame = 0; frame < 100; ++frame) {
    truth += 0.005;
    offset.update(pointsFor(truth, offset, 200));
  }
  EXPECT_NEAR(offset.value(), truth, 0.05);
}

TEST(DisparityOffsetTest, PointsThatFitBadlyWeighLess) {
  DisparityOffset good, bad;
  good.update({{4.0, 4.0, 1.0}});
  bad.update({{4.0, 4.0, 9.0}});
  EXPECT_GT(good.value(), 2.0 * bad.value());
  EXPECT_GT(bad.value(), 0.0);
}

TEST(DisparityOffsetTest, WithoutPointsNothingChanges) {
  DisparityOffset offset;
  offset.update(pointsFor(0.5, offset, 100));
  const double before = offset.value();
  offset.update({});
  EXPECT_EQ(offset.value(), before);
}

TEST(DisparityOffsetTest, IsBounded) {
  DisparityOffset offset;
  for (int frame = 0; frame < 200; ++frame) offset.update(pointsFor(20.0, offset, 500));
  EXPECT_LE(offset.value(), 4.0);
}

}  // namespace
}  // namespace headway::stereo
