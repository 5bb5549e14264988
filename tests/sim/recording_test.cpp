// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/core/params.h>
#include <headway/io/dataset.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/sim/recording.h>
#include <headway_test/folders.h>
#include <headway_test/paths.h>
#include <headway_test/process.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <sstream>

namespace headway::sim {
namespace {

using ::testing::HasSubstr;

const std::string kProgram = std::string(HEADWAY_BIN_DIR) + "/headway-sim";
const std::string kTiny =
    " --set camera.width=320 --set camera.height=120 --set camera.focal_px=186 --frames 4 -q";

/// One recording with everything, made by the program itself.
class RecordedTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = std::make_unique<test::TemporaryFolder>();
    rawlog = (*folder / "town.rawlog").string();
    truth = truthFolder(rawlog);
    result = test::runProcess(kProgram + " -o " + rawlog + kTiny + " --masks --depth --seed 5");
  }
  static void TearDownTestSuite() { folder.reset(); }
  void SetUp() override { ASSERT_EQ(result.status, 0) << result.output; }

  static std::unique_ptr<test::TemporaryFolder> folder;
  static std::string rawlog, truth;
  static test::ProcessResult result;
};
std::unique_ptr<test::TemporaryFolder> RecordedTest::folder;
std::string RecordedTest::rawlog, RecordedTest::truth;
test::ProcessResult RecordedTest::result;

TEST_F(RecordedTest, RawlogReadsBackAsRectifiedStereoWithDetections) {
  io::RawlogSource source(rawlog, {});
  std::size_t frames = 0;
  while (const auto frame = source.next()) {
    ASSERT_TRUE(frame->stereo);
    EXPECT_EQ(frame->stereo->left.cols, 320);
    EXPECT_FALSE(frame->stereo->left_colour.empty());
    EXPECT_TRUE(frame->detections);
    EXPECT_FALSE(frame->T_map_robot);  // truth never comes out
    ++frames;
  }
  EXPECT_EQ(frames, 4U);
  ASSERT_TRUE(source.camera());
  EXPECT_DOUBLE_EQ(source.camera()->baseline_m, 0.54);
  EXPECT_DOUBLE_EQ(source.camera()->fx, 186.0);
}

TEST_F(RecordedTest, TruthInsideAndBesideAreTheSame) {
  const auto inside = io::readTruth(rawlog);
  const auto beside = io::readTum(truth + "/trajectory.tum");
  const auto rows = io::readKittiRows(truth + "/label_02.txt");
  ASSERT_EQ(inside.poses.size(), 4U);
  ASSERT_EQ(beside.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT((inside.poses[i].value.translation() - beside[i].value.translation()).norm(), 1e-6);
    const auto count = std::count_if(rows.begin(), rows.end(),
                                     [&](const io::KittiRow& row) { return row.frame == i; });
    EXPECT_EQ(static_cast<std::size_t>(count), inside.objects[i].items.size());
  }
  for (const io::KittiRow& row : rows) {
    EXPECT_GE(row.visible, 0.0);
    EXPECT_LE(row.visible, 1.0);
    EXPECT_GT(row.bottom_centre.z(), 0.0);
  }
  EXPECT_EQ(io::readKittiPoses(truth + "/poses_kitti.txt").size(), 4U);
}

TEST_F(RecordedTest, MasksAndDepthHaveTheImagesSize) {
  for (const char* name : {"/masks/000003.png", "/depth/000000.png"}) {
    const cv::Mat picture = cv::imread(truth + name, cv::IMREAD_UNCHANGED);
    EXPECT_EQ(picture.size(), cv::Size(320, 120)) << name;
  }
  for (const char* name : {"/calib.txt", "/calibration.yaml", "/objects.csv", "/world.ini"}) {
    EXPECT_GT(std::filesystem::file_size(truth + name), 100U) << name;
  }
}

TEST_F(RecordedTest, TheWorldAsUsedMakesTheSameBytesAgain) {
  const std::string again = (*folder / "again.rawlog").string();
  const auto second = test::runProcess(kProgram + " -c " + truth + "/world.ini -q -o " + again);
  ASSERT_EQ(second.status, 0) << second.output;
  EXPECT_TRUE(test::contentsOf(again) == test::contentsOf(rawlog));
  EXPECT_EQ(test::contentsOf(truthFolder(again) + "/label_02.txt"),
            test::contentsOf(truth + "/label_02.txt"));
}

