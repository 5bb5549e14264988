// SPDX-License-Identifier: BSD-3-Clause
// What is written beside a rawlog, for frames that are made by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <headway/io/calibration_file.h>
#include <headway/io/dataset.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/sim/recording.h>
#include <headway_test/folders.h>
#include <headway_test/input_error.h>
#include <headway_test/process.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "lens.h"

namespace headway::sim {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::vector<std::string> linesOf(const std::string& path) {
  std::istringstream text(test::contentsOf(path));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

std::vector<double> numbersIn(const std::string& line, char separator, std::size_t skip) {
  std::istringstream text(line);
  std::vector<double> numbers;
  std::size_t column = 0;
  for (std::string word; std::getline(text, word, separator); ++column) {
    if (column >= skip) numbers.push_back(std::stod(word));
  }
  return numbers;
}

CameraParams truthCamera() {
  CameraParams params;
  params.width = 64;
  params.height = 64;
  params.focal_px = 60.0;
  params.baseline_m = 0.2;
  params.mount_height_m = 1.0;
  return params;
}

/// A frame with one moving and one parked object, a laser scan, inertial samples and a drop.
SimFrame frameAt(std::size_t index) {
  SimFrame frame;
  frame.index = index;
  frame.time = 1700000000.0 + 0.1 * static_cast<double>(index);
  frame.left = cv::Mat(64, 64, CV_8UC3, cv::Scalar(10, 20, 30));
  frame.right = cv::Mat(64, 64, CV_8UC3, cv::Scalar(30, 20, 10));
  frame.depth = cv::Mat(64, 64, CV_32F, cv::Scalar(12.5));
  frame.depth.at<float>(0, 0) = 0.0F;
  frame.depth.at<float>(0, 1) = 400.0F;
  frame.instances = cv::Mat::zeros(64, 64, CV_16U);
  frame.instances(cv::Rect(10, 10, 5, 4)).setTo(1);
  frame.instances(cv::Rect(30, 30, 6, 6)).setTo(2);
  frame.T_map_robot.translation().x() = 0.5 * static_cast<double>(index);
  TruthObject walker;
  walker.id = 12;
  walker.object_class = ObjectClass::kPedestrian;
  walker.box3d = {{1.0, 0.4, 8.0}, 0.8, 0.6, 1.7, 0.3};
  walker.box2d = {10.0, 9.5, 14.5, 13.5};
  walker.visible = 0.65;
  walker.occlusion = 1;
  walker.truncation = 0.25;
  walker.position = {8.0, -1.0, 0.85};
  walker.velocity = {1.2, 0.1, 0.0};
  walker.yaw = 0.1;
  walker.size = {0.8, 0.6, 1.7};
  TruthObject parked = walker;
  parked.id = 13;
  parked.object_class = ObjectClass::kCar;
  parked.parked = true;
  parked.velocity.setZero();
  frame.objects = {walker, parked};
  frame.imu = {{frame.time - 0.01, {0.1, 0.2, 0.3}, {0.0, 0.0, 9.81}},
               {frame.time, {0.1, 0.2, 0.3}, {0.0, 0.0, 9.81}}};
  frame.odometry = OdometrySample{frame.time, 0.5 * static_cast<double>(index), 0.0, 0.0};
  io::RecordedScan scan;
  scan.time = frame.time;
  scan.aperture_rad = 4.7;
  scan.max_range_m = 10.0;
  scan.ranges = {1.0F, 0.0F, 3.0F};
  frame.laser = scan;
  if (index == 0) frame.drops = {{{{1, 2}, {3, 2}, {3, 4}}, 1.5}};
  return frame;
}

class TruthFilesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const Lens lens(truthCamera());
    Recording recording(rawlog, {}, {true, true}, lens.ideal(), lens.recorded(),
                        "[world]\nseed=3\n");
    for (std::size_t i = 0; i < 3; ++i) recording.write(frameAt(i));
    recording.close();
  }
  test::TemporaryFolder folder;
  std::string rawlog = (folder / "a.rawlog").string();
  std::string truth = truthFolder(rawlog);
};

