// SPDX-License-Identifier: BSD-3-Clause
// headway-export on the results of a replay, read by programs that are not headway's where they
// exist.
#include <gmock/gmock.h>
#include <headway_test/folders.h>
#include <headway_test/npm_packages.h>
#include <headway_test/process.h>

#include <opencv2/imgcodecs.hpp>

#include "small_replay.h"

namespace headway {
namespace {

using test::contentsOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ReplayExportTest : public ::testing::Test {
 protected:
  ReplayExportTest() {
    test::writeReplayRawlog(rawlog_);
    test::writeSmallReplay(replay_, rawlog_);
    const cv::Mat cells = (cv::Mat_<unsigned char>(2, 3) << 254, 205, 0, 205, 254, 254);
    cv::imwrite(replay_ + "/map_grid.png", cells);
    std::ofstream(replay_ + "/map_grid.yaml")
        << "image: map_grid.png\nresolution: 0.5\norigin: [-1.5, -2, 0.0]\nnegate: 0\n";
    std::ofstream ply(replay_ + "/map_points.ply", std::ios::binary);
    ply << "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty "
           "float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar "
           "blue\nend_header\n";
    for (int i = 0; i < 2; ++i) {
      const float place[3] = {1.0F + static_cast<float>(i), 2.0F, 3.0F};
      ply.write(reinterpret_cast<const char*>(place), sizeof place);
      ply.write("\x10\x20\x30", 3);
    }
  }

  [[nodiscard]] test::ProcessResult exported(const std::string& command, const std::string& output,
                                             const std::string& more = "") const {
    return test::runProcess(test::program("headway-export") + " " + command + " " + replay_ +
                            " -o " + at(output) + " " + more);
  }
  [[nodiscard]] std::string at(const std::string& name) const { return folder_ / name; }

  test::TemporaryFolder folder_;
  std::string rawlog_ = folder_ / "in.rawlog";
  std::string replay_ = folder_ / "replay";
};

TEST_F(ReplayExportTest, EachCommandHasHelpAndRefusesAnExistingFile) {
  for (const char* command : {"mcap", "tum", "kitti", "ply", "rosmap", "geojson"}) {
    const auto help = test::runProcess(test::program("headway-export") + " " + command + " --help");
    EXPECT_EQ(0, help.status) << command;
    EXPECT_THAT(help.output, HasSubstr("OUTDIR")) << command;
  }
  ASSERT_EQ(0, exported("tum", "x.tum").status);
  EXPECT_THAT(exported("tum", "x.tum").output, HasSubstr("x.tum"));
  EXPECT_EQ(1, exported("tum", "x.tum").status);
  EXPECT_EQ(0, exported("tum", "x.tum", "-w").status);
}

TEST_F(ReplayExportTest, PathsAreThoseOfTheReplay) {
  ASSERT_EQ(0, exported("tum", "x.tum", "-q").status);
  EXPECT_EQ(contentsOf(replay_ + "/trajectory.tum"), contentsOf(at("x.tum")));
  const auto missing = exported("kitti", "x.txt");
  EXPECT_EQ(1, missing.status);
  EXPECT_THAT(missing.output, HasSubstr("trajectory_kitti.txt: no such file"));
  std::ofstream(replay_ + "/trajectory_kitti.txt") << "1 0 0 0 0 1 0 0 0 0 1 0\n";
  ASSERT_EQ(0, exported("kitti", "x.txt", "-q").status);
  EXPECT_EQ("1 0 0 0 0 1 0 0 0 0 1 0\n", contentsOf(at("x.txt")));
}

TEST_F(ReplayExportTest, PlyPrefersTheDenseMap) {
  ASSERT_EQ(0, exported("ply", "points.ply", "-q").status);
  EXPECT_EQ(contentsOf(replay_ + "/map_points.ply"), contentsOf(at("points.ply")));
  EXPECT_THAT(exported("ply", "none.ply", "--layer dense").output, HasSubstr("no dense map"));
  EXPECT_EQ(2, exported("ply", "none.ply", "--layer sky").status);
  std::filesystem::copy(replay_ + "/map_points.ply", replay_ + "/map_dense.ply");
  EXPECT_THAT(exported("ply", "dense.ply").output, HasSubstr("2 points"));
}

TEST_F(ReplayExportTest, RosmapHasThePictureThatItNames) {
  ASSERT_EQ(0, exported("rosmap", "map.yaml", "-q").status);
  const std::string yaml = contentsOf(at("map.yaml"));
  EXPECT_THAT(yaml, HasSubstr("image: map.pgm\n"));
  EXPECT_THAT(yaml, HasSubstr("resolution: 0.5\norigin: [-1.5, -2, 0.0]\n"));
  const cv::Mat cells = cv::imread(at("map.pgm"), cv::IMREAD_GRAYSCALE);
  ASSERT_EQ(cv::Size(3, 2), cells.size());
  EXPECT_EQ(0, cells.at<unsigned char>(0, 2));
  EXPECT_EQ(2, exported("rosmap", "map.png").status);
}

TEST_F(ReplayExportTest, GeojsonJoinsPathAndTracks) {
  EXPECT_THAT(exported("geojson", "x.geojson").output, HasSubstr("too few satellite fixes"));
  for (const char* name : {"trajectory", "tracks"}) {
    std::ofstream(replay_ + "/" + name + ".geojson")
        << R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":")"
        << name << R"("},"geometry":null}]})";
  }
  ASSERT_EQ(0, exported("geojson", "x.geojson", "-q").status);
  const auto json = nlohmann::json::parse(contentsOf(at("x.geojson")));
  ASSERT_EQ(2u, json["features"].size());
  EXPECT_EQ("tracks", json["features"][1]["properties"]["name"]);
}

