// SPDX-License-Identifier: BSD-3-Clause
#include "consistency.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "trajectory.h"

namespace headway::objects {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

ExpectedPlace track(double x, double y, ObjectClass object_class = ObjectClass::kCar) {
  ExpectedPlace place;
  place.position = {x, y, 0.0};
  place.covariance = 0.04 * Eigen::Matrix2d::Identity();
  place.vertical_variance = 0.01;
  place.object_class = object_class;
  return place;
}

MeasuredBox box(double x, double y, ObjectClass object_class = ObjectClass::kCar) {
  MeasuredBox result;
  result.position = {x, y, 0.0};
  result.covariance = 0.04 * Eigen::Matrix2d::Identity();
  result.vertical_variance = 0.01;
  result.object_class = object_class;
  result.size = {4.0, 1.7, 1.5};
  return result;
}

TEST(CompatibleTest, KeepsGroupsApart) {
  EXPECT_TRUE(compatible(ObjectClass::kCar, ObjectClass::kVan));
  EXPECT_TRUE(compatible(ObjectClass::kPedestrian, ObjectClass::kPersonSitting));
  EXPECT_FALSE(compatible(ObjectClass::kCar, ObjectClass::kPedestrian));
  EXPECT_FALSE(compatible(ObjectClass::kCyclist, ObjectClass::kPedestrian));
  EXPECT_TRUE(compatible(ObjectClass::kUnknown, ObjectClass::kPedestrian));
}

TEST(ConsistencyCheckTest, MatchesDetectionsInsideTheGate) {
  const ConsistencyCheck check{ConsistencyParams()};
  const auto near = check.match({track(10, 0)}, {box(10.3, 0.2)});
  EXPECT_THAT(near.pairs, ElementsAre(Pair(0u, 0u)));
  EXPECT_THAT(near.unmatched_detections, IsEmpty());
  const auto far = check.match({track(10, 0)}, {box(14, 0)});
  EXPECT_THAT(far.pairs, IsEmpty());
  EXPECT_THAT(far.unmatched_detections, ElementsAre(0u));
}

TEST(ConsistencyCheckTest, MatchesADetectionToTheNearestTrack) {
  const ConsistencyCheck check{ConsistencyParams()};
  const auto matches = check.match({track(10, 0), track(10.8, 0)}, {box(10.7, 0)});
  EXPECT_THAT(matches.pairs, ElementsAre(Pair(1u, 0u)));
}

TEST(ConsistencyCheckTest, MinimisesTheTotalCost) {
  const ConsistencyCheck check{ConsistencyParams()};
  // The nearest pair (track 1, box 0) would leave track 0 with nothing.
  const auto matches = check.match({track(10, 0), track(10.5, 0)}, {box(10.4, 0), box(10.9, 0)});
  EXPECT_THAT(matches.pairs, ElementsAre(Pair(0u, 0u), Pair(1u, 1u)));
}

TEST(ConsistencyCheckTest, UsesClassAndHeight) {
  const ConsistencyCheck check{ConsistencyParams()};
  EXPECT_THAT(check.match({track(10, 0)}, {box(10, 0, ObjectClass::kPedestrian)}).pairs, IsEmpty());
  MeasuredBox above = box(10, 0);
  above.position.z() = 4.0;
  EXPECT_THAT(check.match({track(10, 0)}, {above}).pairs, IsEmpty());
}

TEST(ConsistencyCheckTest, TheDetectorsIdIsAHintOnly) {
  ConsistencyParams params;
  params.detector_id_bonus = 3.0;
  const ConsistencyCheck check(params);
  ExpectedPlace a = track(10, 0.3);
  ExpectedPlace b = track(10, -0.3);
  a.detector_id = 7;
  b.detector_id = 8;
  MeasuredBox between = box(10, 0.05);
  between.detector_id = 8;
  EXPECT_THAT(check.match({a, b}, {between}).pairs, ElementsAre(Pair(1u, 0u)));
  MeasuredBox elsewhere = box(20, 0);
  elsewhere.detector_id = 7;
  EXPECT_THAT(check.match({a, b}, {elsewhere}).pairs, IsEmpty()) << "too far";
}

TEST(ConsistencyCheckTest, TheSearchedTrackIsAHintOnly) {
  const ConsistencyCheck check{ConsistencyParams()};
  auto first = track(10, 0);
  auto second = track(10.4, 0);
  first.track = TrackId{0};
  second.track = TrackId{1};
  auto between = box(10.2, 0);
  between.searched_track = TrackId{1};
  EXPECT_THAT(check.match({first, second}, {between}).pairs, ElementsAre(Pair(1u, 0u)));
  auto near_first = box(9.9, 0);
  near_first.searched_track = TrackId{1};
  EXPECT_THAT(check.match({first, second}, {near_first}).pairs, ElementsAre(Pair(0u, 0u)));
}

TEST(ConsistencyCheckTest, AProvisionalClassIsCompatibleAtACost) {
  const ConsistencyCheck check{ConsistencyParams()};
  auto provisional = box(10, 0, ObjectClass::kPedestrian);
  EXPECT_THAT(check.match({track(10, 0)}, {provisional}).pairs, IsEmpty());
  provisional.evidence.motion = true;
  EXPECT_THAT(check.match({track(10, 0)}, {provisional}).pairs, ElementsAre(Pair(0u, 0u)));
  const auto walker = track(10.2, 0, ObjectClass::kPedestrian);
  EXPECT_THAT(check.match({track(10, 0), walker}, {provisional}).pairs, ElementsAre(Pair(1u, 0u)));
}

TEST(ConsistencyCheckTest, KeepsTheBoxWithTheBestScore) {
  const ConsistencyCheck check{ConsistencyParams()};
  MeasuredBox sure = box(10, 0);
  MeasuredBox twin = box(10.4, 0.1);
  sure.score = 0.9;
  twin.score = 0.4;
  const auto distinct = check.withoutDuplicates({twin, sure, box(10, 2.5)});
  ASSERT_EQ(distinct.boxes.size(), 2u);
  EXPECT_EQ(distinct.boxes[0].score, 0.9);
  ASSERT_EQ(distinct.duplicates.size(), 1u);
  EXPECT_EQ(distinct.duplicates[0].second.score, 0.4);
}

TEST(DistinctBoxesTest, ReturnsTheBoxNearestToTheTrack) {
  const ConsistencyCheck check{ConsistencyParams()};
  MeasuredBox sure = box(10, 0);
  sure.score = 0.9;
  const auto distinct = check.withoutDuplicates({sure, box(10.4, 0.1), box(10, 2.5)});
  ASSERT_EQ(distinct.boxes.size(), 2u);
  EXPECT_EQ(distinct.likeliest(0, track(9.9, 0)).position.x(), 10.0);
  EXPECT_EQ(distinct.likeliest(0, track(10.5, 0)).position.x(), 10.4);
  EXPECT_EQ(distinct.likeliest(1, track(10.4, 2.5)).position.x(), 10.0) << "another object's";
}

TEST(MovingAverageTest, IsTheMeanForAStaticObject) {
  std::vector<PlaceMeasurement> places(4);
  for (int i = 0; i < 4; ++i) {
    places[i].time = 0.1 * i;
    places[i].measured = {static_cast<double>(i % 2), 0.0, 0.0};
  }
  const Eigen::Vector3d still = Eigen::Vector3d::Zero();
  EXPECT_NEAR(movingAverage(places, 4, still).x(), 0.5, 1e-12);
  EXPECT_NEAR(movingAverage(places, 1, still).x(), 1.0, 1e-12);
  EXPECT_NEAR(movingAverage(places, 100, still).x(), 0.5, 1e-12);
  EXPECT_NEAR(gaussianAverage(places, 100.0, still).x(), 0.5, 1e-6);
  EXPECT_NEAR(gaussianAverage(places, 0.01, still).x(), 1.0, 1e-9);
}

TEST(MovingAverageTest, DoesNotLagBehindAMovingObject) {
  std::vector<PlaceMeasurement> places(6);
  for (int i = 0; i < 6; ++i) {
    places[i].time = 0.1 * i;
    places[i].measured = {1.5 * i, -0.5 * i, 0.0};
  }
  const Eigen::Vector3d velocity(15.0, -5.0, 0.0);
  EXPECT_LT((movingAverage(places, 6, velocity) - places.back().measured).norm(), 1e-9);
  EXPECT_LT((gaussianAverage(places, 0.2, velocity) - places.back().measured).norm(), 1e-9);
}

}  // namespace
}  // namespace headway::objects
