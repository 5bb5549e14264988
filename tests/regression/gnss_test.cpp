// SPDX-License-Identifier: BSD-3-Clause
// Satellite fixes, from the recording to the map on the earth.
#include <gmock/gmock.h>
#include <headway/geo/geodetic_frame.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/trajectory_file.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <sstream>

#include "replay_run.h"

namespace headway {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

constexpr double kDegree = M_PI / 180.0;

Json readJson(const std::string& path) { return Json::parse(test::contentsOf(path)); }

struct MapPlace {
  explicit MapPlace(const Json& json)
      : frame({json.at("map_origin").at("latitude_deg"), json.at("map_origin").at("longitude_deg"),
               json.at("map_origin").at("altitude_m")}) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        turn(row, column) = json.at("enu_from_map_rotation").at(row).at(column);
      }
    }
  }
  geo::GeodeticFrame frame;
  Eigen::Matrix3d turn;
};

/// Positions and times of all lines of a GeoJSON file.
std::vector<geo::GeodeticPosition> positionsIn(const std::string& path, std::vector<Time>& times) {
  std::vector<geo::GeodeticPosition> positions;
  const Json collection = readJson(path);
  for (const auto& feature : collection.at("features")) {
    for (const Json& point : feature.at("geometry").at("coordinates")) {
      positions.push_back({point.at(1), point.at(0), point.at(2)});
    }
    for (const Json& time : feature.at("properties").at("times")) times.push_back(time);
  }
  return positions;
}

struct PlaceError {
  double heading_deg = 0.0;  ///< mean over the way
  double offset_m = 0.0;     ///< of the mean position
  std::size_t places = 0;
};

PlaceError errorOf(const test::ReplayRun& run, const std::string& truth) {
  std::vector<Time> times;
  const auto estimated = positionsIn(run.file("trajectory.geojson"), times);
  const auto poses = io::readTum(run.file("trajectory.tum"));
  const MapPlace place(readJson(run.file("map_geo.json")));
  std::ifstream rows(truth);
  std::string row;
  std::getline(rows, row);
  PlaceError error;
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();
  while (std::getline(rows, row)) {
    for (char& c : row) c = c == ',' ? ' ' : c;
    std::istringstream fields(row);
    double time = 0.0, heading = 0.0;
    geo::GeodeticPosition position;
    fields >> time >> position.latitude_deg >> position.longitude_deg >> position.altitude_m >>
        heading;
    for (std::size_t i = 0; i < times.size() && i < poses.size(); ++i) {
      if (std::abs(times[i] - time) > 1e-3) continue;
      offset += geo::GeodeticFrame(position).enuOf(estimated[i]).head<2>();
      Pose T_enu_robot = poses[i].value;
      T_enu_robot.linear() = place.turn * T_enu_robot.linear();
      error.heading_deg += std::remainder(90.0 - yawOf(T_enu_robot) / kDegree - heading, 360.0);
      ++error.places;
    }
  }
  const auto count = static_cast<double>(error.places);
  error.heading_deg = std::abs(error.heading_deg) / count;
  error.offset_m = offset.norm() / count;
  return error;
}

std::string worldFile() {
  return std::string(HEADWAY_SOURCE_DIR) + "/config/worlds/street-gnss.ini";
}

TEST(GnssTest, AStreetOf300MetresIsPlacedOnTheEarth) {
  const test::TemporaryFolder folder;
  const auto rawlog = folder / "street.rawlog";
  const auto simulated = test::runProcess(test::program("headway-sim") + " -q -c " + worldFile() +
                                          " -o " + rawlog.string());
  ASSERT_EQ(0, simulated.status) << simulated.output;
  const auto run = test::replay(rawlog, folder / "out");
  ASSERT_EQ(0, run.process.status) << run.process.output;
  EXPECT_THAT(run.process.output, HasSubstr("\ngeoreferenced: map origin "));
  const auto error = errorOf(run, folder / "street.truth/trajectory_geo.csv");
  EXPECT_GE(error.places, 350u);
  EXPECT_LT(error.heading_deg, 0.5);
  EXPECT_LT(error.offset_m, 0.5);
  EXPECT_GE(run.summary.at("georeference").at("rejected"), 2);
  EXPECT_THAT(test::contentsOf(run.file("report.html")), HasSubstr("georeferenced: map origin"));
  const Json tracks = readJson(run.file("tracks.geojson"));
  ASSERT_FALSE(tracks.at("features").empty());
  const Json& properties = tracks.at("features").at(0).at("properties");
  EXPECT_TRUE(properties.contains("track_id") && properties.contains("class"));

  // Too short a way is said, and leaves no files.
  const auto part = test::replay(rawlog, folder / "part", "--snapshots 0 --to-index 8");
  EXPECT_EQ(0, part.process.status);
  EXPECT_THAT(part.process.output, HasSubstr("not georeferenced"));
  EXPECT_TRUE(part.summary.at("georeference").contains("text"));
  for (const char* name : {"map_geo.json", "trajectory.geojson", "tracks.geojson"}) {
    EXPECT_FALSE(std::filesystem::exists(part.file(name))) << name;
  }
  // With -w, those of an earlier run do not stay.
  const auto again = test::replay(rawlog, folder / "out", "-w --snapshots 0 --to-index 8");
  EXPECT_EQ(0, again.process.status);
  EXPECT_FALSE(std::filesystem::exists(again.file("map_geo.json")));
}

