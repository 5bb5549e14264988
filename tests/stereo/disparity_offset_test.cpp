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

/// A record after estimates of one offset.
OffsetRecord recordOf(const OffsetEstimate& seen, int times) {
  constexpr double kIndependent = 0.1;
  OffsetRecord record;
  for (int i = 0; i < times; ++i) record.add(seen, kIndependent);
  return record;
}

TEST(OffsetRecordTest, IsCorrectedAsItIsSeenUntilItIsKnown) {
  EXPECT_TRUE(OffsetRecord().isCorrected());
  EXPECT_TRUE(recordOf({0.02, 0.1}, 3).isCorrected());
  EXPECT_FALSE(recordOf({0.02, 0.02}, 50).isCorrected());
}

TEST(OffsetRecordTest, WhatCostsLessThanItsCorrectionIsLeft) {
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_FALSE(recordOf({sign * 1.3 * kOffsetModelSigma_px, 0.01}, 50).isCorrected());
    EXPECT_TRUE(recordOf({sign * 2.0 * kOffsetModelSigma_px, 0.01}, 50).isCorrected());
  }
}

TEST(OffsetRecordTest, ItsSigmaContainsTheErrorsOfTheModel) {
  const auto estimate = recordOf({0.2, 0.01}, 100).estimate();
  EXPECT_NEAR(estimate.px, 0.2, 1e-3);
  EXPECT_GT(estimate.sigma_px, kOffsetModelSigma_px);
  EXPECT_LT(estimate.sigma_px, 1.2 * kOffsetModelSigma_px);
}

TEST(OffsetRecordTest, AKnockStartsItAnewAndOneWrongEstimateDoesNot) {
  OffsetRecord record = recordOf({0.0, 0.01}, 50);
  record.add({0.6, 0.01}, 0.1);
  EXPECT_NEAR(record.estimate().px, 0.0, 0.01);
  record.add({0.0, 0.01}, 0.1);
  for (int i = 0; i < 3; ++i) record.add({0.4, 0.01}, 0.1);
  EXPECT_NEAR(record.estimate().px, 0.4, 0.01);
  EXPECT_TRUE(record.isCorrected());
}

}  // namespace
}  // namespace headway::stereo
