// SPDX-License-Identifier: BSD-3-Clause
// A simulated depth camera through the whole of headway: pose, moving objects, grid and report.
#include <gmock/gmock.h>
#include <headway/io/trajectory_file.h>
#include <headway_test/paths.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <utility>

#include "replay_run.h"

namespace headway {
namespace {

using ::testing::HasSubstr;

constexpr int kFrames = 160;

class DepthCameraRunTest : public ::testing::Test {
 protected:
  /// The office floor with people, recorded and replayed once.
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder();
    simulate("hall", "");
    run_ = new test::ReplayRun(
        test::replay(*folder_ / "hall.rawlog", *folder_ / "out", "--snapshots 1"));
    ASSERT_EQ(0, run_->process.status) << run_->process.output;
  }
  static void simulate(const std::string& name, const std::string& arguments) {
    const auto simulated = test::runProcess(
        test::program("headway-sim") + " -q -c " + std::string(HEADWAY_SOURCE_DIR) +
        "/config/worlds/hall.ini --rig rgbd --frames " + std::to_string(kFrames) + " -o " +
        (*folder_ / (name + ".rawlog")).string() + arguments);
    ASSERT_EQ(0, simulated.status) << simulated.output;
  }
  static void TearDownTestSuite() {
    delete run_;
    delete folder_;
  }

  static test::TemporaryFolder* folder_;
  static test::ReplayRun* run_;
};

test::TemporaryFolder* DepthCameraRunTest::folder_ = nullptr;
test::ReplayRun* DepthCameraRunTest::run_ = nullptr;

TEST_F(DepthCameraRunTest, FollowsTheCameraToACentimetre) {
  EXPECT_EQ(kFrames, run_->summary.at("frames_tracked"));
  const double ate = test::ateRmse(io::readTum(*folder_ / "hall.truth/trajectory.tum"),
                                   io::readTum(run_->file("trajectory.tum")));
  EXPECT_LT(ate, 0.012);
}

TEST_F(DepthCameraRunTest, FindsPeopleWhoMoveAndTheFloor) {
  EXPECT_GT(run_->summary.at("detections_used"), 15);
  EXPECT_GE(run_->summary.at("tracks_moving"), 1);
  EXPECT_GT(test::contentsOf(run_->file("map_grid.png")).size(), 0u);
  EXPECT_TRUE(run_->summary.at("warnings").empty()) << run_->summary.at("warnings");
}

TEST_F(DepthCameraRunTest, SaysThatItIsADepthCamera) {
  EXPECT_NE(std::string::npos, run_->process.output.find("depth camera: focal length 425.00 px"));
  EXPECT_NE(std::string::npos, run_->process.output.find("rig: depth camera to 8.0 m"));
  EXPECT_TRUE(run_->summary.at("calibration").at("depth_camera"));
  EXPECT_GT(run_->summary.at("calibration").at("depth_ratio"), 0.5);
  EXPECT_EQ(8.0, run_->summary.at("rig").at("depth_reach_m"));
  EXPECT_NE(std::string::npos, test::contentsOf(run_->file("report.html")).find("Depth camera"));
  EXPECT_NE(std::string::npos,
            test::contentsOf(run_->file("calibration.yaml")).find("depth_range_m: 8"));
}

TEST_F(DepthCameraRunTest, IsEvaluatedAsAnyOtherRun) {
  const std::string truth = *folder_ / "hall.truth";
  const auto evaluated = test::runProcess(
      test::program("headway-eval") + " movers --truth " + truth + "/label_02.txt --poses " +
      truth + "/poses_kitti.txt --estimate " + (*folder_ / "out").string());
  EXPECT_EQ(0, evaluated.status) << evaluated.output;
}

TEST_F(DepthCameraRunTest, FindsPeopleWhoStandByTheirShape) {
  simulate("people", " --seed 301");
  const auto alone = test::replay(*folder_ / "people.rawlog", *folder_ / "alone",
                                  "--snapshots 0 --detector stereo_motion+shape");
  ASSERT_EQ(0, alone.process.status) << alone.process.output;
  const std::string figures = (*folder_ / "people.json").string();
  const auto evaluated = test::runProcess(
      test::program("headway-eval") + " people " + (*folder_ / "alone").string() + " --truth " +
      (*folder_ / "people.truth").string() + " --reach 4 --json " + figures);
  ASSERT_EQ(0, evaluated.status) << evaluated.output;
  const auto people = nlohmann::json::parse(test::contentsOf(figures));
  double standing = 0.0, found = 0.0;
  for (const auto& [range, cell] : people.at("standing").items()) {
    standing += cell.at("person_frames").get<double>();
    found += cell.at("found").get<double>();
  }
  EXPECT_GT(standing, 20.0);
  EXPECT_GT(found, 0.7 * standing);
  EXPECT_LT(people.at("false_rows").get<double>(), 0.05 * people.at("rows").get<double>());
}

TEST_F(DepthCameraRunTest, LocalisesInTheMapOfAnEarlierRun) {
  const auto again = test::replay(
      *folder_ / "hall.rawlog", *folder_ / "again",
      "--snapshots 0 --detector none --to-index 30 --load-map " + run_->file("map.headway"));
  ASSERT_EQ(0, again.process.status) << again.process.output;
  EXPECT_GT(again.summary.at("frames_tracked"), 28);
}

/// A RealSense on a rolling robot, nothing moves.
class RealDepthCameraTest : public ::testing::Test {
 protected:
  void SetUp() override {
    HEADWAY_REQUIRE_DATA(data);
    clip_ = (data / "rgbd/realsense_robot").string();
    if (!std::filesystem::exists(clip_)) GTEST_SKIP() << clip_ << " is missing";
  }