TEST_F(ReplayExportTest, McapHasTheSameBytesTwiceAndRefusesAnotherFolder) {
  ASSERT_EQ(0, exported("mcap", "a.mcap", "-q").status);
  ASSERT_EQ(0, exported("mcap", "b.mcap", "-q").status);
  const std::string bytes = contentsOf(at("a.mcap"));
  EXPECT_EQ(bytes, contentsOf(at("b.mcap")));
  EXPECT_EQ("\x89MCAP0\r\n", bytes.substr(0, 8));
  EXPECT_EQ("\x89MCAP0\r\n", bytes.substr(bytes.size() - 8));
  std::filesystem::remove(replay_ + "/trajectory.tum");
  EXPECT_EQ(1, exported("mcap", "c.mcap").status);
  EXPECT_FALSE(std::filesystem::exists(at("c.mcap")));
}

/// Why npm's readers are not there; empty if they are.
std::string missingReaders() {
  return test::missingNpmPackages("tests/export", HEADWAY_NODE_DIR, "read MCAP files");
}

/// The file as npm's readers understand it.
class McapExportTest : public ReplayExportTest {
 protected:
  nlohmann::json read(const std::string& name) const {
    const auto run = test::runProcess("cd " HEADWAY_NODE_DIR " && cp " HEADWAY_SOURCE_DIR
                                      "/tests/export/read_mcap.mjs . && node read_mcap.mjs " +
                                      at(name));
    EXPECT_EQ(0, run.status) << run.output;
    return nlohmann::json::parse(run.output, nullptr, false);
  }
};

TEST_F(McapExportTest, OtherReadersFindTheReplayInFoxglovesSchemas) {
  const std::string missing = missingReaders();
  if (!missing.empty()) GTEST_SKIP() << missing;
  ASSERT_EQ(0, exported("mcap", "x.mcap", "-q").status);
  const auto mcap = read("x.mcap");
  EXPECT_THAT(mcap["differences"], IsEmpty()) << mcap["differences"];
  EXPECT_EQ(true, mcap["inOrder"]);
  EXPECT_EQ(1000.0, mcap["start"]);
  EXPECT_NEAR(1000.7, mcap["end"].get<double>(), 1e-6);
  const auto& topics = mcap["topics"];
  const std::size_t frames = test::kReplayFrames - 1;  // one is lost
  for (const char* topic :
       {"/tf", "/pose", "/tracks", "/predictions", "/camera/image", "/camera/calibration"}) {
    EXPECT_EQ(frames, topics[topic]["messages"]) << topic;
  }
  EXPECT_EQ("foxglove.PoseInFrame", topics["/pose"]["schema"]);
  EXPECT_NEAR(5.6, topics["/pose"]["last"]["pose"]["position"]["x"].get<double>(), 1e-9);
  const auto& transforms = topics["/tf"]["last"]["transforms"];
  EXPECT_EQ("map", transforms[0]["parent_frame_id"]);
  EXPECT_EQ("odom", transforms[0]["child_frame_id"]);
  EXPECT_EQ("odom", transforms[1]["parent_frame_id"]);
  EXPECT_EQ("base_link", transforms[1]["child_frame_id"]);
  EXPECT_EQ("camera", transforms[2]["child_frame_id"]);
  EXPECT_EQ(180.0, topics["/camera/calibration"]["first"]["K"][0]);
  EXPECT_EQ("jpeg", topics["/camera/image"]["first"]["format"]);
  EXPECT_GT(topics["/camera/image"]["first"]["data"], 500) << "bytes";
  const auto& box = topics["/tracks"]["last"]["entities"][0];
  EXPECT_EQ("track 4", box["id"]);
  EXPECT_NEAR(14.6, box["cubes"][0]["pose"]["position"]["x"].get<double>(), 1e-6);
  EXPECT_EQ(1.8, box["cubes"][0]["size"]["x"]);
  EXPECT_EQ("Cyclist 4", box["texts"][0]["text"]);
  EXPECT_EQ("ALL", topics["/tracks"]["last"]["deletions"][0]["type"]);
  const auto& prediction = topics["/predictions"]["last"]["entities"][0]["lines"];
  EXPECT_EQ(31u, prediction[0]["points"].size()) << "now and 30 horizons";
  EXPECT_NEAR(14.6 + 24.0, prediction[0]["points"][30]["x"].get<double>(), 1e-6);
  EXPECT_EQ("LINE_LOOP", prediction[1]["type"]) << "the ellipse at its end";
  EXPECT_EQ(2 * 16, topics["/map/points"]["first"]["data"]) << "bytes of two points";
  EXPECT_EQ(3, topics["/map/grid"]["first"]["column_count"]);
  EXPECT_EQ(4 * 6, topics["/map/grid"]["first"]["data"]);
}

}  // namespace
}  // namespace headway
