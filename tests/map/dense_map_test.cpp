// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/core/statistics.h>
#include <headway/map/dense_map.h>

#include <thread>

#include "depth_scans.h"

namespace headway::map {
namespace {

using mrpt::maps::CColouredPointsMap;

constexpr double kVoxel = 0.1;

DenseMapParams params() {
  DenseMapParams params;
  params.voxel_m = kVoxel;
  params.reach_m = 15.0;
  params.spacing_m = 0.5;
  return params;
}

std::vector<Pose> driveForward() {
  std::vector<Pose> poses;
  for (int i = 0; i < 8; ++i) poses.push_back(robotAt(0.1 + i, 0.0));
  return poses;
}

DenseMap drive(const DepthWorld& world = {}) {
  DenseMap dense(params());
  std::uint64_t seed = 1;
  for (const auto& pose : driveForward()) {
    DepthWorld seen = world;
    seen.seed = seed++;
    dense.add(pose, depthScanFrom(pose, seen));
  }
  return dense;
}

const Eigen::Vector3d kSeenBox(9.0, 0.3, 0.0);

/// Scans of one time with a box in them.
DenseMap driveAtTime(Time time) {
  DepthWorld with_box;
  with_box.box = kSeenBox;
  DenseMap dense(params());
  for (const auto& pose : driveForward()) {
    DepthScan scan = depthScanFrom(pose, with_box);
    scan.time = time;
    dense.add(pose, scan);
  }
  return dense;
}

/// The track of that box, which passes its place at 10 s with 1 m/s.
Track trackSince(Time first_seen, double followed_s) {
  Track track;
  track.motion_state = MotionState::kMoving;
  track.size = Eigen::Vector3d::Ones();
  track.first_seen = first_seen;
  for (int i = 0; i < 5; ++i) {
    const Time time = first_seen + 0.25 * followed_s * i;
    const Eigen::Vector3d position = kSeenBox + Eigen::Vector3d(0.0, time - 10.0, 0.5);
    track.recent_path.push_back({static_cast<std::size_t>(i), time, position, 0.0});
  }
  return track;
}

std::vector<Eigen::Vector3d> positionsOf(const CColouredPointsMap& layer) {
  std::vector<Eigen::Vector3d> positions;
  for (std::size_t i = 0; i < layer.size(); ++i) {
    Eigen::Vector3f p;
    layer.getPointFast(i, p.x(), p.y(), p.z());
    positions.push_back(p.cast<double>());
  }
  return positions;
}

/// Distance to the ground or the wall.
double errorOf(const Eigen::Vector3d& position) {
  return std::min(std::abs(position.z()), std::abs(position.x() - kWallX));
}

double medianError(const CColouredPointsMap& layer) {
  std::vector<double> errors;
  for (const auto& position : positionsOf(layer)) errors.push_back(errorOf(position));
  return median(std::move(errors));
}

/// Points of the box, which is farther from ground and wall than any noise.
std::size_t pointsOfBox(const CColouredPointsMap& layer, const Eigen::Vector3d& foot) {
  const auto positions = positionsOf(layer);
  return static_cast<std::size_t>(
      std::count_if(positions.begin(), positions.end(), [&](const Eigen::Vector3d& position) {
        const Eigen::Array3d from = (position - foot).array();
        return from.head<2>().abs().maxCoeff() < 0.7 && from.z() > 0.3 && from.z() < 1.2;
      }));
}

bool areEqual(const CColouredPointsMap& a, const CColouredPointsMap& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::array<float, 6> x{}, y{};
    a.getPointRGB(i, x[0], x[1], x[2], x[3], x[4], x[5]);
    b.getPointRGB(i, y[0], y[1], y[2], y[3], y[4], y[5]);
    if (x != y) return false;
  }
  return true;
}

SharedChunks<slam::KeyframeView> keyframeAt(const Pose& T_map_robot) {
  slam::KeyframeView keyframe;
  keyframe.id = KeyframeId{3};
  keyframe.T_map_robot = T_map_robot;
  return {keyframe};
}

TEST(DenseMapTest, CoversSurfacesWithOnePointInAVoxel) {
  const auto layer = drive().layer();
  ASSERT_NE(layer, nullptr);
  std::set<std::array<int, 2>> ground, wall;
  for (const auto& p : positionsOf(*layer)) {
    EXPECT_LT(errorOf(p), 0.5 * kVoxel);
    const auto step = [](double value) { return static_cast<int>(std::floor(value / kVoxel)); };
    if (std::abs(p.z()) < 0.02 && p.x() < 11.8) ground.insert({step(p.x()), step(p.y())});
    if (std::abs(p.x() - kWallX) < 0.02) wall.insert({step(p.y()), step(p.z())});
  }
  std::size_t covered = 0;
  for (int x = 45; x < 110; ++x) {
    for (int y = -15; y < 15; ++y) covered += ground.count({x, y});
  }
  EXPECT_GT(covered, 0.9 * 65 * 30);
  EXPECT_GT(wall.size(), 20U * 20U);
}

TEST(DenseMapTest, FillsGroundBetweenTheRowsOfTheImages) {
  DenseMap dense(params());
  for (const double x : {0.1, 0.7}) dense.add(robotAt(x, 0.0), depthScanFrom(robotAt(x, 0.0)));
  std::set<std::array<int, 2>> ground;
  for (const auto& p : positionsOf(*dense.layer())) {
    EXPECT_LT(errorOf(p), p.x() < 10.0 ? 0.5 * kVoxel : kVoxel) << "but at the foot of the wall";
    const auto step = [](double value) { return static_cast<int>(std::floor(value / kVoxel)); };
    ground.insert({step(p.x()), step(p.y())});
  }
  std::size_t covered = 0;  // rows are 0.2 to 0.8 m apart here
  for (int x = 50; x < 100; ++x) {
    for (int y = -15; y < 15; ++y) covered += ground.count({x, y});
  }
  EXPECT_GT(covered, 0.95 * 50 * 30);
}

TEST(DenseMapTest, FillsNothingBetweenSurfacesAtDifferentDepths) {
  DepthWorld with_box;
  with_box.box = Eigen::Vector3d(9.0, 0.3, 0.0);
  for (const auto& p : positionsOf(*drive(with_box).layer())) {
    const bool is_between = p.x() > 9.6 && p.x() < kWallX - 0.1 && p.z() > 0.1;
    EXPECT_FALSE(is_between) << p.transpose();
  }
}

TEST(DenseMapTest, MakesThinSurfacesOfNoisyDepths) {
  DepthWorld noisy;
  noisy.noise_px = 0.3;  // 0.29 m at 12 m
  const auto layer = drive(noisy).layer();
  EXPECT_LT(medianError(*layer), 0.5 * kVoxel);
}

TEST(DenseMapTest, TakesTheColoursOfTheImages) {
  for (const bool with_colour : {true, false}) {
    DepthWorld world;
    world.with_colour = with_colour;
    const auto layer = drive(world).layer();
    for (std::size_t i = 0; i < layer->size(); ++i) {
      std::array<float, 3> p{}, colour{};
      layer->getPointRGB(i, p[0], p[1], p[2], colour[0], colour[1], colour[2]);
      if (std::abs(p[0] - 12.0F) > 0.02F || p[2] < 0.2F) continue;
      EXPECT_NEAR(colour[0], 200.0 / 255.0, 0.01);
      EXPECT_NEAR(colour[1], (with_colour ? 50.0 : 200.0) / 255.0, 0.01);
    }
  }
}

TEST(DenseMapTest, RemovesWhatHasLeftAndEntersWhatHasCome) {
  DepthWorld with_box;
  with_box.box = Eigen::Vector3d(9.0, 0.3, 0.0);
  DenseMap dense = drive(with_box);
  EXPECT_GT(pointsOfBox(*dense.layer(), *with_box.box), 40U);
  // On other places, so that the scans of the box remain.
  for (const auto& pose : driveForward()) {
    const Pose beside = pose * robotAt(0.0, 0.6);
    dense.add(beside, depthScanFrom(beside));
  }
  EXPECT_EQ(pointsOfBox(*dense.layer(), *with_box.box), 0U);
  for (const auto& pose : driveForward()) {
    const Pose beside = pose * robotAt(0.0, -0.6);
    dense.add(beside, depthScanFrom(beside, with_box));
  }
  EXPECT_GT(pointsOfBox(*dense.layer(), *with_box.box), 40U);
}

TEST(DenseMapTest, AMovingObjectThatWasNotNoticedLeavesNoTrail) {
  DenseMap dense(params());
  double x = 6.0;
  for (const auto& pose : driveForward()) {
    DepthWorld world;
    world.box = Eigen::Vector3d(x, -0.8, 0.0);
    dense.add(pose, depthScanFrom(pose, world));
    x += 1.5;
    if (x > 11.0) break;
  }
  for (const auto& pose : driveForward()) dense.add(pose, depthScanFrom(pose));
  for (const auto& p : positionsOf(*dense.layer())) EXPECT_LT(errorOf(p), 0.5 * kVoxel);
}

TEST(DenseMapTest, LeavesOutWhereAnObjectWasBeforeItWasKnown) {
  const DenseMap seen = driveAtTime(10.0);
  const auto wallOf = [](DenseMap dense) {
    const auto positions = positionsOf(*dense.layer());
    return std::count_if(positions.begin(), positions.end(),
                         [](const auto& p) { return p.x() > kWallX - 0.1; });
  };
  DenseMap dense = seen;
  ASSERT_GT(pointsOfBox(*dense.layer(), kSeenBox), 40U);
  dense.leaveOut({trackSince(10.2, 1.0)}, 9.0);
  EXPECT_TRUE(dense.isOutdated());
  EXPECT_EQ(pointsOfBox(*dense.layer(), kSeenBox), 0U);
  EXPECT_EQ(wallOf(dense), wallOf(seen));
  DenseMap loaded(params());
  loaded.load(collected(dense.save()));
  EXPECT_TRUE(areEqual(*loaded.layer(), *dense.layer()));
}

/// The map is corrected between the scan and the track: both are compared where neither moved.
TEST(DenseMapTest, LeavesOutByOdometryAfterACorrectionOfTheMap) {
  Pose moved = Pose::Identity();
  moved.translation() << 0.0, 40.0, 0.0;
  DepthWorld with_box;
  with_box.box = kSeenBox;
  DenseMap dense(params());
  dense.follow(keyframeAt(robotAt(0.0, 0.0)));
  for (const Pose& pose : driveForward()) {
    DepthScan scan = depthScanFrom(pose, with_box);
    scan.time = 10.0;
    dense.add(dense.anchored(pose), pose, scan);
  }
  dense.follow(keyframeAt(moved * robotAt(0.0, 0.0)));
  const Eigen::Vector3d now = moved * kSeenBox;
  ASSERT_GT(pointsOfBox(*dense.layer(), now), 40U);
  DenseMap by_map = dense;
  Track in_map = transformed(trackSince(10.2, 1.0), moved);
  by_map.leaveOut({in_map}, 9.0);
  EXPECT_GT(pointsOfBox(*by_map.layer(), now), 40U) << "40 m off in the odometry frame";
  dense.leaveOut({trackSince(10.2, 1.0)}, 9.0);
  EXPECT_EQ(pointsOfBox(*dense.layer(), now), 0U);
}

TEST(DenseMapTest, LeavesOutWhereAnObjectWasBetweenItsDetections) {
  DenseMap dense = driveAtTime(10.0);
  Track track = trackSince(9.8, 1.0);
  track.recent_path.erase(track.recent_path.begin() + 1, track.recent_path.begin() + 4);
  dense.leaveOut({track}, 9.0);
  EXPECT_EQ(pointsOfBox(*dense.layer(), kSeenBox), 0U);
}

TEST(DenseMapTest, KeepsWhatNoTrackWasSeenNearEnoughInTime) {
  const auto before = pointsOfBox(*driveAtTime(10.0).layer(), kSeenBox);
  const auto after = [](const Track& track, Time since) {
    DenseMap dense = driveAtTime(10.0);
    dense.leaveOut({track}, since);
    return pointsOfBox(*dense.layer(), kSeenBox);
  };
  EXPECT_EQ(after(trackSince(10.2, 1.0), 10.1), before) << "older than is asked for";
  EXPECT_EQ(after(trackSince(10.2, 0.1), 9.0), before) << "followed for too short a time";
  EXPECT_EQ(after(trackSince(11.2, 2.0), 9.0), before) << "too long before it was seen";
  EXPECT_EQ(after(trackSince(8.0, 1.0), 9.0), before) << "after it was lost";
}

TEST(DenseMapTest, LoadsScansThatHaveNoTimes) {
  DenseMap dense(params());
  dense.add(robotAt(0.0, 0.0), depthScanFrom(robotAt(0.0, 0.0)));
  std::string bytes = collected(dense.save());
  constexpr std::size_t kBeforeTime = 1 + 8 + 8 + 12 + 8;  // version, voxel, count, place, order
  bytes[0] = 1;
  bytes.erase(kBeforeTime, sizeof(Time));
  DenseMap loaded(params());
  loaded.load(bytes);
  EXPECT_TRUE(areEqual(*loaded.layer(), *dense.layer()));
}

TEST(DenseMapTest, NothingFollowsFromUnknownCells) {
  DepthWorld with_box;
  with_box.box = Eigen::Vector3d(9.0, 0.3, 0.0);
  DenseMap dense = drive(with_box);
  const auto before = pointsOfBox(*dense.layer(), *with_box.box);
  for (const auto& pose : driveForward()) {
    const Pose beside = pose * robotAt(0.0, 0.6);
    DepthScan scan = depthScanFrom(beside);
    std::fill(scan.known.begin(), scan.known.end(), std::uint8_t{0});
    scan.known[0] = 1;  // a single cell, so that it is a scan
    scan.disparity.resize(1);
    scan.colour.resize(3);
    dense.add(beside, scan);
  }
  EXPECT_EQ(pointsOfBox(*dense.layer(), *with_box.box), before);
}

TEST(DenseMapTest, IsAFunctionOfItsScansHoweverOftenItIsFused) {
  DenseMap fused_often(params());
  for (const auto& pose : driveForward()) {
    fused_often.add(pose, depthScanFrom(pose));
    (void)fused_often.layer();
  }
  EXPECT_TRUE(areEqual(*fused_often.layer(), *drive().layer()));
}

TEST(DenseMapTest, FusesInAnotherThreadWhileScansAreAdded) {
  DenseMap dense = drive();
  const auto fusion = dense.fusion();
  EXPECT_FALSE(dense.isOutdated());
  DenseMap::Fused fused;
  std::thread thread([&] { fused = fusion(); });
  const Pose beside = robotAt(0.0, 4.0);
  dense.add(beside, depthScanFrom(beside));
  thread.join();
  EXPECT_TRUE(areEqual(*fused.layer, *drive().layer()));
  dense.apply(fused);
  EXPECT_TRUE(dense.isOutdated());
  EXPECT_GT(dense.layer()->size(), fused.layer->size());
}

TEST(DenseMapTest, FollowsTheKeyframesThatItsScansAreAnchoredTo) {
  const Pose corrected = robotAt(20.0, -3.0, 0.4);
  DenseMap dense(params());
  dense.follow(keyframeAt(Pose::Identity()));
  for (const auto& pose : driveForward()) dense.add(pose, depthScanFrom(pose));
  (void)dense.layer();
  dense.follow(keyframeAt(corrected));
  const auto moved = positionsOf(*dense.layer());
  ASSERT_GT(moved.size(), 2000U);
  for (const auto& position : moved) {
    EXPECT_LT(errorOf(corrected.inverse() * position), 0.5 * kVoxel);
  }
}

TEST(DenseMapTest, AScanOfAFrameBeforeACorrectionFollowsIt) {
  const Pose corrected = robotAt(20.0, -3.0, 0.4);
  DenseMap late(params());
  late.follow(keyframeAt(Pose::Identity()));
  const auto pose = late.anchored(robotAt(1.0, 0.0));
  late.follow(keyframeAt(corrected));
  late.add(pose, robotAt(1.0, 0.0), depthScanFrom(robotAt(1.0, 0.0)));
  DenseMap in_time(params());
  in_time.follow(keyframeAt(Pose::Identity()));
  in_time.add(robotAt(1.0, 0.0), depthScanFrom(robotAt(1.0, 0.0)));
  in_time.follow(keyframeAt(corrected));
  EXPECT_TRUE(areEqual(*late.layer(), *in_time.layer()));
}

TEST(DenseMapTest, IsBoundedByTheAreaAndNotByTime) {
  DenseMap dense = drive();
  const auto scans = dense.scans();
  const auto points = dense.layer()->size();
  for (int lap = 0; lap < 3; ++lap) {
    for (const auto& pose : driveForward()) dense.add(pose, depthScanFrom(pose));
  }
  EXPECT_EQ(dense.scans(), scans);
  EXPECT_EQ(dense.layer()->size(), points);
}

TEST(DenseMapTest, IsNullWithoutScans) {
  DenseMap dense(params());
  EXPECT_EQ(dense.layer(), nullptr);
  dense.add(Pose::Identity(), DepthScan());
  EXPECT_EQ(dense.layer(), nullptr);
}

TEST(DenseMapTest, IsRestoredFromItsBytesAndGoesOn) {
  DenseMap dense = drive();
  const std::string bytes = collected(dense.save());
  EXPECT_EQ(bytes, collected(drive().save()));
  DenseMap loaded(params());
  loaded.load(bytes);
  EXPECT_EQ(collected(loaded.save()), bytes);
  EXPECT_TRUE(areEqual(*loaded.layer(), *dense.layer()));
  EXPECT_TRUE(areEqual(*denseLayer(bytes), *dense.layer()));
  const Pose next = robotAt(8.6, 0.0);
  dense.add(next, depthScanFrom(next));
  loaded.add(next, depthScanFrom(next));
  EXPECT_TRUE(areEqual(*loaded.layer(), *dense.layer()));
}

TEST(DenseMapTest, OneWithoutCameraAndScansIsRestored) {
  DenseMap loaded({});
  loaded.load(collected(DenseMap({}).save()));
  EXPECT_EQ(0u, loaded.scans());
  EXPECT_EQ(nullptr, loaded.layer());
}

TEST(DenseMapTest, RefusesDamagedBytes) {
  DenseMap dense(params());
  dense.add(robotAt(0.0, 0.0), depthScanFrom(robotAt(0.0, 0.0)));
  const std::string bytes = collected(dense.save());
  DenseMap loaded(params());
  for (std::size_t size = 0; size < bytes.size(); size += 997) {
    EXPECT_THROW(loaded.load(bytes.substr(0, size)), InputError) << size;
  }
  EXPECT_THROW(loaded.load(bytes + "x"), InputError);
  std::string other_version = bytes;
  other_version[0] = 99;
  EXPECT_THROW(loaded.load(other_version), InputError);
  for (std::size_t at = 0; at < 400; at += 7) {  // whatever else is damaged: no crash
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(0xff);
    try {
      loaded.load(damaged);
      (void)loaded.layer();
    } catch (const InputError&) {
    }
  }
}

TEST(DenseMapTest, JoinsTheScansOfAnotherMapAndIsCutToABox) {
  DenseMap both(params());
  DenseMap first(params());
  DenseMap second(params());
  for (const double x : {0.0, 1.2, 2.4}) {
    const Pose pose = robotAt(x, 0.0);
    (x < 2.0 ? first : second).add(pose, depthScanFrom(pose));
    both.add(pose, depthScanFrom(pose));
  }
  first.add(second, 100);
  EXPECT_EQ(both.scans(), first.scans());
  EXPECT_TRUE(areEqual(*first.layer(), *both.layer()));

  const std::size_t all = first.layer()->size();
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-1.0, -2.0, -1.0), Eigen::Vector3d(4.0, 0.5, 1.0));
  first.crop(box);
  const auto inside = first.layer();
  ASSERT_NE(nullptr, inside);
  EXPECT_GT(inside->size(), 0u);
  EXPECT_LT(inside->size(), all);
  const Eigen::AlignedBox3d outside(box.min().array() - 0.1, box.max().array() + 0.1);
  for (const auto& position : positionsOf(*inside)) EXPECT_TRUE(outside.contains(position));
  first.crop({Eigen::Vector3d(50.0, 50.0, 0.0), Eigen::Vector3d(51.0, 51.0, 1.0)});
  EXPECT_EQ(nullptr, first.layer());
}

TEST(DenseMapTest, IsCutToABoxWithoutParametersOfItsRig) {
  DenseMap dense(params());
  for (const double x : {0.0, 1.2, 2.4}) dense.add(robotAt(x, 0.0), depthScanFrom(robotAt(x, 0.0)));
  DenseMap stored({});
  stored.load(collected(dense.save()));
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-1.0, -9.0, -9.0), Eigen::Vector3d(9.0, 9.0, 9.0));
  dense.crop(box);
  stored.crop(box);
  EXPECT_EQ(3u, stored.scans());
  EXPECT_TRUE(areEqual(*dense.layer(), *stored.layer()));
}

TEST(DenseMapTest, RefusesParametersOutOfRange) {
  DenseMapParams wrong = params();
  wrong.voxel_m = -0.1;
  EXPECT_THROW(DenseMap{wrong}, InputError);
}

}  // namespace
}  // namespace headway::map
