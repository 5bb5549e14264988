// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/map/moving_objects_map.h>
#include <headway_test/folders.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/maps/CMultiMetricMap.h>
#include <mrpt/maps/TMetricMapInitializer.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/serialization/CArchive.h>

#include <fstream>

#include "equality.h"
#include "example_world.h"

namespace headway {
namespace {

CMovingObjectsMap exampleMap() {
  CMovingObjectsMap map;
  map.setTracks(3.0, {map::exampleTrack(4, ObjectClass::kCar, {10, 2, 0.8}, 0.3),
                      map::exampleTrack(7, ObjectClass::kPedestrian, {6, -2, 0.9}, -1.2)});
  return map;
}

std::set<std::string> namesIn(const mrpt::opengl::CSetOfObjects& objects) {
  std::set<std::string> names;
  for (const auto& object : objects) names.insert(object->getName());
  return names;
}

TEST(MovingObjectsMapTest, IsRegisteredWithMrpt) {
  const auto object = mrpt::rtti::classFactory("headway::CMovingObjectsMap");
  ASSERT_NE(object, nullptr);
  EXPECT_NE(dynamic_cast<const CMovingObjectsMap*>(object.get()), nullptr);
}

TEST(MovingObjectsMapTest, RoundTripsThroughAnArchive) {
  CMovingObjectsMap map = exampleMap();
  map.insertionOptions.show_labels = false;
  map.genericMapParams.enableObservationInsertion = false;
  mrpt::io::CMemoryStream stream;
  auto archive = mrpt::serialization::archiveFrom(stream);
  archive << map;
  stream.Seek(0);
  const auto read = archive.ReadObject<CMovingObjectsMap>();
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(read->time(), 3.0);
  EXPECT_FALSE(read->insertionOptions.show_labels);
  EXPECT_FALSE(read->genericMapParams.enableObservationInsertion);
  ASSERT_EQ(read->tracks().size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) map::expectEqual(read->tracks()[i], map.tracks()[i]);
}

TEST(MovingObjectsMapTest, RefusesAnArchiveOfANewerVersion) {
  class Newer : public CMovingObjectsMap {
   public:
    void readAs(mrpt::serialization::CArchive& in, std::uint8_t version) {
      serializeFrom(in, version);
    }
  };
  mrpt::io::CMemoryStream stream;
  auto archive = mrpt::serialization::archiveFrom(stream);
  Newer map;
  EXPECT_THROW(map.readAs(archive, 200), std::exception);
}

TEST(MovingObjectsMapTest, IsEmptyInitiallyAndAfterClear) {
  CMovingObjectsMap map;
  EXPECT_TRUE(map.isEmpty());
  map = exampleMap();
  EXPECT_FALSE(map.isEmpty());
  map.clear();
  EXPECT_TRUE(map.isEmpty());
}

TEST(MovingObjectsMapTest, RefusesObservations) {
  CMovingObjectsMap map;
  mrpt::obs::CObservationOdometry observation;
  EXPECT_FALSE(map.insertObservation(observation));
  EXPECT_FALSE(map.canComputeObservationLikelihood(observation));
  EXPECT_TRUE(map.isEmpty());
}

TEST(MovingObjectsMapTest, IsALayerOfAMultiMetricMapDescribedByAnIni) {
  const mrpt::config::CConfigFileMemory ini(
      "[map]\npointsMap_count=1\nmovingObjectsMap_count=1\n"
      "[map_movingObjectsMap_00_insertOpts]\nshow_labels=false\n");
  mrpt::maps::TSetOfMetricMapInitializers initializers;
  initializers.loadFromConfigFile(ini, "map");
  mrpt::maps::CMultiMetricMap layers;
  layers.setListOfMaps(initializers);
  const auto map = layers.mapByClass<CMovingObjectsMap>();
  ASSERT_NE(map, nullptr);
  EXPECT_FALSE(map->insertionOptions.show_labels);
  EXPECT_TRUE(map->insertionOptions.show_predictions);
  std::stringstream text;
  initializers.dumpToTextStream(text);
  EXPECT_THAT(text.str(), ::testing::HasSubstr("show_labels      = false"));
}

TEST(MovingObjectsMapTest, ShowsBoxesTrailsPredictionsAndLabels) {
  mrpt::opengl::CSetOfObjects objects;
  exampleMap().getVisualizationInto(objects);
  EXPECT_EQ(namesIn(objects),
            (std::set<std::string>{"uncertainty", "trails", "predictions", "faces", "edges_Car",
                                   "edges_Pedestrian", "labels"}));
}

TEST(MovingObjectsMapTest, OmitsDisabledParts) {
  CMovingObjectsMap map = exampleMap();
  map.insertionOptions.show_labels = false;
  mrpt::opengl::CSetOfObjects objects;
  map.getVisualizationInto(objects);
  EXPECT_EQ(namesIn(objects).count("labels"), 0u);
  map.genericMapParams.enableSaveAs3DObject = false;
  mrpt::opengl::CSetOfObjects nothing;
  map.getVisualizationInto(nothing);
  EXPECT_EQ(nothing.size(), 0u);
}

TEST(MovingObjectsMapTest, ShowsTentativeTracksOnlyIfEnabled) {
  CMovingObjectsMap map;
  auto track = map::exampleTrack(1, ObjectClass::kCar, {1, 2, 3}, 0.0);
  track.status = TrackStatus::kTentative;
  map.setTracks(1.0, {track});
  mrpt::opengl::CSetOfObjects without, with;
  map.getVisualizationInto(without);
  EXPECT_EQ(without.size(), 0u);
  map.insertionOptions.show_tentative = true;
  map.getVisualizationInto(with);
  EXPECT_GT(with.size(), 0u);
}

TEST(MovingObjectsMapTest, SavesASceneAndATable) {
  const test::TemporaryFolder folder;
  exampleMap().saveMetricMapRepresentationToFile(folder / "map");
  mrpt::opengl::COpenGLScene scene;
  EXPECT_TRUE(scene.loadFromFile(folder / "map_moving_objects.3Dscene"));
  std::ifstream table(folder / "map_moving_objects.txt");
  std::string header, first;
  std::getline(table, header);
  std::getline(table, first);
  EXPECT_THAT(first, ::testing::StartsWith("3.000000000 4 Car confirmed 10.0"));
  EXPECT_THROW(exampleMap().saveMetricMapRepresentationToFile("/nonexistent/map"), InputError);
}

}  // namespace
}  // namespace headway
