// SPDX-License-Identifier: BSD-3-Clause
// Mistakes of mounting and calibration, made in good recordings: each must be named.
#include <gmock/gmock.h>
#include <headway/eval/trajectory_error.h>
#include <headway/io/trajectory_file.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "edited_rawlog.h"
#include "replay_run.h"

namespace headway {
namespace {

using mrpt::obs::CObservationIMU;
using mrpt::obs::CObservationStereoImages;
using mrpt::poses::CPose3D;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// The bundled recordings: a street seen from a car, a hall seen from a small robot.
class MountingTest : public ::testing::TestWithParam<std::string> {
 protected:
  test::ReplayRun replayWith(const test::RawlogEdit& edit) {
    test::editRawlog(std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/" + GetParam() + ".rawlog",
                     rawlog(), edit);
    return test::replay(rawlog(), folder_ / "out", "-q --snapshots 0");
  }
  test::ReplayRun replayWith(const std::function<void(CObservationStereoImages&)>& edit) {
    test::RawlogEdit all;
    all.stereo = edit;
    return replayWith(all);
  }
  void expectOneLine(const test::ReplayRun& run, const ::testing::Matcher<std::string>& line) {
    EXPECT_EQ(1, run.process.status) << run.process.output;
    EXPECT_EQ(1, std::count(run.process.output.begin(), run.process.output.end(), '\n'))
        << run.process.output;
    EXPECT_THAT(run.process.output, AllOf(HasSubstr("in.rawlog"), line));
  }
  [[nodiscard]] std::string rawlog() const { return (folder_ / "in.rawlog").string(); }

  test::TemporaryFolder folder_;
};

void turnCamera(CObservationStereoImages& stereo, const CPose3D& turn) {
  stereo.cameraPose = mrpt::poses::CPose3DQuat(CPose3D(stereo.cameraPose) + turn);
}

TEST_P(MountingTest, GoodRecordingsHaveNoWarning) {
  const auto run = replayWith(test::RawlogEdit{});
  EXPECT_EQ(0, run.process.status) << run.process.output;
  EXPECT_EQ("", run.process.output);
  EXPECT_TRUE(run.summary["warnings"].empty()) << run.summary["warnings"];
}

TEST_P(MountingTest, AxesWithoutTheOpticalTurn) {
  const CPose3D optical(0, 0, 0, -M_PI / 2, 0, -M_PI / 2);
  const auto run = replayWith(
      [&](CObservationStereoImages& stereo) { turnCamera(stereo, CPose3D() - optical); });
  expectOneLine(run, AllOf(HasSubstr("optical axes"), HasSubstr("write cameraPose = ["),
                           HasSubstr("-90.0 ")));
}

TEST_P(MountingTest, UpsideDown) {
  const auto run = replayWith(
      [&](CObservationStereoImages& stereo) { turnCamera(stereo, CPose3D(0, 0, 0, M_PI, 0, 0)); });
  expectOneLine(run, AllOf(HasSubstr("upside-down"), HasSubstr("write cameraPose = [")));
}

TEST_P(MountingTest, ImagesUpsideDown) {
  const auto run = replayWith([&](CObservationStereoImages& stereo) {
    for (auto* image : {&stereo.imageLeft, &stereo.imageRight}) {
      image->flipVertical();
      image->flipHorizontal();
    }
    std::swap(stereo.imageLeft, stereo.imageRight);  // as a rig turned about its viewing direction
    for (auto* camera : {&stereo.leftCamera, &stereo.rightCamera}) {
      camera->cx(camera->ncols - 1 - camera->cx());
      camera->cy(camera->nrows - 1 - camera->cy());
    }
  });
  expectOneLine(run, AllOf(HasSubstr("ground above"), HasSubstr("write cameraPose = [")));
}

TEST_P(MountingTest, LeftAndRightSwapped) {
  const auto run = replayWith(
      [](CObservationStereoImages& stereo) { std::swap(stereo.imageLeft, stereo.imageRight); });
  expectOneLine(run, HasSubstr("left and right images are swapped; exchange them"));
}

TEST_P(MountingTest, BaselineInMillimetres) {
  const auto run = replayWith([](CObservationStereoImages& stereo) {
    stereo.rightCameraPose.x(1000.0 * stereo.rightCameraPose.x());
  });
  expectOneLine(run, AllOf(HasSubstr("millimetres"), HasSubstr("write 0.")));
}

TEST_P(MountingTest, TheLeftImageTwice) {
  const auto run =
      replayWith([](CObservationStereoImages& stereo) { stereo.imageRight = stereo.imageLeft; });
  expectOneLine(run, HasSubstr("identical"));
}

TEST_P(MountingTest, RecordingsOfNothing) {
  const auto run = replayWith([](CObservationStereoImages& stereo) {
    for (auto* image : {&stereo.imageLeft, &stereo.imageRight}) {
      image->asCvMat<cv::Mat>(mrpt::img::SHALLOW_COPY).setTo(cv::Scalar::all(40));
    }
  });
  expectOneLine(run, AllOf(HasSubstr("frames was tracked"), HasSubstr("lens covers")));
}

INSTANTIATE_TEST_SUITE_P(Bundled, MountingTest, ::testing::Values("street", "hall"),
                         [](const auto& parameter) { return parameter.param; });

using InertialMistakes = MountingTest;

class WrongInertialAxes : public ::testing::Test {
 protected:
  [[nodiscard]] std::string recorded() const { return (folder_ / "recorded.rawlog").string(); }
  [[nodiscard]] std::string rawlog() const { return (folder_ / "in.rawlog").string(); }
  /// Between the positions of both paths, without alignment [m].
  static double largestDistance(const test::ReplayRun& a, const test::ReplayRun& b) {
    const auto pairs = eval::pairByTime(io::readTum(a.file("trajectory.tum")),
                                        io::readTum(b.file("trajectory.tum")), 0.001);
    EXPECT_EQ(60u, pairs.pairs.size());
    double largest = 0.0;
    for (const auto& pair : pairs.pairs) {
      largest = std::max(largest, (pair.truth.translation() - pair.estimate.translation()).norm());
    }
    return largest;
  }

