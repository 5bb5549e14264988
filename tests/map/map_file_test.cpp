// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/compression.h>
#include <headway/core/error.h>
#include <headway/core/version.h>
#include <headway/map/map_file.h>
#include <headway_test/folders.h>

#include <cstring>
#include <fstream>
#include <sstream>

#include "checked_file.h"
#include "equality.h"
#include "example_world.h"

namespace headway::map {
namespace {

StereoCamera exampleCamera() {
  StereoCamera camera;
  camera.width = 640;
  camera.height = 240;
  camera.fx = 401.5;
  camera.fy = 402.5;
  camera.cx = 319.25;
  camera.cy = 119.75;
  camera.baseline_m = 0.31;
  camera.T_robot_cam = Eigen::Translation3d(0.5, 0.1, 1.2) * robotFromOptical();
  return camera;
}

StoredMap exampleMap(int landmarks = 40) {
  StoredMap stored;
  stored.map.update(exampleStaticMap(landmarks));
  stored.map.update(3.0, {exampleTrack(4, ObjectClass::kCyclist, {10, 2, 0.8}, 0.3)});
  stored.configuration = "[slam]\nmapping = true\n";
  stored.camera = exampleCamera();
  stored.attachments["place_index"] = std::string("\0any\xff bytes", 11);
  return stored;
}

/// As small as a map can be that has everything in it.
StoredMap smallMap() {
  StoredMap stored = exampleMap(1);
  auto track = stored.map.movingObjects().tracks()[0];
  track.recent_path.resize(1);
  track.predictions.resize(1);
  track.predictions[0].points.resize(1);
  auto static_map = *stored.map.staticMap();
  static_map.keyframes = {slam::KeyframeView()};
  stored.map.update(static_map);
  stored.map.update(3.0, {track});
  return stored;
}

class MapFileTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::string bytesOf(const std::string& name) const {
    std::ifstream file(name, std::ios::binary);
    std::ostringstream bytes;
    bytes << file.rdbuf();
    return bytes.str();
  }

  std::string saved(const StoredMap& stored) const {
    saveMap(path, stored);
    return bytesOf(path);
  }

  std::string errorOfLoading(const std::string& bytes) const {
    std::filesystem::remove(path);  // a file that is cut short and rewritten goes to disk at once
    std::ofstream(path, std::ios::binary) << bytes;
    try {
      (void)loadMap(path);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), ::testing::StartsWith(path));
      EXPECT_THAT(error.what(), ::testing::Not(::testing::HasSubstr("\n")));
      return error.what();
    }
    return "";
  }

  test::TemporaryFolder folder;
  std::string path = folder / "map.headway";
};

TEST_F(MapFileTest, RoundTrips) {
  const StoredMap stored = exampleMap();
  (void)saved(stored);
  const StoredMap loaded = loadMap(path);
  expectEqual(*loaded.map.staticMap(), *stored.map.staticMap());
  ASSERT_EQ(loaded.map.movingObjects().tracks().size(), 1u);
  expectEqual(loaded.map.movingObjects().tracks()[0], stored.map.movingObjects().tracks()[0]);
  EXPECT_EQ(loaded.map.movingObjects().time(), 3.0);
  EXPECT_EQ(loaded.map.landmarks().size(), 40u);
  EXPECT_EQ(loaded.configuration, stored.configuration);
  EXPECT_EQ(loaded.attachments, stored.attachments);
  ASSERT_TRUE(loaded.camera);
  EXPECT_EQ(loaded.camera->width, 640);
  EXPECT_EQ(loaded.camera->height, 240);
  EXPECT_EQ(loaded.camera->fx, 401.5);
  EXPECT_EQ(loaded.camera->fy, 402.5);
  EXPECT_EQ(loaded.camera->cx, 319.25);
  EXPECT_EQ(loaded.camera->cy, 119.75);
  EXPECT_EQ(loaded.camera->baseline_m, 0.31);
  EXPECT_EQ(loaded.camera->T_robot_cam.matrix(), exampleCamera().T_robot_cam.matrix());
}

TEST_F(MapFileTest, AttachmentsThatAreMadeWhileWritingGiveTheSameFile) {
  StoredMap stored = exampleMap();
  stored.attachments["slam"] = "landmarks";
  stored.camera.reset();  // so that they are not read
  const std::string whole = saved(stored);
  stored.attachments.erase("slam");
  stored.made_attachments["slam"] = [](const ByteSink& sink) {
    for (const char* piece : {"land", "", "marks"}) sink(piece);
  };
  EXPECT_EQ(saved(stored), whole);
}

