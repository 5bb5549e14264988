// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/program/files.h>
#include <headway_test/folders.h>

#include <cmath>
#include <fstream>

#include "result_files.h"

namespace headway::replay {
namespace {

/// One row of each file that is moved.
class MovedResultsTest : public testing::Test {
 protected:
  MovedResultsTest() {
    io::writeTum(folder_ / "trajectory_online.tum", {{1.0, poseAt(2.0, 0.0)}});
    std::ofstream map_odom(folder_ / "map_odom.csv");
    map_odom << io::mapOdomCsvHeader() << '\n';
    io::writeMapOdomCsv(map_odom, {4, 1.0, poseAt(0.5, 0.0), 12, "loop"});
    for (const char* name : {"tracks.csv", "tracks_smoothed.csv"}) {
      std::ofstream out(folder_ / name);
      TrackSample row;
      row.track.id = TrackId{7};
      row.track.status = TrackStatus::kConfirmed;
      row.track.position = {3.0, 1.0, 0.5};
      row.track.velocity = {2.0, 0.0, 0.0};
      row.track.yaw = 0.1;
      row.track.position_covariance = Eigen::Vector3d(0.4, 0.1, 0.0).asDiagonal();
      row.track.velocity_covariance = Eigen::Vector2d(0.9, 0.2).asDiagonal();
      out << io::trackCsvHeader() << '\n';
      io::writeTrackCsv(out, row);
    }
    std::ofstream out(folder_ / "predictions.csv");
    io::PredictionRow row;
    row.point.position = {5.0, 1.0, 0.5};
    row.point.covariance = Eigen::Vector2d(1.0, 3.0).asDiagonal();
    out << io::predictionCsvHeader() << '\n';
    io::writePredictionCsv(out, row);
  }

  static Pose poseAt(double x, double y) {
    Pose pose = Pose::Identity();
    pose.translation() << x, y, 0.0;
    return pose;
  }

  test::TemporaryFolder folder_;
};

TEST_F(MovedResultsTest, TurnWithTheMap) {
  Pose T_map_run = poseAt(10.0, 20.0);
  T_map_run.linear() = expSo3({0.0, 0.0, M_PI / 2.0});
  moveOnlineResults(folder_.path(), T_map_run);

  const auto path = io::readTum(folder_ / "trajectory_online.tum");
  ASSERT_EQ(path.size(), 1U);
  EXPECT_TRUE(path[0].value.isApprox(T_map_run * poseAt(2.0, 0.0), 1e-6));
  std::vector<io::MapOdomRow> odometry;
  io::visitMapOdomCsv(folder_ / "map_odom.csv",
                      [&](const io::MapOdomRow& row) { odometry.push_back(row); });
  ASSERT_EQ(odometry.size(), 1U);
  EXPECT_TRUE(odometry[0].T_map_odom.isApprox(T_map_run * poseAt(0.5, 0.0), 1e-6));
  EXPECT_EQ(odometry[0].frame, 4U);
  EXPECT_EQ(odometry[0].revision, 12U);
  EXPECT_EQ(odometry[0].cause, "loop");
  for (const char* name : {"tracks.csv", "tracks_smoothed.csv"}) {
    const auto rows = io::readTrackCsv(folder_ / name);
    ASSERT_EQ(rows.size(), 1U);
    const Track& track = rows[0].track;
    EXPECT_EQ(track.id.value, 7);
    EXPECT_TRUE(track.position.isApprox(Eigen::Vector3d(9.0, 23.0, 0.5), 1e-6));
    EXPECT_TRUE(track.velocity.isApprox(Eigen::Vector3d(0.0, 2.0, 0.0), 1e-6));
    EXPECT_NEAR(track.yaw, 0.1 + M_PI / 2.0, 1e-6);
    EXPECT_NEAR(track.position_covariance(1, 1), 0.4, 1e-6);
    EXPECT_NEAR(track.velocity_covariance(0, 0), 0.2, 1e-6);
  }
  const auto predictions = io::readPredictionCsv(folder_ / "predictions.csv");
  ASSERT_EQ(predictions.size(), 1U);
  EXPECT_TRUE(predictions[0].point.position.isApprox(Eigen::Vector3d(9.0, 25.0, 0.5), 1e-6));
  EXPECT_NEAR(predictions[0].point.covariance(0, 0), 3.0, 1e-6);
}

TEST_F(MovedResultsTest, ATiltedMapBringsNoUncertaintyOfHeightIntoThePlane) {
  Pose T_map_run = Pose::Identity();
  T_map_run.linear() = expSo3({0.0, 0.1, 0.0});
  moveOnlineResults(folder_.path(), T_map_run);
  const double expected = 0.4 * std::pow(std::cos(0.1), 2);
  EXPECT_NEAR(io::readTrackCsv(folder_ / "tracks.csv")[0].track.position_covariance(0, 0), expected,
              1e-6);
}

TEST(IsResultTest, FilesOfARunAndOfItsSubmapsAndNoOthers) {
  for (const char* name :
       {"tracks.csv", "tracks_odom.csv", "trajectory_odom.tum", "map_odom.csv",
        "map_points_submap_2.ply", "map_grid_submap_12.gridmap.gz", "snapshots/000010.png"}) {
    EXPECT_TRUE(program::isResult(name)) << name;
  }
  for (const char* name : {"notes.txt", "map_points_submap_.ply", "map_notes_submap_2.txt",
                           "snapshots/10.png", "other/tracks.csv"}) {
    EXPECT_FALSE(program::isResult(name)) << name;
  }
}

}  // namespace
}  // namespace headway::replay
