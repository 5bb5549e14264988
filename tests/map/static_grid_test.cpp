// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/map/map_export.h>
#include <headway/map/static_grid.h>
#include <headway_test/folders.h>
#include <headway_test/input_error.h>
#include <headway_test/process.h>
#include <mrpt/img/CImage.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace headway::map {
namespace {

using mrpt::maps::COccupancyGridMap2D;

Pose poseAt(double x, double y, double yaw = 0.0) {
  return Eigen::Translation3d(x, y, 0.0) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
}

/// What is seen of a wall at x = 10.1 m in the map, with a gap over |y| < 1 m through which one
/// sees 15 m far; a moving object is in front of it if given.
GroundScan wallSeenFrom(const Pose& T_map_robot,
                        const std::optional<Eigen::Vector2d>& moving_object = std::nullopt) {
  GroundScan scan;
  const Pose T_robot_map = T_map_robot.inverse();
  const Eigen::Vector2d origin = T_map_robot.translation().head<2>();
  const auto inRobot = [&](const Eigen::Vector2d& place) {
    return Eigen::Vector3f(
        (T_robot_map * Eigen::Vector3d(place.x(), place.y(), 0.0)).cast<float>());
  };
  for (double angle = -0.6; angle <= 0.6; angle += 0.005) {
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
    double range = (10.1 - origin.x()) / along.x();
    bool stands = std::abs(origin.y() + range * along.y()) > 1.0;
    if (!stands) range = 15.0;
    if (moving_object) {
      const double at = along.dot(*moving_object - origin);
      if ((origin + at * along - *moving_object).norm() < 0.4 && at < range) {
        range = at;
        stands = true;
      }
    }
    const double free_to = stands ? range - 0.3 : range;
    scan.free.push_back({inRobot(origin + 3.0 * along), inRobot(origin + free_to * along)});
    if (stands) scan.obstacles.push_back({inRobot(origin + range * along), 0.1f});
  }
  return scan;
}

StaticGrid drivePast(const std::vector<Pose>& poses) {
  StaticGrid grid({});
  for (const auto& pose : poses) grid.add(pose, wallSeenFrom(pose));
  return grid;
}

std::vector<Pose> wayForward() {
  std::vector<Pose> poses;
  for (int i = 0; i < 8; ++i) poses.push_back(poseAt(0.5 * i, 0.1, 0.02 * i));
  return poses;
}

slam::KeyframeView keyframeAt(std::int64_t id, const Pose& pose) {
  slam::KeyframeView keyframe;
  keyframe.id = KeyframeId{id};
  keyframe.T_map_robot = pose;
  return keyframe;
}

/// Cells over one area, whatever the sizes of the grids.
std::vector<float> cellsOf(const COccupancyGridMap2D& grid) {
  std::vector<float> cells;
  for (float y = -10.1f; y < 10.0f; y += 0.2f) {
    for (float x = -1.9f; x < 24.0f; x += 0.2f) {
      const bool inside =
          x > grid.getXMin() && x < grid.getXMax() && y > grid.getYMin() && y < grid.getYMax();
      cells.push_back(inside ? grid.getPos(x, y) : 0.5f);
    }
  }
  return cells;
}

int differences(const std::vector<float>& a, const std::vector<float>& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] == b[i] ? 0 : 1;
  return count;
}

TEST(StaticGridTest, RaysFreeTheCellsBeforeTheirEndOnly) {
  const auto grid = drivePast(wayForward()).grid();
  ASSERT_NE(grid, nullptr);
  EXPECT_LT(grid->getPos(10.1f, 3.0f), 0.1f) << "the wall";
  EXPECT_GT(grid->getPos(7.1f, 2.1f), 0.75f) << "before it";
  EXPECT_GT(grid->getPos(12.1f, 0.1f), 0.75f) << "through the gap";
  EXPECT_FLOAT_EQ(grid->getPos(11.0f, 3.0f), COccupancyGridMap2D::l2p(0)) << "behind it";
  EXPECT_GT(grid->getPos(1.1f, 0.1f), 0.55f) << "the robot's own way, which no ray reaches";
}