TEST_F(RecordedTest, IsExportedAsAKittiSequenceThatOthersCanRead) {
  const auto sequence = *folder / "sequences/00";
  std::filesystem::create_directories(sequence.parent_path());
  const auto exported =
      test::runProcess(std::string(HEADWAY_BIN_DIR) + "/headway-export kitti-odometry " + rawlog +
                       " -q -o " + sequence.string());
  ASSERT_EQ(exported.status, 0) << exported.output;
  for (const auto& [name, type] : {std::pair("image_0", CV_8UC1), std::pair("image_1", CV_8UC1),
                                   std::pair("image_2", CV_8UC3), std::pair("image_3", CV_8UC3)}) {
    // As a program that knows nothing of us opens a numbered sequence.
    cv::VideoCapture numbered((sequence / name / "%06d.png").string(), cv::CAP_IMAGES);
    cv::Mat picture;
    int count = 0;
    for (; numbered.read(picture); ++count) EXPECT_EQ(picture.size(), cv::Size(320, 120));
    EXPECT_EQ(count, 4) << name;
    EXPECT_EQ(cv::imread((sequence / name / "000003.png").string(), cv::IMREAD_UNCHANGED).type(),
              type);
  }
  EXPECT_EQ(io::openKittiOdometry(folder->path().string(), "00")->size(), 4U);
  auto projections = io::readKittiProjections((sequence / "calib.txt").string());
  EXPECT_DOUBLE_EQ(projections["P0"](0, 0), 186.0);
  EXPECT_NEAR(projections["P1"](0, 3), -186.0 * 0.54, 1e-6);
  const auto exported_poses = io::readKittiPoses((sequence / "poses.txt").string());
  const auto true_poses = io::readKittiPoses(truth + "/poses_kitti.txt");
  ASSERT_EQ(exported_poses.size(), true_poses.size());
  for (std::size_t i = 0; i < true_poses.size(); ++i) {
    EXPECT_LT((exported_poses[i].matrix() - true_poses[i].matrix()).norm(), 1e-5);
  }
}

TEST_F(RecordedTest, AnOutputThatExistsIsRefused) {
  const auto second = test::runProcess(kProgram + " -o " + rawlog + kTiny);
  EXPECT_EQ(second.status, 1);
  EXPECT_THAT(second.output, HasSubstr("-w"));
}

TEST(HeadwaySimTest, SaysBeforehandHowMuchDiskItTakes) {
  const test::TemporaryFolder folder;
  const auto result = test::runProcess(
      kProgram + " -o " + (folder / "a.rawlog").string() +
      " --set camera.width=320 --set camera.height=120 --set camera.focal_px=186 --frames 2 "
      "--set recording.storage=external_jpeg");
  ASSERT_EQ(result.status, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr(" MB for 2 frames"));
  EXPECT_TRUE(std::filesystem::is_directory(folder / "a_Images"));
}

TEST(HeadwaySimTest, APathThatEndsBeforeTheFramesDoIsSaidWithItsCount) {
  const test::TemporaryFolder folder;
  const std::string call = kProgram + " -q -o " + (folder / "a.rawlog").string() +
                           " --set camera.width=160 --set camera.height=64 --set "
                           "camera.focal_px=90 --set 'route.shape=straight 10' --frames 200";
  const auto result = test::runProcess(call);
  EXPECT_EQ(result.status, 0) << result.output;
  const auto frames = io::readTum(truthFolder((folder / "a.rawlog").string()) + "/trajectory.tum");
  EXPECT_GT(frames.size(), 5U);
  EXPECT_THAT(result.output,
              HasSubstr("ended after " + std::to_string(frames.size()) + " of 200 frames"));
  const auto nothing = test::runProcess(call + " -w --set recording.first_frame=150");
  EXPECT_EQ(nothing.status, 1);
  EXPECT_THAT(nothing.output, HasSubstr("[recording] first_frame"));
}

TEST(HeadwaySimTest, BadInputEndsWithOneLineThatNamesTheKey) {
  const test::TemporaryFolder folder;
  const std::string output = " -q -o " + (folder / "a.rawlog").string();
  for (const auto& [arguments, key] :
       {std::pair<std::string, std::string>{"--set traffic.vehicles=-3", "vehicles"},
        {"--set traffic.elephants=3", "elephants"},
        {"--set traffic.vehicles=190", "vehicles"},
        {"--set camera.width=twelve", "width"},
        {"-c /nowhere.ini", "/nowhere.ini"}}) {
    const auto result = test::runProcess(kProgram + output + " " + arguments);
    EXPECT_EQ(result.status, 1) << arguments;
    EXPECT_THAT(result.output, HasSubstr(key));
    EXPECT_EQ(std::count(result.output.begin(), result.output.end(), '\n'), 1);
  }
  EXPECT_EQ(test::runProcess(kProgram).status, 2);
  const auto unwritable = test::runProcess(kProgram + " -q --frames 1 -o /nowhere/a.rawlog");
  EXPECT_EQ(unwritable.status, 1);
  EXPECT_THAT(unwritable.output, HasSubstr("/nowhere"));
}

TEST(WorldsTest, EveryNamedWorldLoadsAndCanBe) {
  int worlds = 0, frames = 0;
  const auto folder = std::filesystem::path(HEADWAY_SOURCE_DIR) / "config/worlds";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".ini") continue;
    SimParams settings;
    Params params;
    settings.describe(params);
    params.loadFile(entry.path().string());
    EXPECT_NO_THROW(settings.validate()) << entry.path();
    frames += entry.path().stem() == "street" ? 0 : settings.recording.frames;
    ++worlds;
  }
  EXPECT_GE(worlds, 8);
  EXPECT_GE(frames, 8000);
}

TEST(ParamsTest, WhatIsPrintedLoadsAgain) {
  SimParams settings;
  Params params;
  settings.describe(params);
  std::ostringstream text;
  params.print(text);
  for (const char* section : {"[route]", "[world]", "[traffic]", "[camera]", "[detector]"}) {
    EXPECT_THAT(text.str(), HasSubstr(section));
  }
}

}  // namespace
}  // namespace headway::sim
