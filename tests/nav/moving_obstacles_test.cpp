// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/nav/moving_obstacles.h>
#include <headway_test/input_error.h>
#include <headway_test/walking_track.h>

#include <limits>
#include <memory>

namespace headway::nav {
namespace {

using Eigen::Vector2d;
using test::walkingTrack;

PredictiveObstaclesParams paramsOf(ObstaclePolicy policy) {
  PredictiveObstaclesParams params;
  params.policy = policy;
  params.robot.radius_m = 0.3;
  params.robot.max_speed_mps = 1.0;
  params.steer_horizon_s = params.horizon_s;
  return params;
}

std::vector<ObstaclePoint> pointsOf(const std::vector<Track>& tracks, ObstaclePolicy policy,
                                    double age_s = 0.0) {
  MovingObstacles moving(paramsOf(policy));
  moving.update(tracks, Vector2d::Zero(), age_s);
  return moving.points();
}

bool anyNear(const std::vector<ObstaclePoint>& points, const Vector2d& place, double radius) {
  for (const auto& point : points) {
    if ((point.place - place).norm() < radius) return true;
  }
  return false;
}

TEST(MovingObstaclesTest, ACrossingObjectThatLeavesInTimeIsNoObstacleAtItsPosition) {
  const Track crossing = walkingTrack(1, {2.5, 0.0}, {0.0, 1.5});
  EXPECT_FALSE(anyNear(pointsOf({crossing}, ObstaclePolicy::kTimeGated), {2.5, 0.0}, 0.4));
  EXPECT_TRUE(anyNear(pointsOf({crossing}, ObstaclePolicy::kSweep), {2.5, 0.0}, 0.4));
}

TEST(MovingObstaclesTest, AnObjectThatWillMeetTheRobotIsAnObstacleAtTheMeetingPoint) {
  const Track meeting = walkingTrack(1, {2.0, -2.0}, {0.0, 1.0});
  EXPECT_TRUE(anyNear(pointsOf({meeting}, ObstaclePolicy::kTimeGated), {2.0, 0.0}, 0.4));
}

/// What a memory of 3 s makes of tracks at times, seen by a robot at the origin.
class TrackMemoryTest : public testing::Test {
 protected:
  TrackMemoryTest() { stand(10.0); }

  /// The robot stands on its place at a time, and knows that by then it was free.
  void stand(Time time, const GroundScan& scan = {}) {
    auto layer = std::make_shared<map::LocalLayer>(5.0, map::RobotFootprint{0.5, 0.4});
    for (int frame = 0; frame < 3; ++frame) {
      layer->add(time, Pose::Identity(), scan, std::nullopt);
    }
    map_.update(std::shared_ptr<const map::LocalLayer>(layer));
  }

  std::vector<Track> at(Time time, const std::vector<Track>& tracks,
                        const Pose& T_map_odom = Pose::Identity()) {
    map_.update(time, tracks, T_map_odom);
    return memory_.with(tracks, time, T_map_odom, map::MapQuery(map_, time));
  }

