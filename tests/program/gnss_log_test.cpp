// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway_test/input_error.h>

#include "geo_files.h"

namespace headway::replay {
namespace {

using testing::HasSubstr;

GnssFix fixAt(Time time) {
  GnssFix fix;
  fix.time = time;
  fix.antenna << 0.5, 0.0, 1.5;
  fix.latitude_deg = 49.0 + 1e-5 * time;
  fix.longitude_deg = 8.4;
  fix.altitude_m = 110.0;
  fix.sigma_m = 1.25;
  return fix;
}

/// Along x at 1 m/s, a frame a second.
slam::TrajectoryVisit drive(int frames) {
  return [frames](const slam::FrameVisitor& visit) {
    for (int i = 0; i < frames; ++i) {
      visit({static_cast<std::size_t>(i), 1.0 * i, true, Pose(Eigen::Translation3d(i, 0.0, 0.0))});
    }
  };
}

slam::MapView mapWithKeyframes(const std::map<int, Pose>& poses) {
  std::vector<slam::KeyframeView> keyframes;
  for (const auto& [id, pose] : poses) {
    slam::KeyframeView keyframe;
    keyframe.id = KeyframeId{id};
    keyframe.T_map_robot = pose;
    keyframes.push_back(keyframe);
  }
  slam::MapView map;
  map.keyframes = SharedChunks<slam::KeyframeView>(std::move(keyframes));
  return map;
}

/// The fixes of a drive of ten frames, at half seconds, as bytes of its map.
std::string bytesOfDrive() {
  GnssLog log;
  for (int i = 0; i < 9; ++i) log.add({fixAt(i + 0.5)});
  return gnssBytes(log.onMap(drive(10), {}));
}

TEST(GnssLogTest, FixesOfTheRunBeforeAreLoadedWithTheirPositions) {
  GnssLog log;
  log.load(bytesOfDrive(), {});
  log.add({fixAt(0.25)});
  EXPECT_EQ(10u, log.added());
  const auto fixes = log.onMap(drive(2), {});
  ASSERT_EQ(10u, fixes.size());
  EXPECT_EQ(0.25, fixes[0].fix.time) << "in order of time";
  for (std::size_t i = 0; i < 9; ++i) {
    const auto& [fix, in_map] = fixes[i + 1];
    const auto second = static_cast<double>(i);
    const GnssFix expected = fixAt(second + 0.5);
    EXPECT_EQ(expected.time, fix.time);
    EXPECT_EQ(expected.latitude_deg, fix.latitude_deg);
    EXPECT_EQ(expected.longitude_deg, fix.longitude_deg);
    EXPECT_EQ(expected.altitude_m, fix.altitude_m);
    EXPECT_EQ(expected.sigma_m, fix.sigma_m);
    EXPECT_EQ(expected.antenna, fix.antenna);
    EXPECT_TRUE(in_map.isApprox(Eigen::Vector3d(second + 1.0, 0.0, 1.5), 1e-9))
        << in_map.transpose();
  }
}

TEST(GnssLogTest, TheyMoveWithTheNearestKeyframeThatTheMapStillHas) {
  const Pose at_2(Eigen::Translation3d(2.0, 0.0, 0.0)), at_8(Eigen::Translation3d(8.0, 0.0, 0.0));
  const Pose moved(Eigen::Translation3d(8.0, 0.5, 0.0) *
                   Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitZ()));
  GnssLog log;
  log.load(bytesOfDrive(), mapWithKeyframes({{1, at_2}, {4, at_8}}));
  const auto fixes = log.onMap(drive(0), mapWithKeyframes({{1, at_2}, {4, moved}, {6, at_8}}));
  ASSERT_EQ(9u, fixes.size());
  EXPECT_TRUE(fixes[1].in_map.isApprox(Eigen::Vector3d(2.0, 0.0, 1.5), 1e-9));
  EXPECT_TRUE(fixes[8].in_map.isApprox(Eigen::Vector3d(8.0, 1.5, 1.5), 1e-9)) << "1 m ahead of it";
  const auto without = log.onMap(drive(0), mapWithKeyframes({{1, at_2}}));
  EXPECT_TRUE(without[8].in_map.isApprox(Eigen::Vector3d(9.0, 0.0, 1.5), 1e-9));
}

TEST(GnssLogTest, MemoryIsBoundedOverAnyNumberOfRuns) {
  std::vector<geo::FixOnMap> fixes(3 * kMaxKept);
  GnssLog log;
  log.load(gnssBytes(fixes), {});
  EXPECT_LE(log.kept(), kMaxKept);
  EXPECT_GT(log.kept(), kMaxKept / 3);
}

TEST(GnssLogTest, DamagedBytesAreErrors) {
  const std::string bytes = bytesOfDrive();
  const auto errorOf = [](const std::string& wrong) {
    return test::inputErrorOf([&] { GnssLog().load(wrong, {}); });
  };
  EXPECT_EQ("", errorOf(bytes));
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_THAT(errorOf(bytes.substr(0, length)), HasSubstr("damaged")) << length;
  }
  EXPECT_THAT(errorOf(bytes + "x"), HasSubstr("damaged"));
  std::string other = bytes;
  other[0] = 7;
  EXPECT_THAT(errorOf(other), HasSubstr("version 7"));
  geo::FixOnMap nowhere;
  nowhere.fix.latitude_deg = 1000.0;
  EXPECT_THAT(errorOf(gnssBytes({nowhere})), HasSubstr("damaged"));
  nowhere.fix.latitude_deg = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(errorOf(gnssBytes({nowhere})), HasSubstr("damaged"));
}

}  // namespace
}  // namespace headway::replay
