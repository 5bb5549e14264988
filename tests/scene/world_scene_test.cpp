// SPDX-License-Identifier: BSD-3-Clause
#include "world_scene.h"

#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway_test/folders.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/opengl/CTexturedPlane.h>

#include "example_street.h"
#include "view.h"

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
  auto scene = WorldScene(SceneUse::kFile, 2.f).build(input, 0.0);
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

TEST(WorldSceneTest, PicturesOfTwoSizesShowTheSameLandmarks) {
  const auto map = streetMap();
  const auto input = streetInput(map);
  const auto pointsAt = [&](int width, int height) {
    SnapshotOptions options;
    options.width = width;
    options.height = height;
    const auto view = externalView(options, input, 0.0);
    auto scene = WorldScene(SceneUse::kPicture, 2.f).build(input, 0.0, &view);
    return pointsIn(scene);
  };
  EXPECT_EQ(pointsAt(1280, 720), pointsAt(3840, 2160));
}

TEST(WorldSceneTest, ShowsTheOccupancyGridBelowEverythingElse) {
  auto map = streetMap();
  map.update(mrpt::maps::COccupancyGridMap2D::Create(-500.f, 500.f, -10.f, 20.f, 0.5f));
  const auto input = streetInput(map);
  const auto planeIn = [&](const render::PinholeView* view) {
    auto scene = WorldScene(SceneUse::kPicture, 2.f).build(input, 0.0, view);
    return std::dynamic_pointer_cast<mrpt::opengl::CTexturedPlane>(scene.getByName("occupancy"));
  };
  const SnapshotOptions options;
  const auto view = externalView(options, input, 0.0);
  const auto plane = planeIn(&view);
  ASSERT_NE(plane, nullptr);
  float x_min = 0.f, x_max = 0.f, y_min = 0.f, y_max = 0.f;
  plane->getPlaneCorners(x_min, x_max, y_min, y_max);
  EXPECT_LT(x_max - x_min, 130.f) << "what a picture shows";
  EXPECT_FLOAT_EQ(y_min, -10.f);
  EXPECT_FLOAT_EQ(y_max, 20.f);
  EXPECT_LT(plane->getPoseZ(), 0.0);
  EXPECT_NE(planeIn(nullptr), nullptr);
}

TEST(WorldSceneTest, OmitsMissingParts) {
  const map::PerceptionMap map;
  auto scene = WorldScene(SceneUse::kFile, 2.f).build(SnapshotInput{map, 0, 0.0}, 0.0);
  for (const char* name : {"camera_path", "true_path", "true_objects", "camera"}) {
    EXPECT_EQ(scene.getByName(name), nullptr) << name;
  }
}

TEST(WorldSceneTest, OmitsOutlinesAndLabelsForPictures) {
  const auto map = streetMap();
  auto scene = WorldScene(SceneUse::kPicture, 2.f).build(streetInput(map), 0.0);
  EXPECT_EQ(scene.getByName("camera"), nullptr);
  const auto moving = movingObjectsIn(scene);
  EXPECT_NE(moving->getByName("faces"), nullptr);
  EXPECT_EQ(moving->getByName("edges_Car"), nullptr);
  EXPECT_EQ(moving->getByName("labels"), nullptr);
}

TEST(WorldSceneTest, RebuildsLandmarksOnlyForANewStaticMap) {
  auto map = streetMap();
  WorldScene world(SceneUse::kPicture, 2.f);
  const auto firstCloud = [&] {
    auto scene = world.build(streetInput(map), 0.0);
    return *landmarksIn(scene)->begin();
  };
  const auto first = firstCloud();
  map.update(11.0, {});
  EXPECT_EQ(firstCloud(), first);
  map.update(slam::MapView(*map.staticMap()));
  EXPECT_NE(firstCloud(), first);
}

TEST(WorldSceneTest, ContainsAllNearVisibleLandmarksAndASampleOfTheOthers) {
  const auto map = streetMap();
  const auto view =
      render::makeView(640, 360, 1.0, render::lookAt({0.0, 0.0, 2.0}, {30.0, 0.0, 1.0}));
  auto scene = WorldScene(SceneUse::kPicture, 2.f).build(streetInput(map), 0.0, &view);
  std::set<std::tuple<float, float, float>> drawn;
  for (const auto& object : *landmarksIn(scene)) {
    const auto cloud = std::dynamic_pointer_cast<mrpt::opengl::CPointCloudColoured>(object);
    for (std::size_t i = 0; i < cloud->size(); ++i) {
      const auto p = cloud->getPoint3Df(i);
      drawn.insert({p.x, p.y, p.z});
    }
  }
  EXPECT_LT(drawn.size(), map.landmarks().size());
  std::size_t near = 0;
  for (const auto& landmark : map.staticMap()->landmarks) {
    const auto pixel = render::project(landmark.position, view);
    const bool in_picture = pixel && pixel->x() > 0 && pixel->x() < 640 && pixel->y() > 0 &&
                            pixel->y() < 360 && landmark.position.x() < 59.0;
    if (!in_picture) continue;
    const Eigen::Vector3f p = landmark.position.cast<float>();
    EXPECT_EQ(drawn.count({p.x(), p.y(), p.z()}), 1u);
    ++near;
  }
  EXPECT_GT(near, 500u);
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
