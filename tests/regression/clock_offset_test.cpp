// SPDX-License-Identifier: BSD-3-Clause
// The check of a recording with an inertial sensor on the camera's clock.
#include <gmock/gmock.h>
#include <headway_test/folders.h>

#include "replay_run.h"

namespace headway {
namespace {

using ::testing::HasSubstr;

TEST(ClockOffsetTest, SensorsOnOneClockAreOk) {
  const test::TemporaryFolder folder;
  const auto rawlog = folder / "hall.rawlog";
  const auto simulated = test::runProcess(
      test::program("headway-sim") + " -q -c " + HEADWAY_SOURCE_DIR +
      "/config/worlds/hall.ini --rig small --seed 3 --frames 100 --set camera.imu=true -o " +
      rawlog.string());
  ASSERT_EQ(0, simulated.status) << simulated.output;
  const auto check =
      test::runProcess(test::program("headway-import") + " rawlog " + rawlog.string() + " --check");
  EXPECT_EQ(0, check.status);
  EXPECT_THAT(check.output, HasSubstr("ok       camera against inertial sensor: inertial times"));
}

}  // namespace
}  // namespace headway