  test::ProcessResult import(const std::string& calibration, const std::string& rate_hz) const {
    return test::runProcess(test::program("headway-import") + " images -q -w --left " + clip_ +
                            "/rgb --depth " + clip_ + "/depth --calibration " + calibration +
                            " --rate " + rate_hz + " -o " + rawlog());
  }

  [[nodiscard]] std::string rawlog() const { return folder_ / "room.rawlog"; }

  /// The calibration with a key that has another value, or none.
  std::string changed(const std::string& key, const std::string& value) const {
    std::istringstream all(test::contentsOf(clip_ + "/calibration.yaml"));
    std::ofstream file(folder_ / "c.yaml");
    for (std::string row; std::getline(all, row);) {
      if (row.rfind(key + ":", 0) != 0) file << row << '\n';
    }
    if (!value.empty()) file << key << ": " << value << '\n';
    return folder_ / "c.yaml";
  }

  /// What a replay says about the mounting.
  [[nodiscard]] std::string saidOfMounting() const {
    const auto run = test::replay(rawlog(), folder_ / "out", "-w --snapshots 0 --detector none");
    EXPECT_EQ(0, run.process.status) << run.process.output;
    const auto& warnings = run.summary.at("warnings");
    return warnings.contains("camera_mounting")
               ? warnings.at("camera_mounting").at("text").get<std::string>()
               : "";
  }

  std::string clip_;
  test::TemporaryFolder folder_;
};

// Neighbouring depths err alike, and for a while.
TEST_F(RealDepthCameraTest, NothingMovesInAStaticRoomAtAnyRate) {
  for (const char* rate : {"5", "10", "15", "30"}) {
    const auto imported = import(clip_ + "/calibration.yaml", rate);
    ASSERT_EQ(0, imported.status) << imported.output;
    for (const std::string detector : {"stereo_motion", "stereo_motion+shape"}) {
      const auto run =
          test::replay(rawlog(), folder_ / "out", "-w --snapshots 0 --detector " + detector);
      ASSERT_EQ(0, run.process.status) << run.process.output;
      EXPECT_EQ(0, run.summary.at("tracks_moving")) << detector << " at " << rate << " Hz";
      EXPECT_EQ(0, run.summary.at("frames_lost")) << detector << " at " << rate << " Hz";
    }
  }
}

TEST_F(RealDepthCameraTest, TheFloorShowsTheMounting) {
  ASSERT_EQ(0, import(clip_ + "/calibration.yaml", "10").status);
  EXPECT_EQ("", saidOfMounting()) << "as it is stated";
  ASSERT_EQ(0, import(changed("T_robot_cam", ""), "10").status);
  const std::string said = saidOfMounting();
  std::smatch match;
  ASSERT_TRUE(std::regex_search(
      said, match, std::regex("is ([0-9.]+) m above the floor, looking ([0-9.]+) deg down")))
      << said;
  EXPECT_NEAR(0.62, std::stod(match[1]), 0.03);
  EXPECT_NEAR(19.0, std::stod(match[2]), 1.5);
}

TEST_F(RealDepthCameraTest, AWrongUnitOfDepthsIsNamed) {
  for (const auto& [unit_m, text] : {std::pair("0.005", "as of 1/5000 m, read as millimetres"),
                                     std::pair("0.0002", "as of millimetres, read as 1/5000 m")}) {
    ASSERT_EQ(0, import(changed("depth_unit_m", unit_m), "10").status);
    EXPECT_THAT(saidOfMounting(), HasSubstr(text)) << unit_m;
  }
  const auto refused = import(changed("depth_unit_m", "1"), "10");
  EXPECT_EQ(1, refused.status);
  EXPECT_THAT(refused.output, HasSubstr("it is 0.001 as a rule"));
}

}  // namespace
}  // namespace headway
