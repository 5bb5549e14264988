// SPDX-License-Identifier: BSD-3-Clause
// A simulated robot with a 2D laser scanner, from the recording to the grid.
#include <gtest/gtest.h>

#include "replay_run.h"

namespace headway {
namespace {

TEST(LaserTest, ScansOfARecordingEnterTheGrid) {
  test::TemporaryFolder folder;
  const auto rawlog = folder / "hall.rawlog";
  const auto simulated =
      test::runProcess(test::program("headway-sim") + " -q -c " + HEADWAY_SOURCE_DIR +
                       "/config/worlds/hall.ini --rig small --seed 2 --frames 8 --set "
                       "camera.rate_hz=10 --set laser.enabled=true -o " +
                       rawlog.string());
  ASSERT_EQ(0, simulated.status) << simulated.output;

  const auto with = test::replay(rawlog, folder / "with", "-q --snapshots 0");
  ASSERT_EQ(0, with.process.status) << with.process.output;
  EXPECT_EQ(3, with.summary.at("laser").at("used")) << "frames 0, 3 and 6";
  EXPECT_EQ(5, with.summary.at("laser").at("between_ground_scans"));
  EXPECT_GT(with.summary.at("laser").at("obstacles"), 300);
  EXPECT_FALSE(with.summary.at("observations_skipped").contains("CObservation2DRangeScan"));

  const auto without =
      test::replay(rawlog, folder / "without", "-q --snapshots 0 --set laser.use=false");
  ASSERT_EQ(0, without.process.status) << without.process.output;
  EXPECT_TRUE(without.summary["laser"].empty());
  EXPECT_EQ(8, without.summary.at("observations_skipped").at("CObservation2DRangeScan"));
  EXPECT_NE(test::contentsOf(with.file("map_grid.png")),
            test::contentsOf(without.file("map_grid.png")));
}

}  // namespace
}  // namespace headway
