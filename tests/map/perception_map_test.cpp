// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/map/perception_map.h>
#include <headway_test/folders.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/maps/CColouredPointsMap.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/poses/CPose2D.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "equality.h"
#include "example_world.h"

namespace headway::map {
namespace {

class PerceptionMapIniTest : public ::testing::Test {
 protected:
  std::string pathOf(const std::string& text) {
    const auto path = folder_ / "map.ini";
    std::ofstream(path) << text;
    return path;
  }

  std::string errorOf(const std::string& text) {
    const auto path = pathOf(text);
    try {
      (void)PerceptionMap::fromIni(path);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), ::testing::StartsWith(path));
      return error.what();
    }
    return "";
  }

 private:
  test::TemporaryFolder folder_;
};

TEST(PerceptionMapTest, HoldsLandmarksAndTracksInOneMultiMetricMap) {
  PerceptionMap map;
  EXPECT_TRUE(map.layers().isEmpty());
  map.update(exampleStaticMap(25));
  map.update(3.0, {exampleTrack(4, ObjectClass::kCar, {10, 2, 0.8}, 0.3)});
  EXPECT_FALSE(map.layers().isEmpty());
  EXPECT_EQ(map.layers().mapByClass<mrpt::maps::CPointsMap>().get(), &map.landmarks());
  EXPECT_EQ(map.layers().mapByClass<CMovingObjectsMap>().get(), &map.movingObjects());
  EXPECT_EQ(map.landmarks().size(), 25u);
  float x = 0.f, y = 0.f, z = 0.f;
  map.landmarks().getPoint(3, x, y, z);
  EXPECT_FLOAT_EQ(x, 3.f);
  EXPECT_FLOAT_EQ(y, -1.5f);
  EXPECT_FLOAT_EQ(z, 0.3f);
  EXPECT_EQ(map.movingObjects().time(), 3.0);
  EXPECT_EQ(map.movingObjects().tracks().size(), 1u);
}

TEST(PerceptionMapTest, UpdatesReplaceTheContents) {
  PerceptionMap map;
  map.update(exampleStaticMap(25));
  map.update(exampleStaticMap(7));
  EXPECT_EQ(map.landmarks().size(), 7u);
  EXPECT_EQ(map.staticMap()->landmarks.size(), 7u);
  map.update(1.0, {exampleTrack(1, ObjectClass::kCar, {1, 2, 3}, 0.0)});
  map.update(2.0, {});
  EXPECT_TRUE(map.movingObjects().isEmpty());
  EXPECT_EQ(map.layers().maps.size(), 2u);
}

TEST(PerceptionMapTest, CopiesAreSnapshotsThatLaterUpdatesLeaveAlone) {
  PerceptionMap map;
  map.update(exampleStaticMap(25));
  map.update(1.0, {exampleTrack(1, ObjectClass::kCar, {1, 2, 3}, 0.0)});
  const PerceptionMap snapshot = map;
  map.update(exampleStaticMap(3));
  map.update(2.0, {});
  EXPECT_EQ(snapshot.landmarks().size(), 25u);
  EXPECT_EQ(snapshot.layers().mapByClass<mrpt::maps::CPointsMap>()->size(), 25u);
  EXPECT_EQ(snapshot.movingObjects().time(), 1.0);
  EXPECT_EQ(snapshot.layers().mapByClass<CMovingObjectsMap>()->tracks().size(), 1u);
  EXPECT_EQ(snapshot.staticMap()->landmarks.size(), 25u);
}

TEST(PerceptionMapTest, AddsAStaticGridAsALayer) {
  PerceptionMap map;
  EXPECT_EQ(map.staticGrid(), nullptr);
  auto grid = mrpt::maps::COccupancyGridMap2D::Create(-5.f, 5.f, -5.f, 5.f, 0.5f);
  map.update(grid);
  EXPECT_EQ(map.staticGrid(), grid);
  const PerceptionMap snapshot = map;
  map.update(exampleStaticMap(5));
  EXPECT_EQ(map.staticGrid(), grid);
  auto other = mrpt::maps::COccupancyGridMap2D::Create(-5.f, 5.f, -5.f, 5.f, 0.25f);
  map.update(other);
  EXPECT_EQ(map.staticGrid(), other);
  EXPECT_EQ(map.layers().maps.size(), 3u);
  EXPECT_EQ(snapshot.staticGrid(), grid);
}

/// Three layers, all with something in them: a room of 8 m about the origin is the grid.
PerceptionMap fullMap(PerceptionMap map = {}) {
  map.update(exampleStaticMap(25));
  map.update(3.0, {exampleTrack(4, ObjectClass::kCar, {10, 2, 0.8}, 0.3)});
  auto grid = mrpt::maps::COccupancyGridMap2D::Create(-6.f, 6.f, -6.f, 6.f, 0.2f);
  for (float x = -4.f; x <= 4.f; x += 0.1f) {
    for (float y = -4.f; y <= 4.f; y += 0.1f) {
      const bool wall = std::max(std::abs(x), std::abs(y)) > 3.75f;
      grid->setPos(x, y, wall ? 0.02f : 0.98f);
    }
  }
  map.update(grid);
  return map;
}