TEST_F(MapFileTest, HoldsAnEmptyMapWithoutCamera) {
  (void)saved(StoredMap());
  const StoredMap loaded = loadMap(path);
  EXPECT_TRUE(loaded.map.layers().isEmpty());
  EXPECT_FALSE(loaded.camera);
  EXPECT_TRUE(loaded.attachments.empty());
}

TEST_F(MapFileTest, KeepsTheStaticGrid) {
  StoredMap stored = exampleMap(4);
  auto grid = mrpt::maps::COccupancyGridMap2D::Create(-5.f, 5.f, -5.f, 5.f, 0.5f);
  grid->setCell(3, 4, 0.1f);
  stored.map.update(grid);
  (void)saved(stored);
  const auto loaded = loadMap(path).map.staticGrid();
  ASSERT_NE(loaded, nullptr);
  EXPECT_EQ(loaded->getRawMap(), grid->getRawMap());
}

TEST_F(MapFileTest, SameContentsGiveTheSameBytes) {
  EXPECT_EQ(saved(exampleMap()), saved(exampleMap()));
  saveMap(path, exampleMap());
  const StoredMap loaded = loadMap(path);
  const std::string before = bytesOf(path);
  EXPECT_EQ(saved(loaded), before);
}

TEST_F(MapFileTest, TruncatedAnywhereIsSaidToBe) {
  const std::string whole = saved(smallMap());
  for (std::size_t size = 1; size < whole.size(); ++size) {
    ASSERT_THAT(errorOfLoading(whole.substr(0, size)), ::testing::HasSubstr("truncated"))
        << "at byte " << size;
  }
}

TEST_F(MapFileTest, AnyFlippedByteIsNoticed) {
  const std::string whole = saved(smallMap());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string flipped = whole;
    flipped[i] = static_cast<char>(flipped[i] ^ 0x40);
    ASSERT_THAT(errorOfLoading(flipped),
                i < 8 ? ::testing::HasSubstr("not a headway map") : ::testing::HasSubstr("damaged"))
        << "at byte " << i;
  }
}

TEST_F(MapFileTest, SomethingElseIsSaidToBeForeign) {
  EXPECT_THAT(errorOfLoading(""), ::testing::HasSubstr("not a headway map"));
  EXPECT_THAT(errorOfLoading("\x1f\x8b a gz file perhaps, such as a rawlog"),
              ::testing::HasSubstr("not a headway map"));
  EXPECT_THAT(errorOfLoading(saved(exampleMap(4)) + "x"), ::testing::HasSubstr("damaged"));
}

TEST_F(MapFileTest, AMissingFileAndAFolderAreErrors) {
  EXPECT_THROW((void)loadMap(folder / "none.headway"), InputError);
  EXPECT_THROW((void)loadMap(folder.path()), InputError);
}

TEST_F(MapFileTest, ANewerSectionIsSaidToBeNewer) {
  writeCheckedFile(path, {{"camera", 99, "?"}});
  EXPECT_THAT(errorOfLoading(bytesOf(path)), ::testing::HasSubstr("newer version"));
}

TEST_F(MapFileTest, AnotherFormatVersionIsNamedWithWhatToDo) {
  const std::string whole = saved(exampleMap(4));
  const auto ofVersion = [&](char version) {
    std::string bytes = whole;
    bytes[8] = version;  // after the magic
    const std::uint32_t sum = checksum(std::string_view(bytes).substr(0, 32));
    std::memcpy(&bytes[32], &sum, sizeof(sum));
    return bytes;
  };
  EXPECT_EQ(errorOfLoading(ofVersion(2)), "");
  EXPECT_THAT(
      errorOfLoading(ofVersion(1)),
      ::testing::HasSubstr("of format version 1, and this program reads 2; replay its rawlog"));
  EXPECT_THAT(errorOfLoading(ofVersion(3)),
              ::testing::HasSubstr("of format version 3, newer than 2"));
}

TEST_F(MapFileTest, AnErrorNamesTheProgramThatWroteTheFile) {
  writeCheckedFile(path, {{"program", 1, "headway 7.8.9"}, {"camera", 99, "?"}});
  EXPECT_THAT(errorOfLoading(bytesOf(path)), ::testing::HasSubstr("written by headway 7.8.9"));
}

TEST_F(MapFileTest, TheFirstSectionIsTheProgramsVersionWhichOldFilesLack) {
  (void)saved(exampleMap(4));
  auto sections = readCheckedFile(path);
  EXPECT_EQ("program", sections.front().name);
  EXPECT_EQ(std::string("headway ") + kVersion, sections.front().bytes);
  sections.erase(sections.begin());
  writeCheckedFile(path, sections);
  EXPECT_EQ(loadMap(path).map.landmarks().size(), 4u);
}

