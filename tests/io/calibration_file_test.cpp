// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/calibration_file.h>
#include <headway_test/folders.h>

#include "synthetic_recording.h"

namespace headway::io {
namespace {

using ::testing::HasSubstr;

constexpr char kFiveLines[] =
    "image_size: [752, 480]\n"
    "left: [458.654, 457.296, 367.215, 248.375, -0.28, 0.07, 0.0002, 1.8e-05]\n"
    "right: [457.587, 456.134, 379.999, 255.238, -0.28, 0.07, -0.0001, -3.6e-05, 0.01]\n"
    "T_left_right: [1,0,0,0.11, 0,1,0,0.001, 0,0,1,0]\n"
    "T_robot_cam: [0,0,1,0.5, -1,0,0,0, 0,-1,0,1.2]\n";

std::string messageFor(const std::string& text) {
  const headway::test::TemporaryFolder folder;
  const std::string path = folder / "c.yaml";
  test::writeContent(path, text);
  return test::errorOf([&] { (void)readRawCalibration(path); });
}

TEST(CalibrationFileTest, ReadsItsOutputWithoutLoss) {
  const headway::test::TemporaryFolder folder;
  StereoCamera camera = test::smallCamera();
  camera.fx = 1000.0 / 3.0;
  camera.fy = 100.0 / 7.0;
  camera.baseline_m = 0.1 + 0.2;
  camera.T_robot_cam.linear() = camera.T_robot_cam.linear() * expSo3({0.1, -0.2, 0.3});
  writeCalibration(folder / "c.yaml", camera);
  const StereoCamera read = readCalibration(folder / "c.yaml");
  EXPECT_EQ(camera.width, read.width);
  EXPECT_EQ(camera.height, read.height);
  EXPECT_EQ(camera.fx, read.fx);
  EXPECT_EQ(camera.fy, read.fy);
  EXPECT_EQ(camera.cx, read.cx);
  EXPECT_EQ(camera.cy, read.cy);
  EXPECT_EQ(camera.baseline_m, read.baseline_m);
  EXPECT_EQ(camera.T_robot_cam.matrix(), read.T_robot_cam.matrix());
  EXPECT_FALSE(read.isDepthCamera());
  camera.depth_reach_m = 7.7;
  writeCalibration(folder / "c.yaml", camera);
  EXPECT_EQ(7.7, readCalibration(folder / "c.yaml").depth_reach_m);
}

TEST(CalibrationFileTest, AFileThatIsNotWholeIsAnErrorOfOneLine) {
  const std::string good =
      "image_size: [640, 480]\nleft: [450, 450, 319.5, 239.5]\nbaseline_m: 0.05\n";
  for (const char* rest : {"T_robot_cam: [0, -1\nfoo: }{\n", "- x\nT_robot_cam: 1\n",
                           "T_robot_cam: [0, -1, 0\n", "---\nleft: 1\n"}) {
    testing::internal::CaptureStderr();
    const std::string error = messageFor(good + rest);
    EXPECT_EQ("", testing::internal::GetCapturedStderr()) << "by the parser";
    EXPECT_THAT(error, HasSubstr("c.yaml: is not a YAML file: ")) << rest;
    EXPECT_EQ(std::string::npos, error.find('\n'));
  }
}

TEST(CalibrationFileTest, ReadsUnrectifiedLenses) {
  const headway::test::TemporaryFolder folder;
  test::writeContent(folder / "c.yaml", kFiveLines);
  const RawStereoCamera camera = readRawCalibration(folder / "c.yaml");
  EXPECT_EQ(752, camera.left.width);
  EXPECT_EQ(480, camera.right.height);
  EXPECT_EQ(458.654, camera.left.fx);
  EXPECT_EQ(255.238, camera.right.cy);
  EXPECT_EQ((std::array<double, 5>{-0.28, 0.07, 0.0002, 1.8e-05, 0.0}), camera.left.distortion);
  EXPECT_EQ(0.01, camera.right.distortion[4]);
  EXPECT_EQ(Eigen::Vector3d(0.11, 0.001, 0.0), camera.T_left_right.translation());
  EXPECT_EQ(Eigen::Vector3d(0.5, 0.0, 1.2), camera.T_robot_left.translation());
  EXPECT_THAT(test::errorOf([&] { (void)readCalibration(folder / "c.yaml"); }),
              HasSubstr("not rectified"));
}

TEST(CalibrationFileTest, RightLensDefaultsToTheLeft) {
  const headway::test::TemporaryFolder folder;
  test::writeContent(folder / "c.yaml",
                     "image_size: [100, 50]\nleft: [80, 81, 50, 25]\nbaseline_m: 0.3\n");
  const StereoCamera camera = readCalibration(folder / "c.yaml");
  EXPECT_EQ(81.0, camera.fy);
  EXPECT_EQ(0.3, camera.baseline_m);
  EXPECT_TRUE(camera.T_robot_cam.isApprox(robotFromOptical()));
}

TEST(CalibrationFileTest, NamesTheError) {
  const std::string size = "image_size: [100, 50]\n";
  const std::string lens = "left: [80, 80, 50, 25]\n";
  EXPECT_THAT(messageFor(""), HasSubstr("c.yaml"));
  EXPECT_THAT(messageFor("[1, 2"), HasSubstr("YAML"));
  for (const char* sides : {"1e30, 50", "0, 50", "100, 49.5", "100, .nan"}) {
    EXPECT_THAT(messageFor("image_size: [" + std::string(sides) + "]\n" + lens + "baseline_m: 1\n"),
                HasSubstr("'image_size'"))
        << sides;
  }
  EXPECT_THAT(messageFor(size), HasSubstr("key 'left' is missing"));
  EXPECT_THAT(messageFor(size + lens), HasSubstr("'baseline_m' and 'T_left_right'"));
  EXPECT_THAT(messageFor(size + lens + "baseline_m: 0\n"), HasSubstr("baseline is zero"));
  EXPECT_THAT(messageFor(size + lens + "baseline_m: -1\n"), HasSubstr("swapped"));
  EXPECT_THAT(messageFor(size + lens + "baseline_m: one\n"), HasSubstr("not a number"));
  EXPECT_THAT(messageFor(size + lens + "baseline: 1\n"), HasSubstr("'baseline' is unknown"));
  EXPECT_THAT(messageFor(size + "left: [80, 80]\nbaseline_m: 1\n"),
              HasSubstr("has 2 numbers, must be 4 to 12"));
  EXPECT_THAT(messageFor(size + "left: [0, 80, 50, 25]\nbaseline_m: 1\n"),
              HasSubstr("focal length fx"));
  EXPECT_THAT(messageFor(size + lens + "baseline_m: 1\nT_robot_cam: [2,0,0,0,0,2,0,0,0,0,2,0]\n"),
              HasSubstr("not a rotation"));
  EXPECT_THAT(test::errorOf([] { (void)readCalibration("/nowhere/c.yaml"); }),
              HasSubstr("/nowhere/c.yaml: does not exist"));
}

}  // namespace
}  // namespace headway::io
