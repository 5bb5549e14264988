// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/map/contact_probability.h>
#include <headway/map/map_query.h>
#include <headway/map/static_grid.h>
#include <headway_test/input_error.h>
#include <headway_test/walking_track.h>

#include <cmath>
#include <limits>
#include <random>

namespace headway::map {
namespace {

using Eigen::Vector2d;
using mrpt::maps::COccupancyGridMap2D;
using test::walkingTrack;

constexpr double kNow = 100.0;

/// Free ground 20 m about, a wall at x = 8 m, nothing seen beyond it.
COccupancyGridMap2D::Ptr exampleGrid() {
  auto grid = COccupancyGridMap2D::Create(-20.f, 20.f, -20.f, 20.f, 0.2f);
  for (int y = 0; y < static_cast<int>(grid->getSizeY()); ++y) {
    for (int x = 0; x < static_cast<int>(grid->getSizeX()); ++x) {
      const float at = grid->idx2x(static_cast<std::size_t>(x));
      grid->setCell(x, y, at < 7.9f ? 0.98f : at < 8.2f ? 0.03f : 0.5f);
    }
  }
  return grid;
}

PerceptionMap mapWith(const std::vector<Track>& tracks) {
  PerceptionMap map;
  map.update(exampleGrid());
  map.update(kNow, tracks);
  return map;
}

/// Straight on at a speed from a place.
std::vector<TimedPose> drive(const Vector2d& from, const Vector2d& velocity, double span_s) {
  const double yaw = std::atan2(velocity.y(), velocity.x());
  return {{kNow, from, yaw}, {kNow + span_s, from + span_s * velocity, yaw}};
}

constexpr FootprintShape kRobot{0.5, 0.4, false};

TEST(ProbabilityInsideTest, MatchesMonteCarlo) {
  const auto region = contactRegion({0.8, 0.5, false}, 0.4, {0.5, 0.7, true}, -1.1);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Eigen::Matrix2d root;
  root << 0.5, 0.0, 0.3, 0.2;
  const Vector2d mean(0.4, -0.3);
  int inside = 0;
  const int draws = 40000;
  for (int i = 0; i < draws; ++i) {
    const double a = normal(random), b = normal(random);
    const Vector2d point = mean + root * Vector2d(a, b);
    bool in = true;
    for (std::size_t k = 0; k < region.size(); ++k) {
      const Vector2d edge = region[(k + 1) % region.size()] - region[k];
      const Vector2d to = point - region[k];
      in = in && edge.x() * to.y() - edge.y() * to.x() >= 0.0;
    }
    inside += in ? 1 : 0;
  }
  EXPECT_NEAR(probabilityInside(region, mean, root * root.transpose()),
              static_cast<double>(inside) / draws, 0.01);
}

TEST(ProbabilityInsideTest, IsCertainForAPlaceThatIs) {
  const auto region = contactRegion({1.0, 1.0, false}, 0.0, {1.0, 1.0, false}, 0.0);
  EXPECT_NEAR(probabilityInside(region, {0.5, 0.5}, Eigen::Matrix2d::Zero()), 1.0, 1e-3);
  EXPECT_NEAR(probabilityInside(region, {1.2, 0.5}, Eigen::Matrix2d::Zero()), 0.0, 1e-3);
  EXPECT_EQ(probabilityInside({}, {0.0, 0.0}, Eigen::Matrix2d::Identity()), 0.0);
}

TEST(ContactRegionTest, HoldsTheSumOfTwoBoxes) {
  const auto region = contactRegion({2.0, 1.0, false}, 0.0, {1.0, 0.5, false}, 0.0);
  double length = 0.0, width = 0.0;
  for (const auto& corner : region) {
    length = std::max(length, corner.x());
    width = std::max(width, corner.y());
  }
  EXPECT_NEAR(length, 1.5, 1e-12);
  EXPECT_NEAR(width, 0.75, 1e-12);
}

TEST(SamplePathTest, InterpolatesAndExtrapolates) {
  const Track track = walkingTrack(1, {1.0, 2.0}, {1.0, 0.0}, 0.2);
  const auto& path = track.predictions.front();
  EXPECT_NEAR(samplePath(track, path, -1.0).centre.x(), 1.0, 1e-12);
  EXPECT_NEAR(samplePath(track, path, 1.25).centre.x(), 2.25, 1e-9);
  EXPECT_NEAR(samplePath(track, path, 3.0).centre.x(), 4.0, 1e-9);
  EXPECT_NEAR(samplePath(track, path, 6.0).centre.x(), 7.0, 1e-9);
  EXPECT_NEAR(samplePath(track, path, 6.0).covariance(0, 0), 4.0 * 0.04, 1e-9);
  EXPECT_NEAR(samplePath(track, {}, 2.0).centre.x(), 1.0, 1e-12);
}

TEST(OccupancyAtTest, FollowsAMovingObjectOverTime) {
  const auto map = mapWith({walkingTrack(1, {2.0, -2.0}, {0.0, 1.0}, 0.05)});
  const MapQuery query = map.at(kNow);
  EXPECT_GT(query.occupancyAt(2.0, -2.0, kNow).probability, 0.95);
  EXPECT_LT(query.occupancyAt(2.0, -2.0, kNow + 2.0).probability, 0.05);
  EXPECT_GT(query.occupancyAt(2.0, 0.0, kNow + 2.0).moving_probability, 0.95);
  EXPECT_EQ(query.occupancyAt(2.0, 0.0, kNow + 2.0).status, QueryStatus::kKnown);
}

TEST(OccupancyAtTest, DecreasesWithTheUncertaintyOfTheObject) {
  const auto at = [](double sigma_m) {
    return mapWith({walkingTrack(1, {2.0, 0.0}, {0.0, 0.0}, sigma_m)})
        .at(kNow)
        .occupancyAt(2.0, 0.0, kNow)
        .moving_probability;
  };
  EXPECT_GT(at(0.05), at(0.2));
  EXPECT_GT(at(0.2), at(0.6));
  // A disc of radius r about a centre with deviation s: 1 - exp(-r^2 / 2 s^2).
  EXPECT_NEAR(at(0.2), 1.0 - std::exp(-0.25 * 0.25 / (2.0 * 0.04)), 0.01);
}

TEST(OccupancyAtTest, WeighsThePredictedPathsOfAnObject) {
  Track track = walkingTrack(1, {2.0, 0.0}, {0.0, 1.0}, 0.05);
  track.predictions.push_back(walkingTrack(1, {2.0, 0.0}, {0.0, -1.0}, 0.05).predictions.front());
  track.predictions[0].probability = 0.7;
  track.predictions[1].probability = 0.3;
  const auto map = mapWith({track});
  const MapQuery query = map.at(kNow);
  EXPECT_NEAR(query.occupancyAt(2.0, 2.0, kNow + 2.0).moving_probability, 0.7, 0.02);
  EXPECT_NEAR(query.occupancyAt(2.0, -2.0, kNow + 2.0).moving_probability, 0.3, 0.02);
  EXPECT_GT(query.occupancyAt(2.0, 0.0, kNow).moving_probability, 0.97) << "both start here";
}

TEST(OccupancyAtTest, CoversTheStaticMapOnly) {
  const auto map = mapWith({});
  const MapQuery query = map.at(kNow);
  EXPECT_LT(query.occupancyAt(0.0, 0.0, kNow).probability, 0.05);
  EXPECT_GT(query.occupancyAt(8.0, 0.0, kNow + 1.0).static_probability, 0.95);
  EXPECT_EQ(query.occupancyAt(12.0, 0.0, kNow).status, QueryStatus::kUnknownPlace)
      << "behind the wall";
  EXPECT_EQ(query.occupancyAt(1e6, 0.0, kNow).status, QueryStatus::kUnknownPlace)
      << "outside the map";
  EXPECT_EQ(query.occupancyAt(1e6, 0.0, kNow).static_probability, 0.5);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(query.occupancyAt(nan, nan, kNow).status, QueryStatus::kUnknownPlace);
}

TEST(MapQueryTest, DistinguishesStaleAndEmptyMapsAndUnknownTimes) {
  const auto map = mapWith({walkingTrack(1, {2.0, 0.0}, {0.0, 1.0}, 0.1)});
  EXPECT_EQ(map.at(kNow + 0.4).status(), QueryStatus::kKnown);
  EXPECT_EQ(map.at(kNow + 0.6).status(), QueryStatus::kStaleMap);
  EXPECT_EQ(map.at(kNow - 0.6).status(), QueryStatus::kStaleMap) << "it comes from the future";
  EXPECT_EQ(map.at(kNow + 0.6).occupancyAt(0.0, 0.0, kNow + 0.6).status, QueryStatus::kStaleMap);
  EXPECT_EQ(map.at(kNow + 0.6).obstaclesAt(kNow + 1.0).status, QueryStatus::kStaleMap);
  EXPECT_EQ(map.at(kNow + 0.6).timeToCollision(kRobot, drive({0, 0}, {1, 0}, 1.0)).status,
            QueryStatus::kStaleMap);
  EXPECT_EQ(map.at(kNow).obstaclesAt(kNow + 3.5).status, QueryStatus::kUnknownTime);
  EXPECT_EQ(map.at(kNow + 0.3).obstaclesAt(kNow).status, QueryStatus::kUnknownTime) << "the past";
  const PerceptionMap empty;
  EXPECT_EQ(empty.at(kNow).status(), QueryStatus::kEmptyMap);
  EXPECT_EQ(empty.at(kNow).tracksNear({0, 0}, 5.0, kNow).status, QueryStatus::kEmptyMap);
  EXPECT_EQ(empty.at(kNow).timeToCollision(kRobot, drive({0, 0}, {1, 0}, 1.0)).status,
            QueryStatus::kEmptyMap);
  EXPECT_EQ(toString(QueryStatus::kStaleMap), "stale_map");
}

TEST(ObstaclesAtTest, GivesEveryPredictedPathWithItsCovariance) {
  Track track = walkingTrack(7, {2.0, 0.0}, {0.0, 1.0}, 0.2);
  track.predictions.push_back(walkingTrack(7, {2.0, 0.0}, {1.0, 0.0}, 0.3).predictions.front());
  track.predictions[0].probability = 0.7;
  track.predictions[1].probability = 0.3;
  Track parked = walkingTrack(8, {-4.0, 1.0}, {0.0, 0.0}, 0.1);
  parked.predictions.clear();
  Track tentative = walkingTrack(9, {3.0, 3.0}, {0.0, 1.0}, 0.1);
  tentative.status = TrackStatus::kTentative;
  const auto map = mapWith({track, parked, tentative});
  const auto obstacles = map.at(kNow).obstaclesAt(kNow + 2.0);
  ASSERT_EQ(obstacles.items.size(), 3u);
  EXPECT_NEAR(obstacles.items[0].centre.y(), 2.0, 1e-9);
  EXPECT_NEAR(obstacles.items[0].velocity.y(), 1.0, 1e-9);
  EXPECT_NEAR(obstacles.items[0].yaw, M_PI / 2.0, 1e-9);
  EXPECT_NEAR(obstacles.items[0].probability, 0.7, 1e-12);
  EXPECT_NEAR(obstacles.items[1].centre.x(), 4.0, 1e-9);
  EXPECT_NEAR(obstacles.items[1].covariance(0, 0), 0.09, 1e-9);
  EXPECT_NEAR(obstacles.items[2].centre.x(), -4.0, 1e-9);
}

TEST(TracksNearTest, AreSortedByFutureDistance) {
  const auto map = mapWith({walkingTrack(1, {4.0, 0.0}, {0.0, 0.0}, 0.2),
                            walkingTrack(2, {0.0, -3.0}, {0.0, 1.0}, 0.1),
                            walkingTrack(3, {15.0, 0.0}, {0.0, 0.0}, 0.1)});
  const auto now = map.at(kNow).tracksNear({0.0, 0.0}, 5.0, kNow);
  ASSERT_EQ(now.items.size(), 2u);
  EXPECT_EQ(now.items[0].obstacle.id, TrackId{2});
  EXPECT_NEAR(now.items[0].distance_m, 2.75, 1e-9);
  EXPECT_NEAR(now.items[1].sigma_m, 0.2, 1e-9);
  const auto later = map.at(kNow).tracksNear({0.0, 0.0}, 5.0, kNow + 3.0);
  EXPECT_EQ(later.items.front().distance_m, 0.0) << "he stands on the place";
}

TEST(TimeToCollisionTest, IsWhenTheFootprintsMeet) {
  // Both at 1 m/s towards (3, 0): its corner (0.25, 0.2) touches his circle 0.4 m before it.
  const auto map = mapWith({walkingTrack(1, {3.0, -3.0}, {0.0, 1.0}, 0.02)});
  const auto collision = map.at(kNow).timeToCollision(kRobot, drive({0, 0}, {1, 0}, 3.0));
  EXPECT_EQ(collision.status, QueryStatus::kKnown);
  ASSERT_TRUE(collision.likely_s.has_value());
  EXPECT_NEAR(*collision.likely_s, 2.6, 0.1);
  EXPECT_LE(*collision.earliest_s, *collision.likely_s);
  EXPECT_NEAR(collision.probability, 1.0, 0.01);
  EXPECT_EQ(collision.with, TrackId{1});
  EXPECT_FALSE(collision.unknown_from_s);
}

TEST(TimeToCollisionTest, IsNoneWhereTheObjectHasPassed) {
  const auto map = mapWith({walkingTrack(1, {3.0, -1.0}, {0.0, 1.0}, 0.02)});
  const auto collision = map.at(kNow).timeToCollision(kRobot, drive({0, 0}, {1, 0}, 3.0));
  EXPECT_FALSE(collision.earliest_s);
  EXPECT_LT(collision.probability, 0.05);
}

TEST(TimeToCollisionTest, UncertaintyMakesItEarlierAndLessProbable) {
  const auto at = [](double sigma_m) {
    return mapWith({walkingTrack(1, {3.0, -3.0}, {0.0, 1.0}, sigma_m)})
        .at(kNow)
        .timeToCollision(kRobot, drive({0, 0}, {1, 0}, 3.0));
  };
  EXPECT_LT(*at(0.5).earliest_s, *at(0.05).earliest_s);
  EXPECT_LT(at(0.5).probability, at(0.05).probability);
}

TEST(TimeToCollisionTest, FindsTheWallAndTheEndOfTheMap) {
  const auto map = mapWith({});
  const auto wall = map.at(kNow).timeToCollision(kRobot, drive({6, 0}, {1, 0}, 2.5));
  EXPECT_NEAR(wall.likely_s.value_or(9.0), 1.65, 0.21);
  EXPECT_FALSE(wall.with) << "the static map";
  const auto out = map.at(kNow).timeToCollision(kRobot, drive({0, 19}, {0, 1}, 2.5));
  EXPECT_EQ(out.status, QueryStatus::kUnknownPlace);
  EXPECT_NEAR(out.unknown_from_s.value_or(9.0), 0.8, 0.21);
  EXPECT_FALSE(out.earliest_s);
  const auto outside = map.at(kNow).timeToCollision(kRobot, drive({500, 0}, {1, 0}, 1.0));
  EXPECT_EQ(outside.unknown_from_s, 0.0) << "a robot outside the map";
}

TEST(TimeToCollisionTest, FindsAnObstacleThatOnlyALaserScanSaw) {
  const auto collisionWith = [](std::vector<GroundScan::Obstacle> laser_obstacles) {
    GroundScan scan;
    for (float y = -1.0F; y <= 1.0F; y += 0.1F) scan.free.push_back({{-1, y, 0}, {5, y, 0}});
    scan.laser_obstacles = std::move(laser_obstacles);
    StaticGrid grid({});
    // One scan of stereo is not significant; places 1 m apart are.
    for (const double x : {0.0, 1.1}) {
      Pose T_map_robot = Pose::Identity();
      T_map_robot.translation().x() = x;
      auto there = scan;
      for (auto& obstacle : there.laser_obstacles) obstacle.foot.x() -= static_cast<float>(x);
      grid.add(T_map_robot, there);
    }
    PerceptionMap map;
    map.update(grid.grid());
    map.update(kNow, {});
    return map.at(kNow).timeToCollision(kRobot, drive({0, 0}, {1, 0}, 3.0));
  };
  const auto collision = collisionWith({{{3.1F, 0.0F, 0.0F}, 0.02F}});
  EXPECT_EQ(collision.status, QueryStatus::kKnown);
  EXPECT_NEAR(collision.likely_s.value_or(9.0), 2.75, 0.21);
  EXPECT_FALSE(collision.with) << "the static map";
  EXPECT_FALSE(collisionWith({}).earliest_s) << "stereo saw free ground there";
}

TEST(TimeToCollisionTest, EndsWherePredictionsEndWhateverThePath) {
  const auto map = mapWith({walkingTrack(1, {3.0, -3.0}, {0.0, 1.0}, 0.02)});
  const auto lengthy = map.at(kNow).timeToCollision(kRobot, drive({0, 5}, {0.1, 0}, 1e9));
  EXPECT_EQ(lengthy.status, QueryStatus::kUnknownTime);
  EXPECT_NEAR(lengthy.unknown_from_s.value_or(0.0), 3.05, 1e-6);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto strange = map.at(kNow).timeToCollision(kRobot, {{nan, {nan, 0.0}, nan}});
  EXPECT_NE(strange.status, QueryStatus::kKnown);
  EXPECT_FALSE(map.at(kNow).timeToCollision(kRobot, {}).earliest_s);
}

/// Questions in odometry have the answers of the map, at the same places.
TEST(MapQueryTest, AnswersInTheOdometryFrameAsInTheMap) {
  Pose T_map_odom = Pose::Identity();
  T_map_odom.translation() << 6.0, -11.0, 0.3;
  T_map_odom.linear() = expSo3({0.0, 0.0, 2.1});
  PerceptionMap map;
  map.update(exampleGrid());
  map.update(kNow, {walkingTrack(1, {4.0, -2.0}, {0.0, 1.0}, 0.2)}, T_map_odom);
  EXPECT_EQ(map.odometryFrame().matrix(), T_map_odom.matrix());
  const MapQuery in_map = map.at(kNow);
  const MapQuery in_odom = map.inOdometryAt(kNow);
  const Pose T_odom_map = T_map_odom.inverse();
  const auto asked = [&](const Vector2d& place) -> Vector2d {
    return (T_odom_map * Eigen::Vector3d(place.x(), place.y(), 0.0)).head<2>();
  };
  for (const Vector2d& place : {Vector2d(4.0, -1.0), Vector2d(8.0, 3.0), Vector2d(9.0, 0.0)}) {
    const auto expected = in_map.occupancyAt(place.x(), place.y(), kNow + 1.0);
    const Vector2d at = asked(place);
    const auto answer = in_odom.occupancyAt(at.x(), at.y(), kNow + 1.0);
    EXPECT_EQ(answer.status, expected.status);
    EXPECT_NEAR(answer.probability, expected.probability, 1e-9);
  }
  const auto expected = in_map.obstaclesAt(kNow + 1.0);
  const auto obstacles = in_odom.obstaclesAt(kNow + 1.0);
  ASSERT_EQ(obstacles.items.size(), expected.items.size());
  const Obstacle& a = expected.items.at(0);
  const Obstacle& b = obstacles.items.at(0);
  EXPECT_TRUE(b.centre.isApprox(asked(a.centre), 1e-9));
  const Eigen::Rotation2Dd turn(-2.1);
  EXPECT_TRUE(b.velocity.isApprox(turn * a.velocity, 1e-9));
  EXPECT_NEAR(wrapAngle(b.yaw - (a.yaw - 2.1)), 0.0, 1e-9);
  const Eigen::Matrix2d R = turn.toRotationMatrix();
  EXPECT_TRUE(b.covariance.isApprox(R * a.covariance * R.transpose(), 1e-9));
  const auto near_map = in_map.tracksNear({4.0, -4.0}, 5.0, kNow);
  const auto near_odom = in_odom.tracksNear(asked({4.0, -4.0}), 5.0, kNow);
  ASSERT_EQ(near_map.items.size(), 1U);
  ASSERT_EQ(near_odom.items.size(), 1U);
  EXPECT_NEAR(near_odom.items[0].distance_m, near_map.items[0].distance_m, 1e-9);
  EXPECT_NEAR(near_odom.items[0].sigma_m, near_map.items[0].sigma_m, 1e-9);
  std::vector<TimedPose> path = drive({0.0, -1.0}, {2.0, 0.0}, 3.0);
  const auto hit = in_map.timeToCollision(kRobot, path);
  for (TimedPose& pose : path) pose = {pose.time, asked(pose.position), pose.yaw - 2.1};
  const auto same = in_odom.timeToCollision(kRobot, path);
  EXPECT_EQ(same.status, hit.status);
  EXPECT_NEAR(same.probability, hit.probability, 1e-9);
  ASSERT_TRUE(hit.worst_s && same.worst_s);
  EXPECT_NEAR(*same.worst_s, *hit.worst_s, 1e-9);
}

TEST(MapQueryTest, RefusesParametersOutOfRange) {
  MapQueryParams params;
  params.horizon_s = -1.0;
  EXPECT_EQ("[map_query] horizon_s: '-1' is out of range [s, 0 .. 60]",
            test::inputErrorOf([&] { MapQuery query(PerceptionMap(), kNow, params); }));
}

}  // namespace
}  // namespace headway::map
