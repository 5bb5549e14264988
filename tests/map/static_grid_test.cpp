#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/map/static_grid.h>
#include <headway_test/folders.h>
#include <headway_test/process.h>
#include <mrpt/img/CImage.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>
#include <random>

namespace headway::map {
namespace {

constexpr double kCameraHeight = 1.5;

StereoCamera cameraAt(double height) {
  StereoCamera camera;
  camera.width = 640;
  camera.height = 240;
  camera.fx = camera.fy = 360.0;
  camera.cx = 319.5;
  camera.cy = 119.5;
  camera.baseline_m = 0.5;
  camera.T_robot_cam = Eigen::Translation3d(0.0, 0.0, height) * robotFromOptical();
  return camera;
}

/// A street along x: walls at y = +-5.1 m, a box (a parked car) over x 12.1..16.1, y 1.1..3.1,
/// ground.
class Street {
 public:
  explicit Street(double camera_height, double slope = 0.0) : camera_height_(camera_height) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    for (int i = 0; i < 4000; ++i) {
      const double x = 40.0 * share(random);
      const double side = i % 2 == 0 ? 5.1 : -5.1;
      add({x, side, kCameraHeight - camera_height + 6.0 * share(random)}, slope);
      add({x, -4.9 + 9.8 * share(random), 0.02 * share(random)}, slope);
    }
    for (int i = 0; i < 400; ++i) {
      const double z = 1.4 * share(random);
      add({12.1, 1.1 + 2.0 * share(random), z}, slope);
      add({12.1 + 4.0 * share(random), 1.1, z}, slope);
    }
    for (int i = 0; i < 30; ++i) addKeyframe(i, slope);
  }

  slam::MapView world;

  /// What truly stands at a place of the level street.
  static bool isOccupied(double x, double y) {
    const bool in_wall = std::abs(std::abs(y) - 5.1) < 0.15;
    const bool in_car = x > 11.95 && x < 16.25 && y > 0.95 && y < 3.25;
    return in_wall || in_car;
  }

 private:
  void add(Eigen::Vector3d position, double slope) {
    if (position.x() > 12.1 && position.x() < 16.1 && position.y() > 1.1 && position.y() < 3.1 &&
        position.z() < 0.1) {
      return;  // the ground under the car
    }
    position.z() += slope * position.x() + camera_height_ - kCameraHeight;
    world.landmarks.push_back(
        {LandmarkId{static_cast<std::int64_t>(world.landmarks.size())}, position, 4, 100});
  }

  /// Whether the car does not stand between.
  static bool sees(const Eigen::Vector3d& eye, const Eigen::Vector3d& landmark) {
    for (double share = 0.02; share < 0.99; share += 0.02) {
      const Eigen::Vector3d p = eye + share * (landmark - eye);
      if (p.x() > 12.15 && p.x() < 16.05 && p.y() > 1.15 && p.y() < 3.05 && p.z() < 1.4) {
        return false;
      }
    }
    return true;
  }

  void addKeyframe(int i, double slope) {
    slam::KeyframeView keyframe;
    keyframe.id = KeyframeId{i};
    keyframe.T_map_robot = Eigen::Translation3d(0.5 * i, -1.5, slope * 0.5 * i) *
                           Eigen::AngleAxisd(-std::atan(slope), Eigen::Vector3d::UnitY());
    const Eigen::Vector3d eye = keyframe.T_map_robot * Eigen::Vector3d(0.0, 0.0, camera_height_);
    for (const auto& landmark : world.landmarks) {
      const Eigen::Vector3d p = keyframe.T_map_robot.inverse() * landmark.position;
      const bool in_view = p.x() > 1.5 && std::abs(p.y()) < 0.9 * p.x();
      if (in_view && (slope != 0.0 || sees(eye, landmark.position))) {
        keyframe.landmarks.push_back(landmark.id);
      }
    }
    world.keyframes.push_back(keyframe);
  }