TEST(StaticGridTest, ACellThatMayHoldAPartOfASurfaceIsNotFree) {
  GroundScan scan;
  scan.free.push_back({{1.0F, 0.1F, 0.0F}, {5.15F, 0.1F, 0.0F}});
  scan.obstacles.push_back({{5.21F, 0.1F, 0.0F}, 0.05F});
  StaticGrid grid({});
  grid.add(Pose::Identity(), scan);
  const auto cells = grid.grid();
  EXPECT_LT(cells->getPos(5.3F, 0.1F), 0.4F);
  EXPECT_FLOAT_EQ(cells->getPos(5.1F, 0.1F), COccupancyGridMap2D::l2p(0)) << "its ground is seen";
  EXPECT_GT(cells->getPos(4.9F, 0.1F), 0.55F);
}

/// Free cells of a strip between two places that the robot did not drive.
int freeBetween(const StaticGrid& grid, const Eigen::Vector2f& a, const Eigen::Vector2f& b) {
  const auto cells = grid.grid();
  int free = 0;
  for (float ratio = 0.2F; ratio < 0.85F; ratio += 0.1F) {
    const Eigen::Vector2f at = a + ratio * (b - a);
    const bool inside = at.x() > cells->getXMin() && at.x() < cells->getXMax() &&
                        at.y() > cells->getYMin() && at.y() < cells->getYMax();
    if (inside && cells->getPos(at.x(), at.y()) > 0.51F) ++free;
  }
  return free;
}

/// What is seen is far ahead, so that ground about the robot is known by its way alone.
GroundScan farScan() {
  GroundScan scan;
  scan.obstacles.push_back({{20.0F, 0.0F, 0.0F}, 0.1F});
  return scan;
}

TEST(StaticGridTest, TheWayBetweenScansFollowsOdometryWhateverTheMapDoes) {
  StaticGrid grid({});
  grid.add(poseAt(0.0, 0.0), poseAt(0.0, 0.0), farScan());
  // The map jumps by 4 m to the left while the robot drives 2 m ahead.
  grid.add(poseAt(2.0, 4.0), poseAt(2.0, 0.0), farScan());
  EXPECT_EQ(freeBetween(grid, {0.0F, 0.0F}, {2.0F, 4.0F}), 0) << "nobody drove there";
  EXPECT_GE(freeBetween(grid, {0.0F, 4.0F}, {2.0F, 4.0F}), 6) << "its true way, in the new map";
}

TEST(StaticGridTest, WhatWasDrivenWhileLostIsNotKnownToBeFree) {
  StaticGrid driven({}), lost({});
  for (StaticGrid* grid : {&driven, &lost}) {
    grid->add(poseAt(0.1, 0.1), poseAt(0.1, 0.1), farScan());
    if (grid == &lost) grid->interrupt();
    grid->add(poseAt(3.1, 0.1), poseAt(3.1, 0.1), farScan());
  }
  EXPECT_GE(freeBetween(driven, {0.1F, 0.1F}, {3.1F, 0.1F}), 6);
  EXPECT_EQ(freeBetween(lost, {0.1F, 0.1F}, {3.1F, 0.1F}), 0);
  lost.add(poseAt(5.1, 0.1), poseAt(5.1, 0.1), farScan());
  EXPECT_GE(freeBetween(lost, {3.1F, 0.1F}, {5.1F, 0.1F}), 6) << "from there on it is";
}

TEST(StaticGridTest, CellsOfAMovingObjectAreClearedByLaterScans) {
  StaticGrid grid({});
  const auto poses = wayForward();
  grid.add(poses[0], wallSeenFrom(poses[0], Eigen::Vector2d(7.1, 1.1)));
  EXPECT_LT(grid.grid()->getPos(7.1f, 1.1f), 0.4f) << "not known to be moving";
  for (std::size_t i = 1; i < poses.size(); ++i) grid.add(poses[i], wallSeenFrom(poses[i]));
  EXPECT_GT(grid.grid()->getPos(7.1f, 1.1f), 0.65f);
}