TEST(PerceptionMapTest, IsDrawnWrittenAndStoredAsAnyMrptMap) {
  const auto map = fullMap();
  mrpt::opengl::CSetOfObjects drawn;
  map.layers().getVisualizationInto(drawn);
  EXPECT_GE(drawn.size(), 3u);

  const test::TemporaryFolder folder;
  map.layers().saveMetricMapRepresentationToFile(folder / "map");
  std::set<std::string> endings;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    endings.insert(entry.path().extension());
    EXPECT_GT(std::filesystem::file_size(entry.path()), 0u) << entry.path();
  }
  EXPECT_THAT(endings, ::testing::IsSupersetOf({".3Dscene", ".txt", ".png"}));

  mrpt::io::CMemoryStream stream;
  auto archive = mrpt::serialization::archiveFrom(stream);
  archive.WriteObject(map.layers());
  stream.Seek(0);
  auto layers = std::make_shared<mrpt::maps::CMultiMetricMap>();
  archive.ReadObject(layers.get());
  const PerceptionMap read(layers);
  EXPECT_EQ(read.landmarks().size(), 25u);
  EXPECT_EQ(read.movingObjects().tracks().size(), 1u);
  ASSERT_NE(read.staticGrid(), nullptr);
  EXPECT_EQ(read.staticGrid()->getRawMap(), map.staticGrid()->getRawMap());
}

TEST(PerceptionMapTest, ScansAreLikelierWhereTheStaticMapExplainsThem) {
  const auto map = fullMap();
  mrpt::obs::CObservation2DRangeScan scan;
  scan.aperture = 2.f * static_cast<float>(M_PI);
  scan.rightToLeft = true;
  scan.maxRange = 20.f;
  map.staticGrid()->laserScanSimulator(scan, mrpt::poses::CPose2D(1.0, 0.5, 0.0), 0.5f, 180);
  auto& layers = const_cast<mrpt::maps::CMultiMetricMap&>(map.layers());
  EXPECT_TRUE(layers.canComputeObservationLikelihood(scan));
  const auto at = [&](double x, double y) {
    return layers.computeObservationLikelihood(scan, mrpt::poses::CPose3D(x, y, 0, 0, 0, 0));
  };
  EXPECT_GT(at(1.0, 0.5), at(1.6, 0.5));
  EXPECT_GT(at(1.0, 0.5), at(-1.0, -2.0));
  EXPECT_FALSE(map.movingObjects().isEmpty()) << "moving objects are not affected";
}

TEST(PerceptionMapTest, RefusesLayersWithoutLandmarksOrMovingObjects) {
  auto layers = std::make_shared<mrpt::maps::CMultiMetricMap>();
  layers->maps.push_back(mrpt::maps::CSimplePointsMap::Create());
  EXPECT_THROW(PerceptionMap{layers}, InputError);
  layers->maps.clear();
  layers->maps.push_back(CMovingObjectsMap::Create());
  EXPECT_THROW(PerceptionMap{layers}, InputError);
}

TEST_F(PerceptionMapIniTest, BuildsTheLayersThatItNames) {
  auto map = PerceptionMap::fromIni(
      pathOf("[map]\ncolourPointsMap_count=1\noccupancyGrid_count=1\nmovingObjectsMap_count=1\n"));
  EXPECT_EQ(map.layers().maps.size(), 3u);
  EXPECT_NE(map.layers().mapByClass<mrpt::maps::COccupancyGridMap2D>(), nullptr);
  map.update(exampleStaticMap(25));
  const auto* coloured = dynamic_cast<const mrpt::maps::CColouredPointsMap*>(&map.landmarks());
  ASSERT_NE(coloured, nullptr);
  float x, y, z, red, green, blue;
  coloured->getPointRGB(10, x, y, z, red, green, blue);
  EXPECT_FLOAT_EQ(red, 60.f / 255.f);
  EXPECT_FLOAT_EQ(blue, 60.f / 255.f);
}

TEST_F(PerceptionMapIniTest, GridOptionsApplyToEveryLaterGrid) {
  const auto map = fullMap(PerceptionMap::fromIni(
      pathOf("[map]\npointsMap_count=1\noccupancyGrid_count=1\nmovingObjectsMap_count=1\n"
             "[map_occupancyGrid_00_creationOpts]\nenableSaveAs3DObject=false\n"
             "[map_occupancyGrid_00_insertOpts]\nmaxOccupancyUpdateCertainty=0.77\n"
             "[map_occupancyGrid_00_likelihoodOpts]\nLF_decimation=7\n")));
  EXPECT_EQ(map.layers().maps.size(), 3u);
  EXPECT_GT(map.staticGrid()->getSizeX(), 0u);
  EXPECT_FALSE(map.staticGrid()->genericMapParams.enableSaveAs3DObject);
  EXPECT_FLOAT_EQ(map.staticGrid()->insertionOptions.maxOccupancyUpdateCertainty, 0.77f);
  EXPECT_EQ(map.staticGrid()->likelihoodOptions.LF_decimation, 7u);
}

TEST_F(PerceptionMapIniTest, ErrorsStateTheReason) {
  EXPECT_THAT(errorOf("[map]\npointsMap_count=1\n"), ::testing::HasSubstr("movingObjectsMap"));
  EXPECT_THAT(errorOf("[map]\nmovingObjectsMap_count=1\n"), ::testing::HasSubstr("pointsMap"));
  EXPECT_THAT(errorOf("[map]\npointsMap_count=1\nmovingObjectMap_count=1\n"),
              ::testing::HasSubstr("movingObjectMap_count"));
  EXPECT_THAT(errorOf("[maps]\npointsMap_count=1\n"), ::testing::HasSubstr("[map]"));
  EXPECT_THROW((void)PerceptionMap::fromIni("/nonexistent.ini"), InputError);
}

}  // namespace
}  // namespace headway::map