  double camera_height_;
};

struct Score {
  int observed = 0;
  int right = 0;
};

Score scoreOf(const mrpt::maps::COccupancyGridMap2D& grid) {
  Score score;
  for (int y = 0; y < static_cast<int>(grid.getSizeY()); ++y) {
    for (int x = 0; x < static_cast<int>(grid.getSizeX()); ++x) {
      const float free = grid.getCell(x, y);
      if (free > 0.35f && free < 0.65f) continue;
      ++score.observed;
      const bool occupied = Street::isOccupied(grid.idx2x(static_cast<std::size_t>(x)),
                                               grid.idx2y(static_cast<std::size_t>(y)));
      if (occupied == (free < 0.5f)) ++score.right;
    }
  }
  return score;
}

TEST(StaticGridTest, HasAtLeast95PercentOfTheObservedCellsRight) {
  const Street street(kCameraHeight);
  const auto grid = buildStaticGrid(street.world, cameraAt(kCameraHeight), {});
  ASSERT_NE(grid, nullptr);
  const Score score = scoreOf(*grid);
  EXPECT_GT(score.observed, 3000);
  EXPECT_GE(score.right, 0.95 * score.observed) << score.right << " of " << score.observed;
  EXPECT_LT(grid->getPos(14.0f, 1.1f), 0.35f) << "the car's side";
  EXPECT_LT(grid->getPos(9.0f, -5.1f), 0.35f) << "the wall";
  EXPECT_GT(grid->getPos(10.0f, -1.5f), 0.65f) << "the way";
}

TEST(StaticGridTest, FindsTheGroundBelowARobotFrameThatStandsInTheCamera) {
  Street street(0.0);  // everything is 1.5 m lower
  EXPECT_NEAR(groundInRobot(street.world, cameraAt(0.0)).value_or(9.0), -kCameraHeight, 0.11);
  const auto grid = buildStaticGrid(street.world, cameraAt(0.0), {});
  ASSERT_NE(grid, nullptr);
  const Score score = scoreOf(*grid);
  EXPECT_GT(score.observed, 3000);
  EXPECT_GE(score.right, 0.95 * score.observed) << score.right << " of " << score.observed;
}

TEST(StaticGridTest, TakesASlopeForGround) {
  const Street street(kCameraHeight, 0.12);
  const auto grid = buildStaticGrid(street.world, cameraAt(kCameraHeight), {});
  ASSERT_NE(grid, nullptr);
  EXPECT_GT(grid->getPos(10.0f, -1.5f), 0.65f);
  EXPECT_LT(grid->getPos(9.0f, -5.1f), 0.35f);
}

TEST(StaticGridTest, LeavesNothingWhereLandmarksAreGone) {
  Street street(kCameraHeight);
  auto& landmarks = street.world.landmarks;
  landmarks.erase(std::remove_if(landmarks.begin(), landmarks.end(),
                                 [](const slam::LandmarkView& landmark) {
                                   return std::abs(landmark.position.y()) < 4.0 &&
                                          landmark.position.z() > 0.1;
                                 }),
                  landmarks.end());
  const auto grid = buildStaticGrid(street.world, cameraAt(kCameraHeight), {});
  EXPECT_GT(grid->getPos(14.0f, 1.1f), 0.5f) << "a mover's landmarks were taken out of the map";
}

TEST(StaticGridTest, LeavesOutLandmarksSeenTooSeldomOrFromTooFar) {
  Street street(kCameraHeight);
  StaticGridParams params;
  params.min_observations = 5;
  const auto nothing = buildStaticGrid(street.world, cameraAt(kCameraHeight), params);
  ASSERT_NE(nothing, nullptr);
  EXPECT_LT(scoreOf(*nothing).observed, 100) << "the robot's own way";
  params.min_observations = 3;
  params.reach_m = 5.0;
  const auto near = buildStaticGrid(street.world, cameraAt(kCameraHeight), params);
  EXPECT_LT(near->getXMax(), 14.5 + 5.0 + 1.0);
}

TEST(StaticGridTest, IsNoneWithoutKeyframesOrGround) {
  EXPECT_EQ(buildStaticGrid({}, cameraAt(1.0), {}), nullptr);
  Street street(kCameraHeight);
  for (auto& landmark : street.world.landmarks) landmark.position.z() += 20.0;
  EXPECT_FALSE(groundInRobot(street.world, cameraAt(0.0)));
  EXPECT_EQ(buildStaticGrid(street.world, cameraAt(0.0), {}), nullptr);
}

TEST(StaticGridTest, IsCoarserWhereTheMapIsVast) {
  slam::MapView world;
  for (int i = 0; i < 2; ++i) {
    slam::KeyframeView keyframe;
    keyframe.T_map_robot.translation() << 5000.0 * i, 5000.0 * i, 0.0;
    world.keyframes.push_back(keyframe);
  }
  const auto grid = buildStaticGrid(world, cameraAt(1.0), {});
  ASSERT_NE(grid, nullptr);
  EXPECT_GE(grid->getResolution(), 0.79f);
}

TEST(StaticGridTest, DoesNotDependOnTheOrderOfKeyframes) {
  Street street(kCameraHeight);
  const auto grid = buildStaticGrid(street.world, cameraAt(kCameraHeight), {});
  std::reverse(street.world.keyframes.begin(), street.world.keyframes.end());
  for (auto& keyframe : street.world.keyframes) {
    std::reverse(keyframe.landmarks.begin(), keyframe.landmarks.end());
  }
  const auto reversed = buildStaticGrid(street.world, cameraAt(kCameraHeight), {});
  EXPECT_EQ(grid->getRawMap(), reversed->getRawMap());
}

TEST(WriteStaticGridTest, WritesWhatMrptAndMapServersRead) {
  const test::TemporaryFolder folder;
  const Street street(kCameraHeight);
  const auto grid = buildStaticGrid(street.world, cameraAt(kCameraHeight), {});
  writeStaticGrid(folder / "map_grid", *grid);

  mrpt::io::CFileGZInputStream stream(folder / "map_grid.gridmap.gz");
  mrpt::maps::COccupancyGridMap2D read;
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
  EXPECT_EQ(greyAt(10.0f, -1.5f), 254);
  EXPECT_EQ(greyAt(9.0f, -5.1f), 0);
  EXPECT_EQ(greyAt(0.0f, 4.0f), 205) << "beside the camera";
  EXPECT_THAT(test::contentsOf(folder / "map_grid.yaml"),
              ::testing::HasSubstr("image: map_grid.png\nresolution: 0.2\norigin: ["));
}

TEST(WriteStaticGridTest, SaysWhereItCannotWrite) {
  EXPECT_THROW(writeStaticGrid("/nonexistent/grid", mrpt::maps::COccupancyGridMap2D()), InputError);
}

TEST(StaticGridParamsTest, AreDescribedWithRanges) {
  StaticGridParams values;
  Params params;
  values.describe(params.section("map"));
  params.set("map.grid_resolution=0.5");
  EXPECT_EQ(values.resolution_m, 0.5);
  EXPECT_THROW(params.set("map.grid_reach=1000"), InputError);
}

}  // namespace
}  // namespace headway::map
