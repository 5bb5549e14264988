// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/trajectory_file.h>
#include <headway_test/limits.h>

#include "replay_run.h"

namespace headway {
namespace {

/// Imports a recording, replays it, and compares with the truth that came with it.
///
/// @return the summary of the replay
nlohmann::json expectTracked(const std::string& import_arguments, double ate_limit_m,
                             int lost_limit = 0) {
  const test::TemporaryFolder folder;
  const auto rawlog = folder / "in.rawlog";
  const auto imported = test::runProcess(test::program("headway-import") + " " + import_arguments +
                                         " -q -o " + rawlog.string());
  EXPECT_EQ(0, imported.status) << imported.output;
  const auto run = test::replay(rawlog, folder / "out");
  EXPECT_EQ(0, run.process.status) << run.process.output;
  if (run.process.status != 0) return {};
  EXPECT_LE(run.summary.at("frames_lost"), lost_limit) << run.summary.at("lost_frames");
  EXPECT_EQ(run.summary.at("frames"),
            run.summary.at("frames_tracked").get<int>() + run.summary.at("frames_lost").get<int>());
  EXPECT_EQ(0, run.summary.at("frames_tracked_in_new_submap"));
  const double ate =
      test::ateRmse(io::readTruth(rawlog).poses, io::readTum(run.file("trajectory.tum")));
  test::expectWithin("ate_rmse_m", ate, ate_limit_m);
  return run.summary;
}

TEST(RealDataTest, Kitti06) {
  HEADWAY_REQUIRE_DATA(data);
  expectTracked("kitti-odometry " + (data / "kitti_odometry").string() + " --sequence 06",
                test::kKitti06AteM);
}

TEST(RealDataTest, Kitti01Motorway) {
  HEADWAY_REQUIRE_DATA(data);
  expectTracked("kitti-odometry " + (data / "kitti_odometry").string() + " --sequence 01",
                test::kKitti01TurnedAteM);
}

TEST(RealDataTest, EurocMh01RectifiedOnTheWayIn) {
  HEADWAY_REQUIRE_DATA(data);
  expectTracked("euroc " + (data / "euroc" / "MH_01_easy").string(), test::kEurocMh01AteM);
}

TEST(RealDataTest, KinectTurnedFastFromTheFirstImageOn) {
  HEADWAY_REQUIRE_DATA(data);
  const auto summary = expectTracked("tum-rgbd " + (data / "rgbd" / "freiburg1_rpy").string(),
                                     test::kKinectTurnAteM, 1);
  EXPECT_EQ(0, summary.value("tracks_moving", -1)) << "nothing moves";
}

TEST(RealDataTest, KittiTrackingRunsTheObjectLayerAlone) {
  HEADWAY_REQUIRE_DATA(data);
  const test::TemporaryFolder folder;
  const auto rawlog = folder / "in.rawlog";
  const auto imported = test::runProcess(
      test::program("headway-import") + " kitti-tracking " + (data / "kitti_tracking").string() +
      " --sequence 0012 --boxes det3d_pointrcnn -q -o " + rawlog.string());
  ASSERT_EQ(0, imported.status) << imported.output;
  const auto run = test::replay(rawlog, folder / "out");
  ASSERT_EQ(0, run.process.status) << run.process.output;
  EXPECT_EQ(0, run.summary.at("frames_lost"));
  EXPECT_GT(run.summary.at("tracks_confirmed"), 0);
  EXPECT_TRUE(run.summary["calibration"].is_null());
}

}  // namespace
}  // namespace headway
