// SPDX-License-Identifier: BSD-3-Clause
// What is blocked and free now: evidence of frames, the blind zone, and what may have entered it.
#include <gtest/gtest.h>
#include <headway/map/local_layer.h>
#include <headway/map/map_query.h>
#include <headway_test/walking_track.h>

#include <cmath>

namespace headway::map {
namespace {

using Eigen::Vector2d;

constexpr RobotFootprint kFootprint{0.5, 0.4};
constexpr double kStep_s = 0.1;

/// 0.5 m high, looking 10 degrees down: it sees the ground from 0.7 m on, to 42 degrees aside.
StereoCamera camera() {
  StereoCamera camera;
  camera.width = 1280;
  camera.height = 720;
  camera.fx = camera.fy = 700.0;
  camera.cx = 639.5;
  camera.cy = 359.5;
  camera.baseline_m = 0.12;
  camera.T_robot_cam.linear() = expSo3({0.0, 10.0 * kDegree, 0.0}) * robotFromOptical().linear();
  camera.T_robot_cam.translation().z() = 0.5;
  return camera;
}

struct Scene {
  std::vector<Vector2d> things;  ///< 0.2 m wide [m]
  double ground_to_m = 5.0;
  float low_m = 0.0F, high_m = 0.0F;  ///< heights at which things are seen; 0: unknown
};

/// What a camera at the robot's origin sees of a scene, in columns of half a degree.
GroundScan scanOf(const Scene& scene) {
  GroundScan scan;
  for (double bearing = -40.0; bearing <= 40.0; bearing += 0.5) {
    const Vector2d ray(std::cos(bearing * kDegree), std::sin(bearing * kDegree));
    double to = scene.ground_to_m;
    for (const Vector2d& thing : scene.things) {
      const double along = ray.dot(thing);
      if (along < 0.0 || (thing - along * ray).norm() > 0.1) continue;
      to = std::min(to, along);
    }
    const Vector2d from = 0.75 / ray.x() * ray;
    const auto at = [&](double distance) {
      const Vector2d place = distance * ray;
      return Eigen::Vector3f(static_cast<float>(place.x()), static_cast<float>(place.y()), 0.0F);
    };
    if (to > from.norm()) scan.free.push_back({at(from.norm()), at(to - 0.05)});
    if (to == scene.ground_to_m) continue;
    scan.obstacles.push_back({at(to), 0.03F, scene.low_m, scene.high_m});
  }
  return scan;
}

/// A layer that takes frames of scenes, of a robot that stands at the origin.
struct Frames {
  LocalLayer layer{5.0, kFootprint};
  Time now = 100.0;