TEST_F(TruthFilesTest, LabelsAreKittisWithTheVisibleRatioAsLastColumn) {
  const auto lines = linesOf(truth + "/label_02.txt");
  ASSERT_EQ(lines.size(), 6U);
  EXPECT_THAT(lines[0], StartsWith("0 12 Pedestrian "));
  EXPECT_THAT(lines[1], StartsWith("0 13 Car "));
  const auto rows = io::readKittiRows(truth + "/label_02.txt");
  ASSERT_EQ(rows.size(), 6U);
  const io::KittiRow& row = rows[2];
  EXPECT_EQ(row.frame, 1U);
  EXPECT_EQ(row.occlusion, 1);
  EXPECT_NEAR(row.truncation, 0.25, 1e-6);
  EXPECT_NEAR(row.visible, 0.65, 1e-3);
  EXPECT_NEAR(row.bottom_centre.y(), 0.4 + 0.85, 1e-3) << "its feet, y down";
  EXPECT_NEAR(row.alpha, 0.3 - std::atan2(1.0, 8.0), 1e-3);
  EXPECT_NEAR(row.rotation_y, 0.3, 1e-3);
  EXPECT_NEAR(row.box2d.left, 10.0, 0.01);
  EXPECT_NEAR(row.height, 1.7, 1e-3);
}

TEST_F(TruthFilesTest, ObjectsAreTheTracksColumnsAndVisible) {
  const auto lines = linesOf(truth + "/objects.csv");
  ASSERT_EQ(lines.size(), 7U);
  EXPECT_THAT(lines[0], StartsWith("frame,time,track_id,class,status,moving,x,y,z,yaw,"));
  EXPECT_THAT(lines[0], ::testing::EndsWith(",visible"));
  EXPECT_THAT(lines[1], StartsWith("0,1700000000.000000,12,Pedestrian,confirmed,1,"));
  EXPECT_THAT(lines[2], StartsWith("0,1700000000.000000,13,Car,confirmed,0,"));
  const auto numbers = numbersIn(lines[1], ',', 6);
  const std::vector<double> expected = {8.0, -1.0, 0.85, 0.1, 0.8, 0.6, 1.7,
                                        1.2, 0.1,  0.0,  0.0, 0.0, 0.0, 0.65};
  EXPECT_THAT(numbers, ::testing::Pointwise(::testing::DoubleNear(1e-4), expected));
}

TEST_F(TruthFilesTest, DropsAreOneRowForEachCornerOnce) {
  EXPECT_THAT(linesOf(truth + "/drops.csv"),
              ::testing::ElementsAre("drop,x,y,depth_m", "0,1.0000,2.0000,1.5000",
                                     "0,3.0000,2.0000,1.5000", "0,3.0000,4.0000,1.5000"));
}

TEST_F(TruthFilesTest, DepthIsInSteps256OfAMetreAndSaturates) {
  const cv::Mat depth = cv::imread(truth + "/depth/000001.png", cv::IMREAD_UNCHANGED);
  ASSERT_EQ(depth.type(), CV_16UC1);
  EXPECT_EQ(depth.at<std::uint16_t>(40, 40), 12.5 * 256);
  EXPECT_EQ(depth.at<std::uint16_t>(0, 0), 0);
  EXPECT_EQ(depth.at<std::uint16_t>(0, 1), 65535);
}

TEST_F(TruthFilesTest, MasksShowMovingObjectsAlone) {
  const cv::Mat mask = cv::imread(truth + "/masks/000002.png", cv::IMREAD_UNCHANGED);
  ASSERT_EQ(mask.type(), CV_8UC1);
  EXPECT_EQ(cv::countNonZero(mask), 20);
  EXPECT_EQ(mask.at<std::uint8_t>(12, 12), 255);
  EXPECT_EQ(mask.at<std::uint8_t>(32, 32), 0) << "parked";
}

