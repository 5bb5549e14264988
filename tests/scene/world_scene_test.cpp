#include "world_scene.h"

#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway_test/folders.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CSetOfObjects.h>

#include "example_street.h"

namespace headway::scene {
namespace {

mrpt::opengl::CSetOfObjects::Ptr movingObjectsIn(mrpt::opengl::COpenGLScene& scene) {
  return std::dynamic_pointer_cast<mrpt::opengl::CSetOfObjects>(scene.getByName("moving_objects"));
}

TEST(WorldSceneTest, HoldsEveryPartOfTheWorld) {
  const auto map = streetMap();
  auto input = streetInput(map);
  input.true_path = input.path;
  input.true_objects = map.movingObjects().tracks();
  auto scene = WorldScene(SceneUse::kFile, 2.f).build(input, 0.0);
  for (const char* name : {"ground_grid", "landmarks", "camera_path", "true_path", "robot",
                           "moving_objects", "true_objects", "camera"}) {
    EXPECT_NE(scene.getByName(name), nullptr) << name;
  }
  const auto cloud =
      std::dynamic_pointer_cast<mrpt::opengl::CPointCloudColoured>(scene.getByName("landmarks"));
  ASSERT_NE(cloud, nullptr);
  EXPECT_EQ(cloud->size(), map.landmarks().size());
  const auto moving = movingObjectsIn(scene);
  for (const char* name : {"faces", "trails", "predictions", "uncertainty", "edges_Car",
                           "edges_Pedestrian", "edges_Cyclist", "edges_Truck", "labels"}) {
    EXPECT_NE(moving->getByName(name), nullptr) << name;
  }
}

TEST(WorldSceneTest, LeavesOutWhatThereIsNot) {
  const map::PerceptionMap map;
  auto scene = WorldScene(SceneUse::kFile, 2.f).build(SnapshotInput{map, 0, 0.0}, 0.0);
  for (const char* name : {"camera_path", "true_path", "true_objects", "camera"}) {
    EXPECT_EQ(scene.getByName(name), nullptr) << name;
  }
}

TEST(WorldSceneTest, LeavesOutlinesAndLabelsToThePicture) {
  const auto map = streetMap();
  auto scene = WorldScene(SceneUse::kPicture, 2.f).build(streetInput(map), 0.0);
  EXPECT_EQ(scene.getByName("camera"), nullptr);
  const auto moving = movingObjectsIn(scene);
  EXPECT_NE(moving->getByName("faces"), nullptr);
  EXPECT_EQ(moving->getByName("edges_Car"), nullptr);
  EXPECT_EQ(moving->getByName("labels"), nullptr);
}

TEST(WorldSceneTest, BuildsLandmarksAgainOnlyForANewStillWorld) {
  auto map = streetMap();
  WorldScene world(SceneUse::kPicture, 2.f);
  const auto landmarksOf = [&] {
    return world.build(streetInput(map), 0.0).getByName("landmarks");
  };
  const auto first = landmarksOf();
  map.update(11.0, {});
  EXPECT_EQ(landmarksOf(), first);
  map.update(slam::MapView{});
  EXPECT_NE(landmarksOf(), first);
}

TEST(SaveSceneTest, WritesWhatMrptReads) {
  const test::TemporaryFolder folder;
  const auto map = streetMap();
  saveScene(folder / "scene.3Dscene", streetInput(map));
  mrpt::opengl::COpenGLScene scene;
  ASSERT_TRUE(scene.loadFromFile(folder / "scene.3Dscene"));
  EXPECT_NE(scene.getByName("landmarks"), nullptr);
  ASSERT_NE(movingObjectsIn(scene), nullptr);
  EXPECT_NE(movingObjectsIn(scene)->getByName("labels"), nullptr);
}

TEST(SaveSceneTest, SaysWhereItCannotWrite) {
  const map::PerceptionMap map;
  EXPECT_THROW(saveScene("/nonexistent/scene.3Dscene", SnapshotInput{map, 0, 0.0}), InputError);
}

}  // namespace
}  // namespace headway::scene