TEST(StaticGridTest, TheLastScanOfAPlaceReplacesTheOthers) {
  StaticGrid grid({});
  const Pose stand = poseAt(0.3, 0.3);
  for (int i = 0; i < 50; ++i) grid.add(stand, wallSeenFrom(stand, Eigen::Vector2d(7.1, 1.1)));
  const std::size_t kept = grid.save().size();
  EXPECT_LT(grid.grid()->getPos(7.1f, 1.1f), 0.4f);
  grid.add(stand, wallSeenFrom(stand));
  EXPECT_GT(grid.grid()->getPos(7.1f, 1.1f), 0.55f);
  EXPECT_LT(grid.save().size(), 2 * kept) << "what is kept grows with the area, not with time";
}

/// A laser's view of the wall at x = 10.1 m in the map, 0.2 m high, over the gap as well.
void addLaserWall(const Pose& T_map_robot, GroundScan& scan) {
  const Pose T_robot_map = T_map_robot.inverse();
  for (double y = -3.0; y < 3.0; y += 0.05) {
    const Eigen::Vector3f foot = (T_robot_map * Eigen::Vector3d(10.1, y, 0.0)).cast<float>();
    scan.laser_obstacles.push_back({foot, 0.02F});
    scan.laser_passed.push_back({Eigen::Vector3f::Zero(), 0.99F * foot});
  }
}

TEST(StaticGridTest, WhatEitherSensorSeesIsNeverErasedByTheOtherOfTheSameTime) {
  StaticGrid grid({});
  for (const auto& pose : wayForward()) {
    GroundScan scan = wallSeenFrom(pose, Eigen::Vector2d(7.1, 1.1));  // which the laser overlooks
    addLaserWall(pose, scan);
    grid.add(pose, scan);
  }
  EXPECT_LT(grid.grid()->getPos(10.1f, 0.1f), 0.2f) << "in the gap where stereo sees free ground";
  EXPECT_LT(grid.grid()->getPos(7.1f, 1.1f), 0.3f) << "the beams pass over it";
}

TEST(StaticGridTest, BeamsOfALaserRemoveItsObstaclesButMakeNothingFree) {
  StaticGrid grid({});
  const auto unknown = COccupancyGridMap2D::l2p(0);
  const auto poses = wayForward();
  GroundScan person;
  person.laser_obstacles.push_back({{5.1F, 0.0F, 0.0F}, 0.02F});
  grid.add(poses[0], person);
  const auto place = [&] { return poses[0] * Eigen::Vector3d(5.1, 0.0, 0.0); };
  const auto cell = [&] {
    return grid.grid()->getPos(static_cast<float>(place().x()), static_cast<float>(place().y()));
  };
  EXPECT_LT(cell(), 0.35f);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    GroundScan passed;
    const Eigen::Vector3d foot = poses[i].inverse() * place();
    passed.laser_passed.push_back({Eigen::Vector3f::Zero(), (1.5 * foot).cast<float>()});
    grid.add(poses[i], passed);
  }
  EXPECT_FLOAT_EQ(cell(), unknown) << "low obstacles and drops may be there";
}

constexpr double kMostCells = 20e6;  // of which the documentation tells

double cellsIn(const COccupancyGridMap2D& grid) {
  return static_cast<double>(grid.getSizeX()) * grid.getSizeY();
}

GroundScan obstacleAt(float x, float y) {
  GroundScan scan;
  scan.obstacles.push_back({{x, y, 0.0F}, 0.1F});
  return scan;
}

