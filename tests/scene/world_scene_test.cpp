// SPDX-License-Identifier: BSD-3-Clause
#include "world_scene.h"

#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway_test/folders.h>
#include <mrpt/maps/CColouredPointsMap.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/opengl/CTexturedPlane.h>

#include <algorithm>

#include "example_street.h"

namespace headway::scene {
namespace {

mrpt::opengl::CSetOfObjects::Ptr movingObjectsIn(mrpt::opengl::COpenGLScene& scene) {
  return std::dynamic_pointer_cast<mrpt::opengl::CSetOfObjects>(scene.getByName("moving_objects"));
}

mrpt::opengl::CSetOfObjects::Ptr landmarksIn(mrpt::opengl::COpenGLScene& scene) {
  return std::dynamic_pointer_cast<mrpt::opengl::CSetOfObjects>(scene.getByName("landmarks"));
}

std::size_t pointsIn(mrpt::opengl::COpenGLScene& scene) {
  std::size_t count = 0;
  for (const auto& object : *landmarksIn(scene)) {
    count += std::dynamic_pointer_cast<mrpt::opengl::CPointCloudColoured>(object)->size();
  }
  return count;
}

TEST(WorldSceneTest, ContainsAllParts) {
  const auto map = streetMap();
  auto input = streetInput(map);
  input.true_path = input.path;
  input.true_objects = map.movingObjects().tracks();
  auto scene = buildScene(input, {}, 0.0);
  for (const char* name : {"ground_grid", "landmarks", "camera_path", "true_path", "robot",
                           "moving_objects", "true_objects", "camera"}) {
    EXPECT_NE(scene.getByName(name), nullptr) << name;
  }
  EXPECT_EQ(pointsIn(scene), map.landmarks().size());
  const auto moving = movingObjectsIn(scene);
  for (const char* name : {"faces", "trails", "predictions", "uncertainty", "edges_Car",
                           "edges_Pedestrian", "edges_Cyclist", "edges_Truck", "labels"}) {
    EXPECT_NE(moving->getByName(name), nullptr) << name;
  }
}

TEST(WorldSceneTest, ShowsTheOccupancyGridBelowEverythingElse) {
  auto map = streetMap();
  map.update(mrpt::maps::COccupancyGridMap2D::Create(-500.f, 500.f, -10.f, 20.f, 0.5f));
  auto scene = buildScene(streetInput(map), {}, 0.0);
  const auto plane =
      std::dynamic_pointer_cast<mrpt::opengl::CTexturedPlane>(scene.getByName("occupancy"));
  ASSERT_NE(plane, nullptr);
  float x_min = 0.f, x_max = 0.f, y_min = 0.f, y_max = 0.f;
  plane->getPlaneCorners(x_min, x_max, y_min, y_max);
  EXPECT_LT(x_max - x_min, 810.f) << "the surroundings";
  EXPECT_FLOAT_EQ(y_min, -10.f);
  EXPECT_FLOAT_EQ(y_max, 20.f);
  EXPECT_LT(plane->getPose().z, 0.0);
}

TEST(WorldSceneTest, OmitsMissingParts) {
  const map::PerceptionMap map;
  auto scene = buildScene(SnapshotInput{map, 0, 0.0}, {}, 0.0);
  for (const char* name : {"camera_path", "true_path", "true_objects", "camera"}) {
    EXPECT_EQ(scene.getByName(name), nullptr) << name;
  }
}

TEST(WorldSceneTest, ContainsTheDenseMapUnlessLeftOut) {
  auto map = streetMap();
  EXPECT_EQ(buildScene(streetInput(map), {}, 0.0).getByName("dense"), nullptr);
  auto dense = mrpt::maps::CColouredPointsMap::Create();
  for (int i = 0; i < 50; ++i) dense->insertPointRGB(0.1F * float(i), 1.F, 2.F, 1.F, 0.F, 0.F);
  map.update(dense);
  auto scene = buildScene(streetInput(map), {}, 0.0);
  const auto cloud =
      std::dynamic_pointer_cast<mrpt::opengl::CPointCloudColoured>(scene.getByName("dense"));
  ASSERT_NE(cloud, nullptr);
  EXPECT_EQ(cloud->size(), 50u);
  EXPECT_GT(cloud->getPointColor(7).R, 2 * cloud->getPointColor(7).G);
  SnapshotOptions without;
  without.dense = false;
  EXPECT_EQ(buildScene(streetInput(map), without, 0.0).getByName("dense"), nullptr);
}

TEST(WorldSceneTest, IsViewedFromBehindTheRobot) {
  const auto map = streetMap();
  auto input = streetInput(map);
  input.T_map_robot = Pose(Eigen::Translation3d(300, -200, 0) *
                           Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitZ()));
  const test::TemporaryFolder folder;
  saveScene(folder / "scene.3Dscene", input);
  mrpt::opengl::COpenGLScene scene;
  ASSERT_TRUE(scene.loadFromFile(folder / "scene.3Dscene"));
  EXPECT_TRUE(scene.followCamera()) << "or else SceneViewer3D ignores the camera";
  const auto& camera = scene.getViewport()->getCamera();
  const Eigen::Vector3d target(camera.getPointingAtX(), camera.getPointingAtY(),
                               camera.getPointingAtZ());
  EXPECT_LT((target - input.T_map_robot.translation()).norm(), 10.0);
  const double azimuth = mrpt::DEG2RAD(double(camera.getAzimuthDegrees()));
  EXPECT_LT(std::sin(azimuth), -0.8) << "behind a robot that faces +y";
  EXPECT_GT(camera.getElevationDegrees(), 10.F);
  EXPECT_GT(camera.getZoomDistance(), 5.F);
  EXPECT_LT(camera.getZoomDistance(), 100.F);
}

TEST(PictureTrianglesTest, AreThePathsTheRobotAndWhatMoves) {
  const auto map = streetMap();
  auto input = streetInput(map);
  const auto count = [&](const SnapshotInput& shown) {
    return pictureTriangles(shown, kLightPalette, 0.0).size();
  };
  const auto all = count(input);
  input.path.clear();
  const auto without_path = count(input);
  EXPECT_LT(without_path, all);
  const map::PerceptionMap empty;
  EXPECT_EQ(count(SnapshotInput{empty, 0, 0.0}), 2u) << "the robot's wedge";
  EXPECT_GT(without_path, 7u * 10u) << "faces of seven objects";
}

TEST(PictureTrianglesTest, PredictionsHaveTheThemesColour) {
  const auto map = streetMap();
  const auto green = [&](const Palette& palette) {
    const auto triangles = pictureTriangles(streetInput(map), palette, 0.0);
    return std::count_if(triangles.begin(), triangles.end(), [&](const auto& triangle) {
      return triangle.colour.green == palette.prediction.green &&
             triangle.colour.red == palette.prediction.red;
    });
  };
  EXPECT_GT(green(kDarkPalette), 100);
  EXPECT_EQ(green(kLightPalette), green(kDarkPalette));
}

TEST(SaveSceneTest, WritesAFileThatMrptReads) {
  const test::TemporaryFolder folder;
  const auto map = streetMap();
  saveScene(folder / "scene.3Dscene", streetInput(map));
  mrpt::opengl::COpenGLScene scene;
  ASSERT_TRUE(scene.loadFromFile(folder / "scene.3Dscene"));
  EXPECT_NE(scene.getByName("landmarks"), nullptr);
  ASSERT_NE(movingObjectsIn(scene), nullptr);
  EXPECT_NE(movingObjectsIn(scene)->getByName("labels"), nullptr);
}

TEST(SaveSceneTest, ThrowsIfTheFileCannotBeWritten) {
  const map::PerceptionMap map;
  EXPECT_THROW(saveScene("/nonexistent/scene.3Dscene", SnapshotInput{map, 0, 0.0}), InputError);
}

}  // namespace
}  // namespace headway::scene
