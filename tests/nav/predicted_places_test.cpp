// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/nav/moving_obstacles.h>
#include <headway_test/walking_track.h>

#include <limits>

namespace headway::nav {
namespace {

using test::walkingTrack;

std::vector<PredictedPlace> placesOf(const Track& track, double age_s, double horizon_s = 3.0) {
  std::vector<PredictedPlace> places;
  predictPlaces(track, track.predictions.front(), age_s, horizon_s, 0.25, places);
  return places;
}

TEST(PredictedPlacesTest, LieOnThePathAndLeaveNoInstantOut) {
  const auto places = placesOf(walkingTrack(1, {2.0, 0.0}, {0.0, 1.0}), 0.0);
  ASSERT_GT(places.size(), 5u);
  EXPECT_DOUBLE_EQ(places.front().when.from_s, 0.0);
  EXPECT_NEAR(places.back().when.to_s, 3.0, 1e-9);
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    EXPECT_DOUBLE_EQ(places[i].centre.x(), 2.0);
    EXPECT_TRUE(places[i].when.overlaps(places[i + 1].when));
    EXPECT_GE((places[i + 1].centre - places[i].centre).norm(), 0.25 - 1e-9);
  }
}

TEST(PredictedPlacesTest, OfAnOldMapBeginAtTheCurrentPosition) {
  const auto places = placesOf(walkingTrack(1, {2.0, 0.0}, {0.0, 1.0}), 0.45);
  EXPECT_NEAR(places.front().centre.y(), 0.45, 1e-9);
  EXPECT_DOUBLE_EQ(places.front().when.from_s, 0.0);
  EXPECT_NEAR(places.back().when.to_s, 2.55, 1e-9);
}

TEST(PredictedPlacesTest, AStaticObjectHasAnUnlimitedTimeSpan) {
  const auto places = placesOf(walkingTrack(1, {2.0, 0.0}, {0.01, 0.0}), 0.0);
  ASSERT_EQ(places.size(), 1u);
  EXPECT_EQ(places.front().when.to_s, std::numeric_limits<double>::infinity());
}

TEST(PredictedPlacesTest, GoStraightOnBeyondThePrediction) {
  const auto track = walkingTrack(1, {2.0, 0.0}, {0.0, 1.0}, 0.2);
  const auto places = placesOf(track, 0.0, 5.0);
  EXPECT_NEAR(places.back().centre.y(), 5.0, 0.3);
  EXPECT_GT(places.back().covariance(0, 0), 1.5 * 0.04);
}

TEST(PredictedPlacesTest, OfAPathWithoutPointsAreThePresentOne) {
  Track track = walkingTrack(1, {2.0, 1.0}, {0.0, 1.0});
  track.predictions.front().points.clear();
  const auto places = placesOf(track, 0.2);
  ASSERT_EQ(places.size(), 1u);
  EXPECT_EQ(places.front().centre, Eigen::Vector2d(2.0, 1.0));
}

TEST(PredictedPlacesTest, OlderThanThePredictionAreAtItsEnd) {
  const auto places = placesOf(walkingTrack(1, {2.0, 0.0}, {0.0, 1.0}), 7.0);
  ASSERT_EQ(places.size(), 1u);
  EXPECT_NEAR(places.front().centre.y(), 3.0, 1e-9);
}

}  // namespace
}  // namespace headway::nav