TEST(GnssTest, ARunInTheMapOfAKilledOneKeepsItsFixes) {
  const test::TemporaryFolder folder;
  const std::string rawlog = folder / "street.rawlog", before = folder / "before";
  const auto simulated = test::runProcess(test::program("headway-sim") + " -q -c " + worldFile() +
                                          " --frames 60 -o " + rawlog);
  ASSERT_EQ(0, simulated.status) << simulated.output;
  const std::string options = "-q --snapshots 0 --detector none ";
  // Killed after a checkpoint with at least 32 frames, on a way of 25 m.
  const std::string checkpoint =
      "grep -o \"at frame [0-9]*\" " + before + "/summary.json 2>/dev/null | tr -dc 0-9";
  (void)test::runProcess("bash -c '" + test::program("headway-replay") + " " + options + "-i " +
                         rawlog + " -o " + before +
                         " --to-index 48 --realtime 0.5 --set output.checkpoint_s=0.3 & run=$!; "
                         "for i in $(seq 1200); do frame=$(" +
                         checkpoint +
                         "); [ 0$frame -ge 32 ] && break; sleep 0.05; done; "
                         "kill -9 $run; wait $run'");
  const Json killed = readJson(before + "/summary.json");
  ASSERT_THAT(killed.at("ended_early").get<std::string>(), HasSubstr("killed"));
  const std::string part = options + "--from-index 28 --to-index 36";  // too short by itself
  const auto alone = test::replay(rawlog, folder / "alone", part);
  ASSERT_EQ(0, alone.process.status) << alone.process.output;
  EXPECT_FALSE(std::filesystem::exists(alone.file("map_geo.json")));
  const auto after =
      test::replay(rawlog, folder / "after", part + " --load-map " + before + "/map.headway");
  ASSERT_EQ(0, after.process.status) << after.process.output;
  EXPECT_GE(after.summary.at("georeference").at("fixes"),
            alone.summary.at("georeference").at("fixes").get<int>() + 12);
  const auto error = errorOf(after, folder / "street.truth/trajectory_geo.csv");
  EXPECT_GE(error.places, 8u);
  EXPECT_LT(error.heading_deg, 5.0) << "three standard deviations of 16 fixes of 1 m over 25 m";
  EXPECT_LT(error.offset_m, 1.5);
}

/// RMSE of antenna positions on the map after the best rigid motion.
double rigidRmse(const Eigen::Matrix3Xd& map, const Eigen::Matrix3Xd& enu) {
  const Eigen::Matrix4d T = Eigen::umeyama(map, enu, false);
  const Eigen::Matrix3Xd moved =
      (T.topLeftCorner<3, 3>() * map).colwise() + T.topRightCorner<3, 1>();
  return std::sqrt((moved - enu).colwise().squaredNorm().mean());
}

TEST(GnssTest, KittiRawIsPlacedAsByTheBestRigidMotion) {
  HEADWAY_REQUIRE_DATA(data);
  const test::TemporaryFolder folder;
  const auto rawlog = folder / "drive.rawlog";
  const auto imported = test::runProcess(
      test::program("headway-import") + " kitti-raw " + (data / "kitti_raw").string() +
      " --drive 2011_09_26_drive_0005_sync -q -o " + rawlog.string());
  ASSERT_EQ(0, imported.status) << imported.output;
  const auto run = test::replay(rawlog, folder / "out", "-q --snapshots 0 --detector none");
  ASSERT_EQ(0, run.process.status) << run.process.output;
  const MapPlace place(readJson(run.file("map_geo.json")));
  const auto poses = io::readTum(run.file("trajectory.tum"));

  std::vector<Eigen::Vector3d> map, enu;
  io::RawlogSource source(rawlog, {});
  while (const auto frame = source.next()) {
    for (const auto& fix : frame->gnss) {
      for (const auto& pose : poses) {
        if (std::abs(pose.time - fix.time) > 0.02) continue;
        map.push_back(pose.value * fix.antenna);
        enu.push_back(place.frame.enuOf({fix.latitude_deg, fix.longitude_deg, fix.altitude_m}));
      }
    }
  }
  ASSERT_GE(map.size(), 100u);
  Eigen::Matrix3Xd on_map(3, map.size()), on_earth(3, map.size());
  for (std::size_t i = 0; i < map.size(); ++i) {
    on_map.col(static_cast<Eigen::Index>(i)) = map[i];
    on_earth.col(static_cast<Eigen::Index>(i)) = enu[i];
  }
  const double placed = std::sqrt((place.turn * on_map - on_earth).colwise().squaredNorm().mean());
  RecordProperty("placed_rmse_m", std::to_string(placed));
  RecordProperty("rigid_rmse_m", std::to_string(rigidRmse(on_map, on_earth)));
  EXPECT_LE(placed, 1.1 * rigidRmse(on_map, on_earth));
}

}  // namespace
}  // namespace headway
