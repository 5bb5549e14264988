// SPDX-License-Identifier: BSD-3-Clause
#include "replay_folder.h"

#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/report/replay_frames.h>
#include <headway_test/folders.h>
#include <headway_test/input_error.h>

#include <fstream>
#include <sstream>

namespace headway::report {
namespace {

using ::testing::HasSubstr;

class PlyFileTest : public ::testing::Test {
 protected:
  /// A file whose header states `count` points and that contains `written`; point i is (i, 2 i, 3
  /// i).
  std::string cloud(int count, int written, const std::string& format = "binary_little_endian") {
    const auto path = folder_ / "points.ply";
    std::ofstream file(path, std::ios::binary);
    file << "ply\nformat " << format << " 1.0\ncomment any\nelement vertex " << count
         << "\nproperty float x\nproperty float y\nproperty float z\nproperty float intensity\n"
         << "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
    for (int i = 0; i < written; ++i) {
      const float values[4] = {float(i), float(2 * i), float(3 * i), 0.5f};
      file.write(reinterpret_cast<const char*>(values), sizeof(values));
      file.write("rgb", 3);
    }
    return path;
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(PlyFileTest, ReadsEveryPoint) {
  const auto points = readPoints(cloud(5, 5), 100);
  ASSERT_EQ(points.size(), 5u);
  EXPECT_EQ(points[4].position, Eigen::Vector3f(4, 8, 12));
  EXPECT_EQ(points[4].colour.green, 'g');
}

TEST_F(PlyFileTest, ReadsASampleOfALargeCloud) {
  const auto points = readPoints(cloud(1000, 1000), 300);
  EXPECT_LE(points.size(), 300u);
  EXPECT_GE(points.size(), 200u);
  EXPECT_EQ(points[1].position, Eigen::Vector3f(4, 8, 12));
}

TEST_F(PlyFileTest, ReadsAnEmptyCloud) { EXPECT_TRUE(readPoints(cloud(0, 0), 100).empty()); }

TEST_F(PlyFileTest, RefusesTruncatedAndOtherFormats) {
  EXPECT_THROW((void)readPoints(cloud(5, 4), 100), InputError);
  EXPECT_THROW((void)readPoints(cloud(5, 5, "ascii"), 100), InputError);
  EXPECT_THROW((void)readPoints("/nonexistent.ply", 100), InputError);
}

TEST_F(PlyFileTest, ACountThatNoFileHoldsIsRefused) {
  const auto path = cloud(5, 5);
  std::stringstream content;
  content << std::ifstream(path, std::ios::binary).rdbuf();
  std::string text = content.str();
  text.replace(text.find("vertex 5"), 8, "vertex 18446744073709551615");
  std::ofstream(path, std::ios::binary) << text;
  EXPECT_THROW((void)readPoints(path, 6000), InputError);
}

class ReplayFolderTest : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
  }