TEST(StaticGridTest, AnObstacleIsWhatTwoPlacesHaveSeenAndWhatOneHasIsUnknown) {
  StaticGrid grid({});
  const auto cell = [&] { return grid.grid()->getPos(5.1F, 0.1F); };
  for (int i = 0; i < 3; ++i) {
    grid.add(poseAt(0.0, 0.0), obstacleAt(5.1F, 0.1F));
    EXPECT_LT(cell(), 0.5F) << "not free";
    EXPECT_GT(cell(), 0.35F) << "a wrong match comes again while the robot stands";
  }
  grid.add(poseAt(1.0, 0.0), obstacleAt(4.1F, 0.1F));
  EXPECT_LT(cell(), 0.35F);
}

TEST(StaticGridTest, PlacesFarApartTakeNoMoreCellsThanNearOnes) {
  for (const auto& far : {poseAt(9.9e6, 30.0), poseAt(-30.0, -9.9e6), poseAt(9.9e6, 9.9e6)}) {
    StaticGrid grid({});
    grid.add(poseAt(0.0, 0.0), obstacleAt(5.0F, 0.0F));
    grid.add(far, obstacleAt(5.0F, 0.0F));
    EXPECT_LT(cellsIn(*grid.grid()), kMostCells) << far.translation().transpose();
    grid.standAt(poseAt(-9.9e6, -9.9e6));
    EXPECT_LT(cellsIn(*grid.grid()), kMostCells);
    StaticGrid loaded({});
    loaded.load(grid.save());
    EXPECT_LT(cellsIn(*loaded.grid()), kMostCells);
  }
}

TEST(StaticGridTest, ScansThatReachFarTakeNoMoreCellsThanOthers) {
  StaticGrid grid({});
  for (const double x : {0.0, 450.0, 900.0}) {
    for (const double y : {0.0, 450.0, 900.0}) {
      GroundScan scan = obstacleAt(290.0F, 290.0F);
      scan.obstacles.push_back({{-290.0F, -290.0F, 0.0F}, 0.1F});
      scan.laser_obstacles = scan.obstacles;
      grid.add(poseAt(x, y), scan);
    }
  }
  EXPECT_LT(cellsIn(*grid.grid()), kMostCells);
  EXPECT_LT(grid.grid()->getPos(1190.0F, 1190.0F), 0.45F) << "the farthest obstacle";
  EXPECT_LT(grid.grid()->getPos(-290.0F, -290.0F), 0.45F);
  grid.add(poseAt(0.0, 0.0), {});
  EXPECT_FLOAT_EQ(grid.grid()->getPos(-290.0F, -290.0F), COccupancyGridMap2D::l2p(0))
      << "taken back where it was entered";
}

TEST(StaticGridTest, LaserScansFollowTheKeyframesAndAreStored) {
  StaticGrid grid({});
  const Pose pose = poseAt(0.3, 0.3);
  grid.follow({keyframeAt(1, pose)});
  GroundScan scan = wallSeenFrom(pose);
  addLaserWall(pose, scan);
  grid.add(pose, scan);
  StaticGrid loaded({});
  loaded.load(grid.save());
  EXPECT_EQ(0, differences(cellsOf(*grid.grid()), cellsOf(*loaded.grid())));

  grid.follow({keyframeAt(1, poseAt(2.3, 0.3))});
  EXPECT_LT(grid.grid()->getPos(12.1f, 0.1f), 0.35f);
  EXPECT_GT(grid.grid()->getPos(10.1f, 0.1f), 0.5f) << "taken back where it was before";
  grid.follow({keyframeAt(1, pose)});
  EXPECT_EQ(0, differences(cellsOf(*grid.grid()), cellsOf(*loaded.grid())));
}

TEST(StaticGridTest, AScanOfALaserAloneDoesNotReplaceOneOfStereo) {
  StaticGrid grid({});
  const Pose pose = poseAt(0.3, 0.3);
  grid.add(pose, wallSeenFrom(pose, Eigen::Vector2d(7.1, 1.1)));
  const auto before = cellsOf(*grid.grid());
  GroundScan laser;
  addLaserWall(pose, laser);
  grid.add(pose, laser);
  EXPECT_EQ(0, differences(before, cellsOf(*grid.grid())));
}

