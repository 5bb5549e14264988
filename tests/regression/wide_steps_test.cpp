// SPDX-License-Identifier: BSD-3-Clause
// A recording with wide steps of the camera from frame to frame.
#include <gtest/gtest.h>
#include <headway/io/trajectory_file.h>

#include <algorithm>
#include <cmath>

#include "replay_run.h"

namespace headway {
namespace {

class WideStepsTest : public ::testing::TestWithParam<int> {};

/// Angle between the headings that estimate and truth have taken since their first poses [rad].
double headingError(const std::vector<Stamped<Pose>>& truth, const Stamped<Pose>& first,
                    const Stamped<Pose>& now) {
  const auto trueAt = [&](Time time) {
    return std::min_element(truth.begin(), truth.end(),
                            [&](const auto& a, const auto& b) {
                              return std::abs(a.time - time) < std::abs(b.time - time);
                            })
        ->value;
  };
  const Pose turned = trueAt(first.time).inverse(Eigen::Isometry) * trueAt(now.time);
  const Pose estimated = first.value.inverse(Eigen::Isometry) * now.value;
  return logSo3(turned.linear().transpose() * estimated.linear()).norm();
}

TEST_P(WideStepsTest, KeepTheHeadingOfEachFrameThatIsCalledTracked) {
  const test::TemporaryFolder folder;
  const std::string hall = std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/hall";
  const auto thinned =
      test::runProcess(test::program("headway-import") + " rawlog -q " + hall + ".rawlog --every " +
                       std::to_string(GetParam()) + " -o " + (folder / "in.rawlog").string());
  ASSERT_EQ(0, thinned.status) << thinned.output;
  const auto run =
      test::replay(folder / "in.rawlog", folder / "out", "--snapshots 0 --detector none");
  ASSERT_EQ(0, run.process.status) << run.process.output;
  EXPECT_LE(run.summary.at("frames_lost"), GetParam() < 5 ? 0 : 3);
  if (run.summary.at("frames_tracked_in_new_submap") > 0) {
    // It was turned past all that it had seen before it had moved.
    EXPECT_EQ(5, GetParam());
    return;
  }
  const auto truth = io::readTum(hall + ".truth/trajectory.tum");
  const auto path = io::readTum(run.file("trajectory_online.tum"));
  ASSERT_GT(path.size(), 20U);
  for (const auto& at : path) EXPECT_LT(headingError(truth, path.front(), at), 0.0175) << at.time;
}

INSTANTIATE_TEST_SUITE_P(Bundled, WideStepsTest, ::testing::Values(3, 4, 5, 6));

}  // namespace
}  // namespace headway