  test::TemporaryFolder folder_;
};

constexpr char kHeader[] =
    "frame,time,track_id,class,status,moving,x,y,z,yaw,length,width,height,vx,vy,vz,var_x,var_y,"
    "cov_xy\n";

std::string row(double time, int id, const std::string& status, int moving, double x) {
  return "0," + std::to_string(time) + "," + std::to_string(id) + ",Cyclist," + status + "," +
         std::to_string(moving) + "," + std::to_string(x) + ",2,0,0,1.8,0.6,1.7,1,0,0,0.1,0.1,0\n";
}

TEST_F(ReplayFolderTest, ReadsASummaryAlone) {
  write("summary.json", R"({"frames": 3})");
  const auto folder = readReplayFolder(folder_.path());
  EXPECT_EQ(folder.summary.at("frames"), 3);
  EXPECT_TRUE(folder.record.is_null());
  EXPECT_TRUE(folder.trajectory.empty());
  EXPECT_TRUE(folder.tracks.empty());
  EXPECT_TRUE(folder.landmarks.empty());
  EXPECT_TRUE(folder.snapshots.empty());
}

TEST_F(ReplayFolderTest, RefusesAFolderWithoutSummaryAndMalformedFiles) {
  EXPECT_THROW((void)readReplayFolder(folder_.path()), InputError);
  write("summary.json", "[1, 2]");
  EXPECT_THROW((void)readReplayFolder(folder_.path()), InputError);
  write("summary.json", "{}");
  write("replay.json", "{ broken");
  EXPECT_THROW((void)readReplayFolder(folder_.path()), InputError);
  write("replay.json", "{}");
  write("trajectory.tum", "1.5 rubbish\n");
  EXPECT_THROW((void)readReplayFolder(folder_.path()), InputError);
}

TEST_F(ReplayFolderTest, ResultsOfTwoRunsAreRefused) {
  write("summary.json", R"({"frames": 3})");
  write("trajectory.tum", "1 0 0 0 0 0 0 1\n");
  const auto replay = [&] { (void)readReplayFolder(folder_.path()); };
  const auto frames = [&] {
    (void)readReplayFrames(folder_.path(), {}, [](const std::string&) {});
  };
  EXPECT_EQ("", test::inputErrorOf(replay));
  EXPECT_EQ("", test::inputErrorOf(frames));
  std::filesystem::create_directory(folder_ / "complete");  // left by a kill
  EXPECT_THAT(test::inputErrorOf(replay), HasSubstr("contains results of two runs"));
  EXPECT_THAT(test::inputErrorOf(frames), HasSubstr("complete/ into it"));
}

TEST_F(ReplayFolderTest, NestedJsonNeedsNoStack) {
  constexpr std::size_t kDepth = 300000;
  write("summary.json",
        "{\"lost_frames\":" + std::string(kDepth, '[') + std::string(kDepth, ']') + "}");
  EXPECT_THROW((void)readReplayFolder(folder_.path()), InputError);
}

TEST_F(ReplayFolderTest, ThePictureOfTheGridIsInTheFolder) {
  write("summary.json", "{}");
  const auto grid = [&](const std::string& image) {
    write("map_grid.yaml", "image:" + image + "\nresolution: 0.2\norigin: [1, 2, 0]\n");
    return readReplayFolder(folder_.path()).grid;
  };
  for (const char* image : {"", " ", " missing.png", " ..", " /"}) {
    EXPECT_THROW((void)grid(image), InputError) << image;
  }
  write("map_grid.png", "");
  EXPECT_EQ(folder_ / "map_grid.png", grid(" ../elsewhere/map_grid.png")->picture);
  EXPECT_EQ(2.0, grid(" map_grid.png")->origin.y());
  for (const char* origin : {"", "origin: [1.0", "origin: [1, 2]", "origin: [1, x, 0]"}) {
    write("map_grid.yaml", "image: map_grid.png\nresolution: 0.2\n" + std::string(origin) + "\n");
    EXPECT_THROW((void)readReplayFolder(folder_.path()), InputError) << origin;
  }
}

TEST_F(ReplayFolderTest, ReadsTheTrajectoryWithoutComments) {
  write("summary.json", "{}");
  write("trajectory.tum", "# t x y z qx qy qz qw\n1.5 2 -3 4 0 0 0 1\n");
  const auto trajectory = readReplayFolder(folder_.path()).trajectory;
  ASSERT_EQ(trajectory.size(), 1u);
  EXPECT_EQ(trajectory[0].time, 1.5);
  EXPECT_EQ(trajectory[0].value.translation(), Eigen::Vector3d(2, -3, 4));
}

TEST_F(ReplayFolderTest, ThinsOutALongRunAndItsTracksAlike) {
  constexpr std::size_t kRows = 120000;
  std::string trajectory, tracks = kHeader;
  for (std::size_t i = 0; i < kRows; ++i) {
    trajectory +=
        std::to_string(0.5 * static_cast<double>(i)) + " " + std::to_string(i) + " 0 0 0 0 0 1\n";
    tracks += row(0.5 * static_cast<double>(i), static_cast<int>(i / 1000), "confirmed", 1, 5.0);
  }
  write("summary.json", "{}");
  write("trajectory.tum", trajectory);
  write("tracks.csv", tracks);
  const auto folder = readReplayFolder(folder_.path());
  constexpr std::size_t kStep = 4;  // of at most 50,000 poses
  ASSERT_EQ(folder.trajectory.size(), kRows / kStep);
  for (std::size_t i = 0; i < folder.trajectory.size(); ++i) {
    ASSERT_EQ(folder.trajectory[i].time, 0.5 * static_cast<double>(kStep * i));
  }
  ASSERT_EQ(folder.tracks.size(), kRows / 1000);
  for (const auto& track : folder.tracks) ASSERT_EQ(track.points.size(), 1000 / kStep);
  EXPECT_EQ(folder.tracks[1].points[1].time, 0.5 * static_cast<double>(1000 + kStep));
}

TEST_F(ReplayFolderTest, KeepsEachSoManiethFrameOfManyBoxes) {
  std::string rows = kHeader;
  for (int frame = 0; frame < 200; ++frame) {
    for (int id = 0; id < 1000; ++id) rows += row(0.1 * frame, id, "confirmed", 1, 5.0);
  }
  write("tracks.csv", rows);
  const auto thinned = readTracks(folder_ / "tracks.csv");
  EXPECT_EQ(thinned.step, 4U);
  ASSERT_EQ(thinned.tracks.size(), 1000U);
  for (const auto& track : thinned.tracks) {
    ASSERT_EQ(track.points.size(), 50U);
    EXPECT_NEAR(track.points[1].time, 0.4, 1e-9);
  }
}

TEST_F(ReplayFolderTest, ListsSnapshotsByNameAndIgnoresOtherFiles) {
  write("summary.json", "{}");
  std::filesystem::create_directories(folder_ / "snapshots");
  for (const char* name : {"000010.png", "000002.png", "notes.txt"}) {
    write(std::string("snapshots/") + name, "");
  }
  const auto snapshots = readReplayFolder(folder_.path()).snapshots;
  ASSERT_EQ(snapshots.size(), 2u);
  EXPECT_EQ(snapshots[0].filename(), "000002.png");
  EXPECT_EQ(snapshots[1].filename(), "000010.png");
}

TEST_F(ReplayFolderTest, GroupsRowsByTrackInOrderOfAppearance) {
  write("tracks.csv", kHeader + row(2.0, 1, "confirmed", 1, 5.0) + row(1.0, 7, "coasting", 0, 6.0) +
                          row(1.5, 1, "coasting", 0, 4.0) + row(3.0, 7, "confirmed", 1, 8.0));
  const auto tracks = readTracks(folder_ / "tracks.csv").tracks;
  ASSERT_EQ(tracks.size(), 2u);
  EXPECT_EQ(tracks[0].id, 7);
  EXPECT_EQ(tracks[1].id, 1);
  EXPECT_EQ(tracks[1].object_class, ObjectClass::kCyclist);
  ASSERT_EQ(tracks[1].points.size(), 2u);
  EXPECT_EQ(tracks[1].points[0].time, 1.5);
  EXPECT_EQ(tracks[1].points[0].x, 4.0);
  EXPECT_FALSE(tracks[1].points[0].confirmed);
  EXPECT_TRUE(tracks[1].points[1].confirmed);
  EXPECT_TRUE(tracks[1].points[1].moving);
}

TEST_F(ReplayFolderTest, NamesFileAndLineOfAnIncompleteRow) {
  write("tracks.csv", kHeader + std::string("1,2,3\n"));
  try {
    (void)readTracks(folder_ / "tracks.csv");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("tracks.csv:2"));
  }
}

}  // namespace
}  // namespace headway::report