  test::TemporaryFolder folder_;
};

TEST_P(InertialMistakes, AreSaidAndLeftOut) {
  test::RawlogEdit edit;
  edit.max_pairs = 120;
  edit.imu = [](CObservationIMU& imu) {
    imu.set(mrpt::obs::IMU_X_ACC, 0.0);
    imu.set(mrpt::obs::IMU_Y_ACC, 0.0);
    imu.set(mrpt::obs::IMU_Z_ACC, 0.0);
  };
  const auto constant = replayWith(edit);
  EXPECT_EQ(0, constant.process.status);
  EXPECT_THAT(constant.process.output, HasSubstr("the inertial sensor is left out"));
  EXPECT_GT(constant.summary.at("warnings").at("imu_accelerometer").at("count"), 0);
  EXPECT_THAT(test::contentsOf(constant.file("report.html")),
              HasSubstr("the inertial sensor is left out"));
}

TEST_P(InertialMistakes, SamplesWithoutValuesAreSaid) {
  test::RawlogEdit edit;
  edit.imu = [](CObservationIMU& imu) {
    for (auto& value : imu.rawMeasurements) value = std::numeric_limits<double>::quiet_NaN();
  };
  const auto run = replayWith(edit);
  EXPECT_EQ(0, run.process.status);
  EXPECT_THAT(run.process.output, HasSubstr("inertial samples without finite values"));
  EXPECT_GT(run.summary.at("warnings").at("imu_samples").at("count"), 0);
}

/// Axes of many depth cameras' inertial sensors (x right, y down, z forward), written as the
/// robot's.
void swapAxes(CObservationIMU& imu) {
  for (const auto& [x, y, z] :
       {std::array{mrpt::obs::IMU_WX, mrpt::obs::IMU_WY, mrpt::obs::IMU_WZ},
        std::array{mrpt::obs::IMU_X_ACC, mrpt::obs::IMU_Y_ACC, mrpt::obs::IMU_Z_ACC}}) {
    const std::array<double, 3> value{imu.get(x), imu.get(y), imu.get(z)};
    imu.set(x, -value[1]);
    imu.set(y, -value[2]);
    imu.set(z, value[0]);
  }
}

TEST_F(WrongInertialAxes, AreSaidAndLeftOut) {
  ASSERT_EQ(0, test::runProcess(test::program("headway-sim") + " -q -c " + HEADWAY_SOURCE_DIR +
                                "/config/worlds/hall.ini --rig small --seed 5 --frames 60 "
                                "--set camera.imu=true --set recording.storage=embedded -o " +
                                recorded())
                   .status);
  const auto good = test::replay(recorded(), folder_ / "good", "-q --snapshots 0");
  EXPECT_TRUE(good.summary["warnings"].empty()) << good.summary["warnings"];
  test::RawlogEdit edit;
  edit.recorded_imu = swapAxes;
  test::editRawlog(recorded(), rawlog(), edit);
  const auto wrong = test::replay(rawlog(), folder_ / "wrong", "-q --snapshots 0");
  EXPECT_EQ(0, wrong.process.status) << wrong.process.output;
  EXPECT_THAT(wrong.process.output, AllOf(HasSubstr("the inertial sensor is left out"),
                                          HasSubstr("check its axes (sensorPose)")));
  const auto without =
      test::replay(rawlog(), folder_ / "without", "-q --snapshots 0 --set slam.use_imu=false");
  EXPECT_LT(largestDistance(wrong, without), 0.02);
}

INSTANTIATE_TEST_SUITE_P(Bundled, InertialMistakes, ::testing::Values("hall"),
                         [](const auto& parameter) { return parameter.param; });

}  // namespace
}  // namespace headway