TEST(StaticGridTest, FollowsTheKeyframes) {
  const auto poses = wayForward();
  StaticGrid grid({});
  grid.follow({keyframeAt(3, poses[0]), keyframeAt(7, poses[6])});
  for (const auto& pose : poses) grid.add(pose, wallSeenFrom(pose));
  // A loop was closed: everything lies elsewhere.
  const Pose correction = poseAt(2.0, -1.0, 0.1);
  grid.follow({keyframeAt(3, correction * poses[0]), keyframeAt(7, correction * poses[6])});
  const auto moved = grid.grid();
  const Eigen::Vector3d wall = correction * Eigen::Vector3d(10.1, 3.0, 0.0);
  EXPECT_LT(moved->getPos(static_cast<float>(wall.x()), static_cast<float>(wall.y())), 0.35f);
  EXPECT_GT(moved->getPos(10.1f, 3.0f), 0.5f) << "nothing stays where the wall was";
  // And back again: as if nothing had happened.
  grid.follow({keyframeAt(3, poses[0]), keyframeAt(7, poses[6])});
  EXPECT_EQ(differences(cellsOf(*grid.grid()), cellsOf(*drivePast(poses).grid())), 0);
}

TEST(StaticGridTest, FollowsTheKeyframesInPartsWithTheSameResult) {
  const auto poses = wayForward();
  const auto drive = [&] {
    StaticGrid grid({});
    grid.follow({keyframeAt(3, poses[0]), keyframeAt(7, poses[6])});
    for (const auto& pose : poses) grid.add(pose, wallSeenFrom(pose));
    return grid;
  };
  const Pose correction = poseAt(2.0, -1.0, 0.1);
  const std::vector corrected{keyframeAt(3, correction * poses[0]),
                              keyframeAt(7, correction * poses[6])};
  StaticGrid at_once = drive();
  at_once.follow(corrected);
  StaticGrid in_parts = drive();
  const auto expected = cellsOf(*at_once.grid());
  in_parts.follow(corrected, 1);
  EXPECT_GT(differences(cellsOf(*in_parts.grid()), expected), 0);
  for (std::size_t i = 0; i < poses.size(); ++i) in_parts.followMore(1);
  EXPECT_EQ(differences(cellsOf(*in_parts.grid()), expected), 0);
}

TEST(StaticGridTest, PublishedMapsNeverChangeAndUnusedOnesAreBroughtUpToDate) {
  const auto poses = wayForward();
  StaticGrid grid({});
  std::vector<Pose> driven;
  COccupancyGridMap2D::ConstPtr kept;
  std::vector<float> kept_cells;
  for (int i = 0; i < 40; ++i) {
    driven.push_back(poseAt(0.3 * (i % 20), 0.1 * (i / 20), 0.01 * i));
    grid.add(driven.back(), wallSeenFrom(driven.back()));
    const auto published = grid.grid();
    if (i % 13 == 0) {
      if (kept != nullptr) {
        EXPECT_EQ(differences(cellsOf(*kept), kept_cells), 0) << i;
      }
      kept = published;
      kept_cells = cellsOf(*kept);
    }
    EXPECT_NE(published, i % 13 == 0 ? nullptr : kept);
    EXPECT_EQ(differences(cellsOf(*published), cellsOf(*drivePast(driven).grid())), 0) << i;
  }
}

TEST(StaticGridTest, KeepsTheScansOfARemovedKeyframe) {
  const auto poses = wayForward();
  StaticGrid grid({});
  grid.follow({keyframeAt(3, poses[0]), keyframeAt(7, poses[6])});
  for (const auto& pose : poses) grid.add(pose, wallSeenFrom(pose));
  const auto before = cellsOf(*grid.grid());
  grid.follow({keyframeAt(7, poses[6])});
  EXPECT_EQ(differences(cellsOf(*grid.grid()), before), 0);
  const Pose correction = poseAt(3.0, 0.0);
  grid.follow({keyframeAt(7, correction * poses[6])});
  EXPECT_LT(grid.grid()->getPos(13.1f, 3.0f), 0.1f) << "it hangs on the other one now";
  EXPECT_GT(grid.grid()->getPos(10.1f, 3.0f), 0.5f);
}