  void see(const GroundScan& scan, int frames = 5) {
    for (int i = 0; i < frames; ++i) layer.add(now += kStep_s, Pose::Identity(), scan, camera());
  }
  void see(const Scene& scene, int frames = 5) { see(scanOf(scene), frames); }
  [[nodiscard]] LocalState at(double x, double y, double caution = kCaution) const {
    return layer.at({x, y}, now, caution);
  }
};

TEST(LocalLayerTest, NothingIsFreeBeforeItWasSeen) {
  Frames frames;
  EXPECT_EQ(LocalState::kNotInView, frames.at(2.0, 0.0));
  frames.see(GroundScan());
  EXPECT_EQ(LocalState::kUnknown, frames.at(2.0, 0.0));
  EXPECT_EQ(LocalState::kNotInView, frames.at(-2.0, 0.0));
  EXPECT_EQ(LocalState::kFree, frames.at(0.0, 0.0)) << "the robot stands there";
}

TEST(LocalLayerTest, AnswersByTheNewestFrames) {
  Frames frames;
  frames.see(Scene());
  EXPECT_EQ(LocalState::kFree, frames.at(2.0, 0.0));
  frames.see({{{2.0, 0.0}}}, 1);
  EXPECT_NE(LocalState::kFree, frames.at(2.0, 0.0)) << "at once";
  frames.see({{{2.0, 0.0}}}, 1);
  EXPECT_EQ(LocalState::kBlocked, frames.at(2.0, 0.0));
  frames.see({{{2.0, 0.0}}});
  EXPECT_EQ(LocalState::kUnknown, frames.at(3.0, 0.0)) << "hidden";
  EXPECT_FALSE(frames.layer.blocked(frames.now, kCaution).empty());
  frames.see(Scene());
  EXPECT_EQ(LocalState::kFree, frames.at(2.0, 0.0)) << "it has left";
  EXPECT_TRUE(frames.layer.blocked(frames.now, kCaution).empty());
  frames.now += 1.0;
  EXPECT_EQ(LocalState::kUnknown, frames.at(2.0, 0.0)) << "not seen for a second";
}

TEST(LocalLayerTest, WhoComesWalkingIsBlockedInEachFrameAndDoesNotVanishWhenNear) {
  Frames frames;
  frames.layer = LocalLayer(5.0, kFootprint, 1.0);
  frames.see(Scene());
  double ahead = 3.0;
  for (; ahead > 1.05; ahead -= 0.13) {  // 1.3 m/s at 10 Hz
    frames.see({{{ahead, -0.1}, {ahead, 0.1}}}, 1);
    EXPECT_NE(LocalState::kFree, frames.at(ahead, 0.0)) << ahead;
    if (ahead > 2.8) continue;
    EXPECT_EQ(LocalState::kBlocked, frames.at(ahead, 0.0)) << ahead;
  }
  Scene hidden;  // nearer than what is measured: nothing is seen of them, nor of what they hide
  GroundScan scan = scanOf(hidden);
  const auto is_hidden = [](const auto& piece) {
    return std::abs(piece.to.y()) < 0.4F * piece.to.x();
  };
  auto& free = scan.free;
  free.erase(std::remove_if(free.begin(), free.end(), is_hidden), free.end());
  for (int i = 0; i < 15; ++i) {
    frames.see(scan, 1);
    EXPECT_NE(LocalState::kFree, frames.at(0.7, 0.0)) << "they may be there";
    if (i < 3) continue;
    EXPECT_NE(LocalState::kFree, frames.at(0.5, 0.0)) << "as far as they walk in that time";
  }
}

TEST(LocalLayerTest, OneWrongColumnBlocksNothing) {
  Frames frames;
  frames.see(Scene());
  GroundScan scan = scanOf(Scene());
  scan.obstacles.push_back({{2.0F, 0.0F, 0.0F}, 0.03F});
  frames.see(scan, 1);
  EXPECT_EQ(LocalState::kFree, frames.at(2.0, 0.0));
}

TEST(LocalLayerTest, TheStripBeforeTheRobotIsFreeAsTheGroundBehindIt) {
  Frames frames;
  frames.see(Scene());
  EXPECT_EQ(LocalState::kFree, frames.at(0.45, 0.0));
  Frames far_ground;
  GroundScan scan;
  for (const auto& piece : scanOf(Scene()).free) scan.free.push_back({2.0F * piece.from, piece.to});
  far_ground.see(scan);
  EXPECT_NE(LocalState::kFree, far_ground.at(0.45, 0.0)) << "ground in view is missing";
}

TEST(LocalLayerTest, WhatLeavesTheViewBlocksForAsLongAsCautionAsks) {
  Frames frames;
  frames.see(Scene());
  for (const double y : {1.2, 1.4, 1.6}) frames.see({{{2.0, y}}}, 3);  // the view ends at 1.8 m
  frames.see(Scene());
  EXPECT_EQ(LocalState::kEntered, frames.at(2.0, 2.1));
  EXPECT_EQ(LocalState::kNotInView, frames.at(2.0, 2.1, 0.0)) << "without caution";
  EXPECT_EQ(LocalState::kNotInView, frames.at(-2.0, -2.0)) << "farther than a person walks";
  EXPECT_EQ(LocalState::kFree, frames.at(2.0, 0.0)) << "it is seen to be free";
  frames.see(Scene(), 40);
  EXPECT_EQ(LocalState::kNotInView, frames.at(2.0, 2.1));
}

TEST(LocalLayerTest, WhoWalksPastIsSoonBehind) {
  Frames frames;
  frames.layer = LocalLayer(5.0, kFootprint, 1.0);
  frames.see(Scene());
  for (double ahead = 3.0; ahead > 1.05; ahead -= 0.13) {  // 1.3 m/s, 0.7 m beside
    frames.see({{{ahead, 0.6}, {ahead, 0.7}, {ahead, 0.8}}}, 1);
  }
  frames.see(Scene(), 3);
  EXPECT_EQ(LocalState::kEntered, frames.at(0.6, 0.7)) << "where they are next";
  frames.see(Scene(), 7);
  EXPECT_EQ(LocalState::kFree, frames.at(0.45, 0.0)) << "they have passed";
  EXPECT_EQ(LocalState::kEntered, frames.at(-0.4, 0.6)) << "and are beside or behind";
  frames.see(Scene(), 10);
  EXPECT_EQ(LocalState::kEntered, frames.at(-1.7, 0.7));
}

TEST(LocalLayerTest, GroundSeenOverThePlaceOfWhoStoodInTheWayFreesIt) {
  const auto afterwards = [](float low_m, float high_m) {
    Frames frames;  // ground in view begins at 0.75 m
    frames.see(Scene());
    frames.see({{{0.6, -0.1}, {0.6, 0.0}, {0.6, 0.1}}, 5.0, low_m, high_m}, 4);
    EXPECT_EQ(LocalState::kBlocked, frames.at(0.6, 0.0));
    frames.see(Scene(), 4);
    return frames.at(0.6, 0.0);
  };
  EXPECT_EQ(LocalState::kFree, afterwards(0.2F, 1.7F)) << "they would hide that ground";
  EXPECT_EQ(LocalState::kBlocked, afterwards(0.0F, 0.2F)) << "a box, over which it is seen";
  EXPECT_EQ(LocalState::kBlocked, afterwards(0.6F, 0.8F)) << "a bar, under which it is seen";
  EXPECT_EQ(LocalState::kBlocked, afterwards(0.0F, 0.0F)) << "of unknown height";
}

TEST(LocalLayerTest, WhatComesBackFromTheEdgeHasNotLeft) {
  Frames frames;
  frames.see(Scene());
  frames.see({{{2.0, 1.6}}}, 3);
  for (const double y : {1.5, 1.4, 1.3, 1.2, 1.1, 1.0}) frames.see({{{2.0, y}}}, 2);
  EXPECT_EQ(LocalState::kNotInView, frames.at(2.0, 2.1));
}

TEST(LocalLayerTest, SaysWhereWhoLeftTheViewMayBeLater) {
  Frames frames;
  frames.see(Scene());
  for (const double y : {1.2, 1.4, 1.6}) frames.see({{{2.0, y}}}, 3);
  frames.see(Scene());
  const auto within = [&](double y, double seconds) {
    return frames.layer.at({2.0, y}, frames.now, kCaution, seconds);
  };
  EXPECT_EQ(LocalState::kNotInView, within(2.9, 0.0));
  EXPECT_EQ(LocalState::kEntered, within(2.9, 1.0));
  EXPECT_EQ(LocalState::kFree, within(0.5, 1.0)) << "not where they come from";
  frames.see(Scene(), 40);
  EXPECT_EQ(LocalState::kNotInView, within(2.9, 1.0)) << "for as long as caution asks";
}

TEST(LocalLayerTest, WhatStoodBesideTheRobotBlocksForLongerThanWhatPassed) {
  const auto turned = [](Frames& frames, double seconds) {  // away, so that it is out of view
    const Pose away(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()));
    for (double s = 0.0; s < seconds; s += kStep_s) {
      frames.layer.add(frames.now += kStep_s, away, scanOf(Scene()), camera());
    }
  };
  Frames stood;
  stood.see({{{1.0, 0.3}}}, 30);
  turned(stood, 6.0);
  EXPECT_EQ(LocalState::kBlocked, stood.at(1.0, 0.3));
  turned(stood, 6.0);
  EXPECT_EQ(LocalState::kNotInView, stood.at(1.0, 0.3));
  Frames passed;
  passed.see(Scene(), 30);
  passed.see({{{1.0, 0.3}}}, 5);
  turned(passed, 4.0);
  EXPECT_NE(LocalState::kBlocked, passed.at(1.0, 0.3));
}

TEST(LocalLayerTest, WhoWalksElsewhereDoesNotBringBackWhoLeft) {
  Frames frames;
  frames.see(Scene());
  double y = 0.0;
  for (; y < 1.75; y += 0.13) {  // leaves to the left, 1.3 m/s
    frames.see({{{2.0, y}, {2.0, y - 0.1}, {2.0, y + 0.1}}}, 1);
  }
  frames.see(Scene(), 5);
  EXPECT_EQ(LocalState::kEntered, frames.at(2.0, 2.5));
  frames.see({{{2.0, 0.8}, {2.0, 0.9}, {2.0, 1.0}}}, 2);
  EXPECT_EQ(LocalState::kEntered, frames.at(2.0, 2.7)) << "somebody else";
}

TEST(LocalLayerTest, LasersBlockAndNeverFree) {
  Frames frames;
  GroundScan scan;
  scan.laser_obstacles.push_back({{-1.5F, 0.0F, 0.0F}, 0.03F});
  scan.laser_passed.push_back({{0.0F, 0.0F, 0.0F}, {-1.4F, 0.0F, 0.0F}});
  frames.see(scan);
  EXPECT_EQ(LocalState::kBlocked, frames.at(-1.5, 0.0));
  EXPECT_EQ(LocalState::kNotInView, frames.at(-1.0, 0.0));
}

TEST(LocalLayerTest, PlacesStayWhereTheyAreWhileTheRobotMoves) {
  LocalLayer layer(5.0, kFootprint);
  Time now = 100.0;
  for (int i = 0; i < 400; ++i) {
    const Pose pose(Eigen::Translation3d(0.05 * i, 0.0, 0.0));
    layer.add(now += kStep_s, pose, scanOf({{{2.0, 0.0}}}), camera());
  }
  const double x = 0.05 * 399;
  EXPECT_EQ(LocalState::kBlocked, layer.at({x + 2.0, 0.0}, now, kCaution));
  EXPECT_EQ(LocalState::kFree, layer.at({x + 1.0, 0.0}, now, kCaution));
  EXPECT_EQ(LocalState::kNotInView, layer.at({2.0, 0.0}, now, kCaution)) << "out of reach";
}

TEST(LocalLayerTest, AClockSetBackForgetsAll) {
  Frames frames;
  frames.see(Scene());
  frames.layer.add(50.0, Pose::Identity(), GroundScan(), camera());
  EXPECT_EQ(LocalState::kUnknown, frames.layer.at({2.0, 0.0}, 50.0, kCaution));
}

/// The map of a robot at the origin: a grid in which all ground is free but what is at x = 3 m.
PerceptionMap mapOf(const Frames& frames, const std::vector<Track>& tracks = {}) {
  PerceptionMap map;
  auto grid = mrpt::maps::COccupancyGridMap2D::Create(-6.0F, 6.0F, -6.0F, 6.0F, 0.2F);
  grid->fill(0.95F);
  grid->setPos(3.0F, 0.0F, 0.05F);
  map.update(grid);
  map.update(frames.now, tracks);
  map.update(std::make_shared<const LocalLayer>(frames.layer));
  return map;
}

bool isFree(const PerceptionMap& map, Time now, const Vector2d& place, Time later = 0.0) {
  const TimedPose pose{now + later, place, 0.0};
  return map.at(now).timeToCollision({0.4, 0.4, true}, {pose}).isFree();
}

TEST(LocalLayerTest, QueriesTakeItBeforeTheMap) {
  Frames frames;
  frames.see({{{2.0, 0.5}}});
  const PerceptionMap map = mapOf(frames);
  EXPECT_FALSE(isFree(map, frames.now, {2.0, 0.5})) << "free in the map, blocked now";
  EXPECT_FALSE(isFree(map, frames.now, {3.0, 0.75})) << "free in the map, hidden now";
  EXPECT_TRUE(isFree(map, frames.now, {3.0, 0.0})) << "occupied in the map, free now";
  EXPECT_TRUE(isFree(map, frames.now, {-2.0, 0.0})) << "behind, as the map says";
  EXPECT_EQ(LocalState::kBlocked, map.at(frames.now).localAt({2.0, 0.5}));
  EXPECT_NEAR(0.95, map.at(frames.now).occupancyAt(2.0, 0.5, frames.now).probability, 1e-9);
}

TEST(LocalLayerTest, QueriesWithoutAMapUseItAlone) {
  Frames frames;
  frames.see({{{2.0, 0.5}}});
  PerceptionMap map;
  map.update(frames.now, {});
  map.update(std::make_shared<const LocalLayer>(frames.layer));
  EXPECT_TRUE(isFree(map, frames.now, {2.0, -0.5}));
  EXPECT_FALSE(isFree(map, frames.now, {2.0, 0.5}));
  EXPECT_FALSE(isFree(map, frames.now, {-2.0, 0.0})) << "never seen";
}

TEST(LocalLayerTest, WhatATrackMovesAwayIsWhereItIsPredicted) {
  Frames frames;
  frames.see(Scene());
  frames.see({{{2.0, 0.0}}}, 2);
  const Track walker = test::walkingTrack(1, {2.0, 0.0}, {0.0, 1.2}, 0.05);
  const PerceptionMap map = mapOf(frames, {walker});
  const PerceptionMap unknown_thing = mapOf(frames);
  EXPECT_FALSE(isFree(map, frames.now, {2.0, 0.0}));
  const Collision later =
      map.at(frames.now)
          .timeToCollision({0.4, 0.4, true}, {{frames.now, {-1.0, 0.0}, 0.0},
                                              {frames.now + 1.9, {-1.0, 0.0}, 0.0},
                                              {frames.now + 2.0, {2.0, 0.0}, 0.0}});
  EXPECT_LT(later.probability, 0.2);
  EXPECT_FALSE(isFree(unknown_thing, frames.now, {2.0, 0.0}, 2.0));
}

}  // namespace
}  // namespace headway::map