TEST_F(TruthFilesTest, PosesAreWrittenForRobotAndCamera) {
  const auto robot = io::readTum(truth + "/trajectory.tum");
  const auto camera = io::readKittiPoses(truth + "/poses_kitti.txt");
  ASSERT_EQ(robot.size(), 3U);
  ASSERT_EQ(camera.size(), 3U);
  EXPECT_NEAR(robot[2].value.translation().x(), 1.0, 1e-6);
  EXPECT_NEAR(robot[2].time, 1700000000.2, 1e-5);
  EXPECT_NEAR(camera[2].translation().z(), 1.0, 1e-6) << "the camera's z is forward";
  EXPECT_LT((camera[0].matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-6);
}

TEST_F(TruthFilesTest, TheWorldIsKeptAsItWasGiven) {
  EXPECT_EQ(test::contentsOf(truth + "/world.ini"), "[world]\nseed=3\n");
}

TEST_F(TruthFilesTest, TruthInsideTheRawlogIsTheSame) {
  const auto inside = io::readTruth(rawlog);
  ASSERT_EQ(inside.poses.size(), 3U);
  ASSERT_EQ(inside.objects.at(1).items.size(), 2U);
  const Detection& walker = inside.objects[1].items[0];
  EXPECT_EQ(walker.detector_id, 12);
  EXPECT_NEAR(walker.box3d->centre.z(), 8.0, 1e-6);
  EXPECT_NEAR(walker.score, 0.65, 1e-6);
  io::RawlogSource source(rawlog, {});
  int frames = 0;
  while (const auto frame = source.next()) {
    ++frames;
    EXPECT_EQ(frame->stereo->left.size(), cv::Size(64, 64));
  }
  EXPECT_EQ(frames, 3);
}

TEST_F(TruthFilesTest, CalibrationsSayWhatTheCamerasAre) {
  const auto projections = io::readKittiProjections(truth + "/calib.txt");
  EXPECT_NEAR(projections.at("P0")(0, 0), 60.0, 1e-9);
  EXPECT_NEAR(projections.at("P0")(0, 2), 31.5, 1e-9);
  EXPECT_NEAR(projections.at("P1")(0, 3), -60.0 * 0.2, 1e-9);
  EXPECT_NEAR(projections.at("P3")(0, 3), projections.at("P1")(0, 3), 1e-12);
  const StereoCamera rectified = io::readCalibration(truth + "/calibration.yaml");
  EXPECT_EQ(rectified.width, 64);
  EXPECT_DOUBLE_EQ(rectified.fx, 60.0);
  EXPECT_DOUBLE_EQ(rectified.cx, 31.5);
  EXPECT_DOUBLE_EQ(rectified.baseline_m, 0.2);
  EXPECT_LT((rectified.T_robot_cam.matrix() - Lens(truthCamera()).ideal().T_robot_cam.matrix())
                .cwiseAbs()
                .maxCoeff(),
            1e-12);
  const auto imported = io::readStereoCalibration(truth + "/calibration.yaml");
  EXPECT_EQ(imported.format, "headway");
  EXPECT_TRUE(imported.is_mounted);
}

TEST(TruthFolderTest, LiesBesideTheRawlog) {
  EXPECT_EQ(truthFolder("a/b/city.rawlog"), "a/b/city.truth");
  EXPECT_EQ(truthFolder("city"), "city.truth");
}

TEST(RecordingErrorsTest, NameThePathThatCannotBeWritten) {
  const Lens lens(truthCamera());
  EXPECT_THAT(test::inputErrorOf([&] {
                Recording("/nowhere/a.rawlog", {}, {}, lens.ideal(), lens.recorded(), "");
              }),
              HasSubstr("/nowhere/a"));
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "b.truth/calib.txt");
  EXPECT_THAT(test::inputErrorOf([&] {
                Recording((folder / "b.rawlog").string(), {}, {}, lens.ideal(), lens.recorded(),
                          "");
              }),
              StartsWith((folder / "b.truth/calib.txt").string() + ": is a folder"));
  Recording recording((folder / "a.rawlog").string(), {}, {true, false}, lens.ideal(),
                      lens.recorded(), "");
  std::filesystem::remove_all(folder / "a.truth/masks");
  EXPECT_THAT(test::inputErrorOf([&] { recording.write(frameAt(0)); }),
              HasSubstr("000000.png: cannot be written"));
}

TEST(EstimateMegabytesTest, IsInProportionToFramesAndGrowsWithWhatIsAskedFor) {
  const std::vector<SimFrame> frames = {frameAt(0), frameAt(1)};
  RecordingParams params;
  const double plain = estimateMegabytes(frames, params, {}, 100);
  EXPECT_NEAR(estimateMegabytes(frames, params, {}, 200), 2.0 * plain, 1e-9);
  EXPECT_GT(estimateMegabytes(frames, params, {true, false}, 100), plain);
  EXPECT_GT(estimateMegabytes(frames, params, {true, true}, 100),
            estimateMegabytes(frames, params, {true, false}, 100));
}

}  // namespace
}  // namespace headway::sim