TEST(StaticGridTest, DoesNotDependOnTheOrderOfScans) {
  auto poses = wayForward();
  StaticGrid forward({}), backward({});
  for (const auto& pose : poses) forward.add(pose, wallSeenFrom(pose));
  std::reverse(poses.begin(), poses.end());
  for (const auto& pose : poses) {
    auto scan = wallSeenFrom(pose);
    std::reverse(scan.free.begin(), scan.free.end());
    std::reverse(scan.obstacles.begin(), scan.obstacles.end());
    backward.add(pose, scan);
  }
  const auto a = forward.grid(), b = backward.grid();
  EXPECT_EQ(a->getPos(10.1f, 3.0f), b->getPos(10.1f, 3.0f));
  EXPECT_EQ(a->getPos(7.1f, 2.1f), b->getPos(7.1f, 2.1f));
}

TEST(StaticGridTest, IsNullWithoutObservations) {
  StaticGrid grid({});
  EXPECT_EQ(grid.grid(), nullptr);
  grid.add(poseAt(0.0, 0.0), {});
  EXPECT_EQ(grid.grid(), nullptr) << "a first scan without returns";
}

TEST(StaticGridTest, IsCoarserWhereTheMapIsVast) {
  const GroundScan scan = wallSeenFrom(poseAt(0.0, 0.0));
  StaticGrid grid({});
  grid.add(poseAt(0.0, 0.0), scan);
  grid.add(poseAt(1500.0, 1500.0), scan);
  const auto vast = grid.grid();
  EXPECT_FLOAT_EQ(vast->getResolution(), 0.4f);
  EXPECT_LT(vast->getPos(10.1f, 3.0f), 0.45f);
  EXPECT_LT(vast->getPos(1510.1f, 1503.0f), 0.45f);
}

TEST(StaticGridTest, ContinuesFromSavedBytes) {
  const auto poses = wayForward();
  StaticGrid first({});
  first.follow({keyframeAt(3, poses[0])});
  for (const auto& pose : poses) first.add(pose, wallSeenFrom(pose));
  const std::string bytes = first.save();

  StaticGrid second({});
  second.load(bytes);
  EXPECT_EQ(differences(cellsOf(*second.grid()), cellsOf(*first.grid())), 0);
  EXPECT_EQ(second.save(), bytes);
  second.follow({keyframeAt(3, poseAt(2.0, 0.0) * poses[0])});
  EXPECT_LT(second.grid()->getPos(12.1f, 3.0f), 0.1f) << "still anchored to its keyframe";
}

TEST(StaticGridTest, RefusesDamagedBytesUnchanged) {
  StaticGrid grid = drivePast(wayForward());
  const std::string bytes = grid.save();
  const auto before = grid.grid()->getRawMap();
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{5}, bytes.size() / 2, bytes.size() - 1}) {
    EXPECT_THROW(grid.load(bytes.substr(0, length)), InputError) << length;
  }
  std::string newer = bytes;
  newer[0] = 99;
  EXPECT_THROW(grid.load(newer), InputError);
  const std::size_t place = bytes.size() - 16;  // the last foot point, before its sigma
  for (const float value : {1e6F, -1e30F, std::numeric_limits<float>::quiet_NaN()}) {
    std::string distant = bytes;
    std::memcpy(distant.data() + place, &value, sizeof value);
    EXPECT_THROW(grid.load(distant), InputError) << value;
  }
  const std::size_t pose = 1 + 8 + 3 * 4;  // version, number of scans, place
  for (const double value : {2.0, 1e300}) {
    std::string bent = bytes;
    std::memcpy(bent.data() + pose, &value, sizeof value);
    EXPECT_THROW(grid.load(bent), InputError) << value;
  }
  EXPECT_EQ(grid.grid()->getRawMap(), before);
}

