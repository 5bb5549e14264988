#include "ground.h"

#include <gtest/gtest.h>

#include "example_street.h"

namespace headway::scene {
namespace {

SnapshotInput inputAt(const map::PerceptionMap& map, double z) {
  SnapshotInput input{map, 0, 0.0};
  input.T_map_robot.translation().z() = z;
  return input;
}

TEST(GroundHeightTest, IsWhereBoxesStand) {
  map::PerceptionMap map = streetMap();
  EXPECT_NEAR(groundHeight(inputAt(map, 5.0)), 0.0, 1e-9);
}

TEST(GroundHeightTest, IsLowAmongTheLandmarksWhereThereAreFewBoxes) {
  slam::MapView still_world;
  for (int i = 0; i < 200; ++i) {
    still_world.landmarks.push_back({LandmarkId{i}, {0.1 * i, 1.0, -1.65 + 0.05 * i}, 3, 100});
  }
  map::PerceptionMap map;
  map.update(still_world);
  map.update(0.0, {streetTrack(1, ObjectClass::kCar, {5, 5}, 0.0, 0.0)});
  const double ground = groundHeight(inputAt(map, 0.0));
  EXPECT_GT(ground, -1.65);
  EXPECT_LT(ground, -0.5);
}

TEST(GroundHeightTest, LooksOnlyAroundTheRobot) {
  slam::MapView still_world;
  for (int i = 0; i < 200; ++i) {
    still_world.landmarks.push_back({LandmarkId{i}, {500.0 + i, 0.0, -30.0}, 3, 100});
  }
  map::PerceptionMap map;
  map.update(still_world);
  EXPECT_EQ(groundHeight(inputAt(map, 2.5)), 2.5);
}

TEST(GroundHeightTest, IsTheRobotsHeightInAnEmptyMap) {
  EXPECT_EQ(groundHeight(inputAt(map::PerceptionMap(), 2.5)), 2.5);
}

}  // namespace
}  // namespace headway::scene