  map::PerceptionMap map_;
  TrackMemory memory_{3.0};
};

TEST_F(TrackMemoryTest, WhoLeavesTheViewGoesOnAsPredicted) {
  const Track beside = walkingTrack(1, {0.5, 1.0}, {-1.0, 0.0}, 0.1);
  EXPECT_EQ(1u, at(10.0, {beside}).size());
  for (int asked = 0; asked < 2; ++asked) {
    const auto later = at(11.0, {});
    ASSERT_EQ(1u, later.size());
    EXPECT_NEAR(-0.5, later[0].position.x(), 1e-6);
    EXPECT_NEAR(0.1, later[0].predictions[0].points[0].horizon_s, 1e-6);
    EXPECT_NEAR(-0.6, later[0].predictions[0].points[0].position.x(), 1e-6);
  }
  const Pose loop(Eigen::Translation3d(2.0, 0.0, 0.0));
  EXPECT_NEAR(0.5, at(12.0, {}, loop)[0].position.x(), 1e-6) << "a loop moves it with the map";
  EXPECT_TRUE(at(13.5, {}).empty()) << "beyond what was predicted";
}

TEST_F(TrackMemoryTest, WhoIsSeenAgainOrNotToBeThereIsForgotten) {
  (void)at(10.0,
           {walkingTrack(1, {0.5, 1.0}, {-1.0, 0.0}), walkingTrack(2, {-1.0, 0.0}, {1.0, 0.0})});
  EXPECT_EQ(2u, at(10.4, {}).size());
  const auto seen_again = at(10.5, {walkingTrack(3, {0.1, 1.0}, {-1.0, 0.0})});
  ASSERT_EQ(2u, seen_again.size());
  EXPECT_EQ(TrackId{3}, seen_again[0].id);
  EXPECT_EQ(TrackId{2}, seen_again[1].id);
  EXPECT_EQ(2u, at(11.0, {}).size()) << "what was free before they came says nothing";
  stand(11.0);
  EXPECT_EQ(1u, at(11.0, {}).size()) << "the robot stands where the second one would be";
}

TEST_F(TrackMemoryTest, SomethingBesideThePredictedPlaceMayBeThem) {
  (void)at(10.0, {walkingTrack(1, {-1.0, 0.1}, {1.0, 0.0})});
  GroundScan scan;
  scan.obstacles = {{{0.1F, 0.33F, 0.0F}, 0.03F}};
  stand(11.0, scan);
  EXPECT_EQ(1u, at(11.0, {}).size());
  stand(11.1);
  EXPECT_TRUE(at(11.1, {}).empty());
}

TEST_F(TrackMemoryTest, WhoStandsStillIsNotRemembered) {
  Track standing = walkingTrack(1, {0.5, 1.0}, {0.0, 0.0});
  standing.motion_state = MotionState::kStatic;
  (void)at(10.0, {standing});
  EXPECT_TRUE(at(10.1, {}).empty());
}

TEST(MovingObstaclesTest, AnObjectThatArrivesTooLateIsNoObstacle) {
  const Track late = walkingTrack(1, {0.6, -3.0}, {0.0, 1.0});
  EXPECT_FALSE(anyNear(pointsOf({late}, ObstaclePolicy::kTimeGated), {0.6, 0.0}, 0.3));
  EXPECT_TRUE(anyNear(pointsOf({late}, ObstaclePolicy::kSweep), {0.6, 0.0}, 0.3));
}

TEST(MovingObstaclesTest, PlacesBeyondTheSteeringHorizonAreNone) {
  auto params = paramsOf(ObstaclePolicy::kTimeGated);
  params.steer_horizon_s = 1.5;
  MovingObstacles moving(params);
  moving.update({walkingTrack(1, {2.0, -2.0}, {0.0, 1.0})}, Vector2d::Zero(), 0.0);
  EXPECT_FALSE(anyNear(moving.points(), {2.0, 0.0}, 0.2)) << "he is there after 2 s";
  moving.update({walkingTrack(1, {1.0, -1.0}, {0.0, 1.0})}, Vector2d::Zero(), 0.0);
  EXPECT_TRUE(anyNear(moving.points(), {1.0, 0.0}, 0.4)) << "he is there after 1 s";
}

TEST(MovingObstaclesTest, TheGateOnlyRemovesPoints) {
  const Track track = walkingTrack(1, {2.0, -2.0}, {0.2, 1.0}, 0.1);
  const auto gated = pointsOf({track}, ObstaclePolicy::kTimeGated);
  const auto swept = pointsOf({track}, ObstaclePolicy::kSweep);
  EXPECT_LT(gated.size(), swept.size());
  for (const auto& point : gated) EXPECT_TRUE(anyNear(swept, point.place, 1e-12));
}

TEST(MovingObstaclesTest, CovarianceWidensThem) {
  const auto width = [](double sigma_m) {
    double widest = 0.0;
    const Track track = walkingTrack(1, {4.0, -3.0}, {0.0, 1.0}, sigma_m);
    for (const auto& point : pointsOf({track}, ObstaclePolicy::kSweep)) {
      widest = std::max(widest, std::abs(point.place.x() - 4.0));
    }
    return widest;
  };
  EXPECT_NEAR(width(0.3), width(0.0) + 0.3, 0.05);
}

TEST(MovingObstaclesTest, AnOldMapIsPredictedToNow) {
  const Track track = walkingTrack(1, {4.0, -3.0}, {0.0, 1.0});
  EXPECT_TRUE(anyNear(pointsOf({track}, ObstaclePolicy::kSweep, 0.0), {4.0, -3.25}, 0.15));
  EXPECT_FALSE(anyNear(pointsOf({track}, ObstaclePolicy::kSweep, 0.5), {4.0, -3.25}, 0.15));
}

TEST(MovingObstaclesTest, ImprobablePathsAreLeftOut) {
  Track track = walkingTrack(1, {4.0, -3.0}, {0.0, 1.0});
  track.predictions.push_back(walkingTrack(1, {4.0, -3.0}, {1.0, 0.0}).predictions.front());
  track.predictions[0].probability = 0.95;
  track.predictions[1].probability = 0.05;
  EXPECT_FALSE(anyNear(pointsOf({track}, ObstaclePolicy::kSweep), {6.0, -3.0}, 0.5));
  track.predictions[1].probability = 0.2;
  EXPECT_TRUE(anyNear(pointsOf({track}, ObstaclePolicy::kSweep), {6.0, -3.0}, 0.5));
}

TEST(MovingObstaclesTest, StaticTentativeAndEndedTracksAreIgnored) {
  Track standing = walkingTrack(1, {2.0, -2.0}, {0.0, 1.0});
  standing.motion_state = MotionState::kStatic;
  Track tentative = walkingTrack(2, {2.0, -2.0}, {0.0, 1.0});
  tentative.status = TrackStatus::kTentative;
  Track ended = walkingTrack(3, {2.0, -2.0}, {0.0, 1.0});
  ended.status = TrackStatus::kEnded;
  EXPECT_TRUE(pointsOf({standing, tentative, ended}, ObstaclePolicy::kSweep).empty());
}

TEST(MovingObstaclesTest, NoPointIsUnderTheRobot) {
  const Track over_it = walkingTrack(1, {0.0, -1.0}, {0.0, 1.0}, 0.5);
  for (const auto& point : pointsOf({over_it}, ObstaclePolicy::kSweep)) {
    EXPECT_GT(point.place.norm(), 0.3);
  }
}

TEST(MovingObstaclesTest, NumbersThatAreNoneMakeNoPoints) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Track lost = walkingTrack(1, {nan, 0.0}, {0.0, 1.0});
  Track strange = walkingTrack(2, {2.0, -2.0}, {0.0, 1.0});
  strange.predictions.front().points[7].position.x() = nan;
  strange.predictions.front().points[9].covariance.setConstant(nan);
  for (const auto& point : pointsOf({lost, strange}, ObstaclePolicy::kSweep)) {
    EXPECT_TRUE(point.place.allFinite());
  }
}

TEST(MovingObstaclesTest, SensedPointsGoOnlyWithObjectsThatLeave) {
  MovingObstacles moving(paramsOf(ObstaclePolicy::kTimeGated));
  const Track leaving = walkingTrack(1, {2.5, 0.0}, {0.0, 1.5});
  moving.update({leaving}, Vector2d::Zero(), 0.0);
  EXPECT_TRUE(moving.leavesInTime({2.3, 0.0}));
  EXPECT_FALSE(moving.leavesInTime({2.5, 1.5})) << "that is not he";
  const Track staying = walkingTrack(2, {2.5, 0.1}, {0.01, 0.0});
  moving.update({leaving, staying}, Vector2d::Zero(), 0.0);
  EXPECT_FALSE(moving.leavesInTime({2.3, 0.0})) << "another object stays there";
}

TEST(MovingObstaclesTest, AreTheSameEachTime) {
  const std::vector<Track> tracks = {walkingTrack(1, {2.0, -2.0}, {0.1, 1.0}, 0.2),
                                     walkingTrack(2, {3.0, 2.0}, {0.0, -1.2}, 0.1)};
  const auto first = pointsOf(tracks, ObstaclePolicy::kTimeGated);
  const auto second = pointsOf(tracks, ObstaclePolicy::kTimeGated);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].place, second[i].place);
}

TEST(MovingObstaclesTest, RefusesParametersOutOfRange) {
  PredictiveObstaclesParams params = paramsOf(ObstaclePolicy::kSweep);
  params.place_spacing_m = 0.0;
  EXPECT_EQ("[nav] place_spacing_m: '0' is out of range [m, 0.05 .. 2]",
            test::inputErrorOf([&] { MovingObstacles obstacles(params); }));
  params = {};
  params.robot.radius_m = -1.0;
  EXPECT_EQ("[nav] robot_radius_m: '-1' is out of range [m, 0.05 .. 5]",
            test::inputErrorOf([&] { MovingObstacles obstacles(params); }));
}

}  // namespace
}  // namespace headway::nav