TEST(WriteStaticGridTest, IsReadableByMrptAndMapServers) {
  const test::TemporaryFolder folder;
  const auto grid = drivePast(wayForward()).grid();
  writeStaticGrid(folder / "map_grid", *grid);

  mrpt::io::CFileGZInputStream stream(folder / "map_grid.gridmap.gz");
  COccupancyGridMap2D read;
  mrpt::serialization::archiveFrom(stream) >> read;
  EXPECT_EQ(read.getSizeX(), grid->getSizeX());
  EXPECT_EQ(read.getRawMap(), grid->getRawMap());

  mrpt::img::CImage picture;
  ASSERT_TRUE(picture.loadFromFile(folder / "map_grid.png"));
  ASSERT_EQ(picture.getWidth(), grid->getSizeX());
  const auto greyAt = [&](float x, float y) {
    return int(picture.getAsFloat(static_cast<unsigned>(grid->x2idx(x)),
                                  grid->getSizeY() - 1 - static_cast<unsigned>(grid->y2idx(y))) *
                   255 +
               0.5f);
  };
  EXPECT_EQ(greyAt(7.0f, 2.0f), 254);
  EXPECT_EQ(greyAt(10.1f, 3.0f), 0);
  EXPECT_EQ(greyAt(11.0f, 3.0f), 205) << "behind the wall";
  EXPECT_THAT(test::contentsOf(folder / "map_grid.yaml"),
              ::testing::HasSubstr("image: map_grid.png\nresolution: 0.2\norigin: ["));
}

TEST(WriteStaticGridTest, NamesThePathThatCannotBeWritten) {
  EXPECT_THROW(writeStaticGrid("/nonexistent/grid", COccupancyGridMap2D()), InputError);
}

TEST(StaticGridParamsTest, AreDescribedWithRanges) {
  StaticGridParams values;
  Params params;
  values.describe(params.section("grid"));
  params.set("grid.resolution=0.5");
  EXPECT_EQ(values.resolution_m, 0.5);
  EXPECT_THROW(params.set("grid.resolution=0"), InputError);
}

TEST(StaticGridParamsTest, OutOfRangeAreRefusedByTheGrid) {
  StaticGridParams values;
  values.resolution_m = 0.0;
  EXPECT_EQ("[grid] resolution: '0' is out of range [m, 0.05 .. 2]",
            test::inputErrorOf([&] { StaticGrid grid(values); }));
}

TEST(StaticGridTest, AddsTheScansOfAnotherGridWithItsKeyframes) {
  const auto poses = wayForward();
  StaticGrid grid = drivePast({poses[0], poses[1]});
  StaticGrid other({});
  other.follow({keyframeAt(3, poses[6])});
  for (const auto i : {5U, 6U}) other.add(poses[i], wallSeenFrom(poses[i]));
  grid.add(other, 10);
  EXPECT_LT(grid.grid()->getPos(10.1f, 3.0f), drivePast({poses[0]}).grid()->getPos(10.1f, 3.0f));
  grid.follow({keyframeAt(13, poseAt(0.0, 20.0) * poses[6])});
  EXPECT_LT(grid.grid()->getPos(10.1f, 23.0f), 0.35f) << "its scans follow their keyframe";
}

TEST(StaticGridTest, CroppedItKnowsNothingOutside) {
  StaticGrid grid = drivePast(wayForward());
  grid.crop({Eigen::Vector2d(-1.0, -3.0), Eigen::Vector2d(8.0, 3.0)});
  const auto cells = grid.grid();
  EXPECT_GT(cells->getPos(7.1f, 2.1f), 0.75f) << "before the wall";
  EXPECT_FLOAT_EQ(cells->getPos(10.1f, 2.1f), COccupancyGridMap2D::l2p(0)) << "the wall";
  StaticGrid loaded({});
  loaded.load(grid.save());
  EXPECT_EQ(0, differences(cellsOf(*cells), cellsOf(*loaded.grid())));
}

}  // namespace
}  // namespace headway::map
