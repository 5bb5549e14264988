// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/core/mrpt_pose.h>
#include <headway/map/map_export.h>
#include <headway_test/folders.h>
#include <mrpt/core/Clock.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>

#include "example_world.h"

namespace headway::map {
namespace {

TEST(WriteSimpleMapTest, HoldsKeyframesWithPosesCovariancesAndLandmarks) {
  const test::TemporaryFolder folder;
  const auto world = exampleStaticMap();
  writeSimpleMap(folder / "map.simplemap", world);
  mrpt::maps::CSimpleMap read;
  ASSERT_TRUE(read.loadFromFile(folder / "map.simplemap"));
  ASSERT_EQ(read.size(), 3u);
  const auto& keyframe = *std::next(read.begin(), 2);  // whose type depends on the version of MRPT
  const auto gaussian =
      std::dynamic_pointer_cast<const mrpt::poses::CPose3DPDFGaussian>(keyframe.pose);
  ASSERT_NE(gaussian, nullptr);
  EXPECT_TRUE(fromMrpt(gaussian->mean).isApprox(world.keyframes[2].T_map_robot, 1e-9));
  EXPECT_NEAR(gaussian->cov(0, 0), 0.03, 1e-12);
  const auto scan = keyframe.sf->getObservationByClass<mrpt::obs::CObservation3DRangeScan>();
  ASSERT_NE(scan, nullptr);
  EXPECT_EQ(scan->sensorLabel, "landmarks");
  EXPECT_NEAR(mrpt::Clock::toDouble(scan->timestamp), 102.0, 1e-6);
  EXPECT_EQ(scan->points3D_x.size(), world.keyframes[2].landmarks.size());
}

TEST(WriteSimpleMapTest, GivesBackTheLandmarksWhenAPointMapIsBuiltFromIt) {
  const test::TemporaryFolder folder;
  const auto world = exampleStaticMap();
  writeSimpleMap(folder / "map.simplemap", world);
  mrpt::maps::CSimpleMap read;
  ASSERT_TRUE(read.loadFromFile(folder / "map.simplemap"));
  mrpt::maps::CSimplePointsMap points;
  points.insertionOptions.minDistBetweenLaserPoints = 0.f;
  points.loadFromSimpleMap(read);
  ASSERT_GT(points.size(), 0u);
  for (const auto& landmark : world.landmarks) {
    float squared = 0.f;
    points.kdTreeClosestPoint3D(landmark.position.cast<float>().x(),
                                landmark.position.cast<float>().y(),
                                landmark.position.cast<float>().z(), squared);
    EXPECT_LT(squared, 1e-6f);
  }
}

TEST(WriteSimpleMapTest, LeavesOutLandmarksThatAreGone) {
  const test::TemporaryFolder folder;
  auto world = exampleStaticMap();
  world.landmarks = {};
  writeSimpleMap(folder / "map.simplemap", world);
  mrpt::maps::CSimpleMap read;
  ASSERT_TRUE(read.loadFromFile(folder / "map.simplemap"));
  EXPECT_EQ(read.size(), 3u);
}

TEST(WritePlyTest, IsReadByMrptWithPositionsAndGrey) {
  const test::TemporaryFolder folder;
  const auto world = exampleStaticMap();
  writePly(folder / "points.ply", world);
  mrpt::opengl::CPointCloudColoured cloud;
  ASSERT_TRUE(cloud.loadFromPlyFile(folder / "points.ply")) << cloud.getLoadPLYErrorString();
  ASSERT_EQ(cloud.size(), world.landmarks.size());
  const auto point = cloud.getPoint3Df(7);
  EXPECT_FLOAT_EQ(point.x, 7.f);
  EXPECT_FLOAT_EQ(point.y, 0.5f);
  EXPECT_EQ(cloud.getPointColor(7).R, 42);
  EXPECT_EQ(cloud.getPointColor(7).B, 42);
}

TEST(WritePlyTest, HoldsNoPointsWhereThereAreNone) {
  const test::TemporaryFolder folder;
  writePly(folder / "points.ply", slam::MapView());
  EXPECT_TRUE(std::filesystem::exists(folder / "points.ply"));
}

TEST(MapExportTest, NamesThePathThatCannotBeWritten) {
  EXPECT_THROW(writePly("/nonexistent/points.ply", slam::MapView()), InputError);
  EXPECT_THROW(writeSimpleMap("/nonexistent/map.simplemap", {}), InputError);
}

}  // namespace
}  // namespace headway::map
