// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway_test/folders.h>
#include <headway_test/process.h>

#include <nlohmann/json.hpp>

namespace headway::app {
namespace {

using test::contentsOf;
using test::program;
using test::runProcess;
using test::TemporaryFolder;

TEST(NavProgramTest, WritesFiguresPicturesAndAVideo) {
  const TemporaryFolder folder;
  const std::string json = folder / "figures.json";
  const std::string video = folder / "video";
  const auto run = runProcess(program("headway-nav") +
                              " --trials 2 --policy all --seed 5 -q --set people.count=1 --json " +
                              json + " --video " + video + " --film 2");
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_EQ(run.output, "");
  const auto figures = nlohmann::json::parse(contentsOf(json));
  for (const char* policy : {"static", "sweep", "time_gated"}) {
    EXPECT_EQ(figures.at(policy).at("trials"), 2) << policy;
  }
  EXPECT_GT(std::filesystem::file_size(video + "/trial_0006.png"), 10000u);
  EXPECT_TRUE(std::filesystem::exists(video + "/trial_0006.mp4") ||
              std::filesystem::exists(video + "/trial_0006_frames/000000.png"));
}

TEST(NavProgramTest, WithoutArgumentsItSaysFirstWhatItRuns) {
  const TemporaryFolder folder;
  const auto run = runProcess("cd " + folder.path().string() + " && timeout -s INT 2 " +
                              program("headway-nav") + " -w");
  EXPECT_EQ(
      0u, run.output.find("headway-nav --trials 20 --policy all --seed 1 --worst nav-worst.png\n"))
      << run.output;
}

TEST(NavProgramTest, DrawsTheWorstTrial) {
  const TemporaryFolder folder;
  const std::string picture = folder / "worst.png";
  const auto run = runProcess(program("headway-nav") + " --trials 2 --policy static --seed 3 " +
                              "--set people.count=1 --worst " + picture);
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_NE(run.output.find("the worst trial, seed "), std::string::npos) << run.output;
  EXPECT_GT(std::filesystem::file_size(picture), 10000u);
}

TEST(NavProgramTest, ErrorsNameTheArgument) {
  EXPECT_EQ(runProcess(program("headway-nav") + " --policy hope").status, 2);
  EXPECT_EQ(runProcess(program("headway-nav") + " --trials 0").status, 2);
  EXPECT_EQ(runProcess(program("headway-nav") + " --video v --film x").status, 2);
  EXPECT_EQ(runProcess(program("headway-nav") + " --rig robot").status, 2);
  EXPECT_EQ(runProcess(program("headway-nav") + " --sense images").status, 2);
  EXPECT_EQ(runProcess(program("headway-nav") + " --world hall --sense smell").status, 2);
  EXPECT_EQ(runProcess(program("headway-nav") + " --layer map").status, 2);
  EXPECT_EQ(runProcess(program("headway-nav") + " --world hall --layer none").status, 2);
  EXPECT_EQ(runProcess(program("headway-nav") + " --jobs 0").status, 2);
  const auto nowhere = runProcess(program("headway-nav") + " --world nowhere");
  EXPECT_EQ(nowhere.status, 1);
  EXPECT_NE(nowhere.output.find("nowhere.ini"), std::string::npos);
  const auto unknown = runProcess(program("headway-nav") + " --set nav.magic=1");
  EXPECT_EQ(unknown.status, 1);
  EXPECT_NE(unknown.output.find("magic"), std::string::npos);
}

TEST(NavProgramTest, JobsDoNotChangeTheResults) {
  const TemporaryFolder folder;
  std::vector<nlohmann::json> figures;
  for (const char* jobs : {"1", "2"}) {
    const std::string json = folder / jobs;
    const auto run =
        runProcess(program("headway-nav") + " --trials 3 --policy time_gated --seed 7 -q --jobs " +
                   jobs + " --json " + json);
    ASSERT_EQ(run.status, 0) << run.output;
    figures.push_back(nlohmann::json::parse(contentsOf(json)).at("time_gated"));
    for (const char* timing : {"step_us_median", "sense_us_median"}) figures.back().erase(timing);
  }
  EXPECT_EQ(3, figures[0].at("trials"));
  EXPECT_EQ(figures[0], figures[1]);
}

TEST(NavProgramTest, DrivesThroughAWorldByEachSenseRigAndLayer) {
  const TemporaryFolder folder;
  const std::string json = folder / "figures.json", worst = folder / "worst.png";
  const std::string call = program("headway-nav") +
                           " -w -q --world " HEADWAY_SOURCE_DIR
                           "/config/worlds/hall.ini --seed 5 --set robot.time_limit_s=1 --set "
                           "robot.planning_rate_hz=5 --json " +
                           json;
  for (const std::string& options :
       {"--trials 2 --rig robot --sense truth --policy static --jobs 2 --worst " + worst,
        std::string("--trials 1 --rig small --sense images --layer map --policy time_gated"),
        std::string("--trials 1 --rig rgbd --sense images --policy time_gated")}) {
    const auto run = runProcess(call + " " + options);
    ASSERT_EQ(run.status, 0) << options << ": " << run.output;
    const auto figures = nlohmann::json::parse(contentsOf(json)).front();
    EXPECT_EQ(figures.at("trials"), figures.at("drives").size()) << options;
    EXPECT_EQ(figures.at("drives")[0].at("seed"), 5) << options;
    EXPECT_NEAR(figures.at("drives")[0].at("time_s"), 1.0, 0.01) << options;
  }
  EXPECT_GT(std::filesystem::file_size(worst), 10000u);
}

TEST(NavProgramTest, RefusesFilesThatExist) {
  const TemporaryFolder folder;
  const std::string json = folder / "figures.json";
  const std::string call = program("headway-nav") + " --trials 1 --policy static -q --json " + json;
  ASSERT_EQ(runProcess(call).status, 0);
  EXPECT_EQ(runProcess(call).status, 1);
  EXPECT_EQ(runProcess(call + " -w").status, 0);
}

}  // namespace
}  // namespace headway::app