TEST_F(MapFileTest, AnUnknownSectionIsLeftAlone) {
  (void)saved(exampleMap(4));
  auto sections = readCheckedFile(path);
  sections.push_back({"from_the_future", 1, "?"});
  writeCheckedFile(path, sections);
  EXPECT_EQ(loadMap(path).map.landmarks().size(), 4u);
}

TEST_F(MapFileTest, ASectionThatEndsEarlyOrIsMissingIsNamed) {
  (void)saved(exampleMap(4));
  const auto sections = readCheckedFile(path);
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const std::string& name = sections[i].name;
    if (name != "camera" && name != "static_map" && name != "layers") continue;
    auto shortened = sections;
    shortened[i].bytes.resize(shortened[i].bytes.size() / 2);
    writeCheckedFile(path, shortened);
    EXPECT_THAT(errorOfLoading(bytesOf(path)), ::testing::HasSubstr("'" + name + "'"));
  }
  writeCheckedFile(path, {sections.front()});
  EXPECT_THAT(errorOfLoading(bytesOf(path)), ::testing::HasSubstr("'static_map'"));
}

TEST_F(MapFileTest, AGridWithMoreCellsThanBytesIsRefusedBeforeItIsMade) {
  StoredMap stored = exampleMap(4);
  stored.map.update(mrpt::maps::COccupancyGridMap2D::Create(-5.f, 5.f, -5.f, 5.f, 0.5f));
  (void)saved(stored);
  auto sections = readCheckedFile(path);
  for (auto& section : sections) {
    const auto grid = section.bytes.find("COccupancyGridMap2D");
    if (section.name != "layers" || grid == std::string::npos) continue;
    const std::uint32_t huge[] = {60000, 60000};
    std::memcpy(section.bytes.data() + grid + 19 + 2, huge, sizeof huge);
  }
  writeCheckedFile(path, sections);
  EXPECT_THAT(errorOfLoading(bytesOf(path)), ::testing::HasSubstr("more cells than bytes"));
}

TEST_F(MapFileTest, AGridWithMoreWeightsThanBytesIsRefusedBeforeTheyAreMade) {
  StoredMap stored = exampleMap(4);
  const auto grid = mrpt::maps::COccupancyGridMap2D::Create(-5.f, 5.f, -5.f, 5.f, 0.5f);
  grid->likelihoodOptions.OWA_weights = {0.625F, 0.375F};
  stored.map.update(grid);
  (void)saved(stored);
  EXPECT_NO_THROW((void)loadMap(path));
  auto sections = readCheckedFile(path);
  const float weights[] = {0.625F, 0.375F};
  const std::string stored_weights(reinterpret_cast<const char*>(weights), sizeof weights);
  bool changed = false;
  for (auto& section : sections) {
    const auto at = section.bytes.find(stored_weights);
    if (section.name != "layers" || at == std::string::npos) continue;
    const std::uint32_t huge = 0xA34D0000;
    std::memcpy(section.bytes.data() + at - sizeof huge, &huge, sizeof huge);
    changed = true;
  }
  ASSERT_TRUE(changed);
  writeCheckedFile(path, sections);
  EXPECT_THAT(errorOfLoading(bytesOf(path)), ::testing::HasSubstr("more weights than bytes"));
}

TEST_F(MapFileTest, MoreLayersOrPointsThanBytesAreRefusedBeforeTheyAreMade) {
  for (const std::string& name : {std::string("CMultiMetricMap"), std::string("PointsMap")}) {
    (void)saved(exampleMap(4));
    auto sections = readCheckedFile(path);
    bool changed = false;
    for (auto& section : sections) {
      const auto at = section.bytes.find(name);
      if (section.name != "layers" || at == std::string::npos) continue;
      const std::uint32_t huge = 0x04040404;
      std::memcpy(section.bytes.data() + at + name.size() + 1, &huge, sizeof huge);
      changed = true;
    }
    ASSERT_TRUE(changed) << name;
    writeCheckedFile(path, sections);
    EXPECT_THAT(errorOfLoading(bytesOf(path)), ::testing::HasSubstr("more elements than bytes"));
  }
}

TEST_F(MapFileTest, LeavesNoFileAfterAFailedWrite) {
  EXPECT_THROW(saveMap((folder / "no") / "such" / "map.headway", exampleMap(4)), InputError);
  saveMap(path, exampleMap(4));
  const auto before = bytesOf(path);
  std::filesystem::create_directory(folder / "taken.headway");
  EXPECT_THROW(saveMap(folder / "taken.headway", exampleMap(4)), InputError);
  EXPECT_EQ(2, std::distance(std::filesystem::directory_iterator(folder.path()), {}));
  EXPECT_EQ(bytesOf(path), before);
}

}  // namespace
}  // namespace headway::map
