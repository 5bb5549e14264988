// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "run_program.h"

namespace headway::eval {
namespace {

using testing::HasSubstr;

class SuiteCommandTest : public testing::Test {
 protected:
  /// A small street of a few frames.
  std::string world(const std::string& more = "") {
    const auto path = folder_ / "tiny.ini";
    std::ofstream(path) << "[camera]\nwidth = 320\nheight = 120\nfocal_px = 185\n"
                           "[traffic]\nvehicles = 3\ncyclists = 0\npedestrians = 4\n"
                           "[recording]\nframes = 12\n"
                        << more;
    return path;
  }
  test::TemporaryFolder folder_;
};

TEST_F(SuiteCommandTest, SimulatesReplaysAndPrintsThreeTables) {
  const std::string out = folder_ / "out";
  const std::string json = folder_ / "s.json";
  const auto result = runEval("suite --quick --worlds " + world() + " -o " + out + " --json " +
                              json + " --plot " + std::string(folder_ / "s.png"));
  ASSERT_EQ(0, result.status) << result.error;
  EXPECT_THAT(result.out, HasSubstr("Camera position by rejection of moving objects"));
  EXPECT_THAT(result.out, HasSubstr("Predictions on headway's tracks"));
  EXPECT_THAT(result.out, HasSubstr("Predictions on exact histories"));
  EXPECT_THAT(result.out, HasSubstr("Positions of objects"));
  EXPECT_EQ(result.out, contentOf(out + "/suite.md"));
  const auto figures = nlohmann::json::parse(contentOf(json));
  for (const char* rejection : {"none", "boxes", "geometric", "both"}) {
    EXPECT_TRUE(figures.at("tiny").at("camera")[rejection].contains("frames_lost")) << rejection;
  }
  EXPECT_TRUE(figures.at("tiny").at("objects").at("ours").at("all").contains("rmse_m"));
  EXPECT_TRUE(figures.at("tiny").at("predictions_on_truth").contains("constant_velocity"));
  EXPECT_THAT(contentOf(folder_ / "s.png"), testing::StartsWith("\x89PNG"));
  EXPECT_TRUE(std::filesystem::exists(out + "/tiny.rawlog"));

  const auto again = runEval("suite --quick --worlds " + world() + " -o " + out);
  EXPECT_EQ(1, again.status);
  EXPECT_THAT(again.error, HasSubstr("exists already"));
}

TEST_F(SuiteCommandTest, ARobotsWorldIsARowForEachRig) {
  const std::string json = folder_ / "s.json";
  const auto result = runEval("suite -q --frames 3 --worlds " +
                              world("[world]\nkind = hall\n[route]\nspeed_mps = 0.9\n") + " -o " +
                              std::string(folder_ / "out") + " --json " + json);
  ASSERT_EQ(0, result.status) << result.error;
  const auto figures = nlohmann::json::parse(contentOf(json));
  for (const char* name : {"tiny-robot", "tiny-small"}) {
    ASSERT_TRUE(figures.contains(name)) << name;
    EXPECT_TRUE(figures[name].at("camera").contains("both"));
    EXPECT_FALSE(figures[name].at("camera").contains("none"));
  }
  EXPECT_FALSE(figures.contains("tiny"));
}

TEST_F(SuiteCommandTest, EveryWorldForRobotsIsEvaluatedEvenWhereNoObjectIsVisible) {
  const auto worlds = folder_ / "worlds";
  std::filesystem::create_directories(worlds);
  for (const std::string kind : {"hall", "campus", "warehouse"}) {
    std::ofstream(worlds / (kind + ".ini"))
        << "[world]\nkind = " << kind << "\n[route]\nspeed_mps = 0.9\n"
        << "[traffic]\nvehicles = 0\ncyclists = 0\npedestrians = 0\nidle_people = 0\n";
  }
  const std::string json = folder_ / "s.json";
  const auto result = runEval("suite -q --frames 2 --worlds " + worlds.string() + " -o " +
                              std::string(folder_ / "out") + " --json " + json);
  ASSERT_EQ(0, result.status) << result.error;
  const auto figures = nlohmann::json::parse(contentOf(json));
  for (const std::string kind : {"hall", "campus", "warehouse"}) {
    for (const std::string rig : {"robot", "small"}) {
      ASSERT_TRUE(figures.contains(kind + "-" + rig));
      EXPECT_EQ(1U, figures[kind + "-" + rig].at("camera").size()) << "`both` alone";
      EXPECT_TRUE(figures[kind + "-" + rig].at("camera").contains("both"));
    }
  }
}

TEST_F(SuiteCommandTest, ReusesARecordingOfTheSameWorld) {
  const std::string out = folder_ / "out";
  const std::string suite = " -q --worlds " + world() + " -o " + out + " --reuse";
  ASSERT_EQ(0, runEval("suite" + suite).status);
  const auto report = contentOf(out + "/suite.md");
  const auto rawlog = out + "/tiny.rawlog";
  const auto drawn_at = std::filesystem::last_write_time(rawlog);
  const auto again = runEval("suite" + suite);
  ASSERT_EQ(0, again.status) << again.error;
  EXPECT_EQ(report, contentOf(out + "/suite.md"));
  EXPECT_EQ(drawn_at, std::filesystem::last_write_time(rawlog));
  world("[world]\nseed = 2\n");
  ASSERT_EQ(0, runEval("suite" + suite).status);
  EXPECT_NE(drawn_at, std::filesystem::last_write_time(rawlog)) << "another world, the same name";
}

TEST_F(SuiteCommandTest, AnotherRateKeepsTheTime) {
  const std::string out = folder_ / "out";
  const auto result = runEval("suite -q --rate 20 --frames 3 --worlds " + world() + " -o " + out);
  ASSERT_EQ(0, result.status) << result.error;
  std::istringstream rows(contentOf(out + "/tiny.truth/trajectory.tum"));
  std::vector<double> times;
  for (std::string row; std::getline(rows, row);) times.push_back(std::stod(row));
  ASSERT_EQ(6U, times.size()) << "3 frames at 10 Hz";
  EXPECT_NEAR(0.25, times.back() - times.front(), 1e-6);
  EXPECT_EQ(2, runEval("suite --rate -1 -o " + out).status);
  EXPECT_EQ(2, runEval("suite --rate 5 --jobs 2 -o " + out).status);
}

TEST_F(SuiteCommandTest, NothingToEvaluateIsAUsageError) {
  EXPECT_EQ(2, runEval("suite --worlds none -o " + std::string(folder_ / "out")).status);
  EXPECT_EQ(2, runEval("suite --degrade x.ini -o " + std::string(folder_ / "out")).status);
}

TEST_F(SuiteCommandTest, AJobStoresTheRunsOfItsWorldOnly) {
  const std::string out = folder_ / "out";
  const auto job = runEval("suite -q --only-runs --frames 6 --worlds " + world() + " -o " + out);
  ASSERT_EQ(0, job.status) << job.error;
  EXPECT_TRUE(std::filesystem::exists(out + "/tiny.rawlog"));
  EXPECT_GT(std::filesystem::file_size(out + "/tiny.runs"), 1000U);
  EXPECT_FALSE(std::filesystem::exists(out + "/suite.md"));
  EXPECT_EQ(2, runEval("suite --only-runs --jobs 2 -o " + out).status);
  EXPECT_EQ(2, runEval("suite --profile slurm -o " + out).status);
  EXPECT_EQ(2, runEval("suite --jobs -1 -o " + out).status);
}

TEST_F(SuiteCommandTest, NamesInvalidWorlds) {
  const auto result = runEval("suite --worlds " + world("no_such_key = 1\n") + " -o " +
                              std::string(folder_ / "out"));
  EXPECT_EQ(1, result.status);
  EXPECT_THAT(result.error, HasSubstr("tiny.ini"));
  EXPECT_THAT(result.error, HasSubstr("no_such_key"));
  EXPECT_EQ(1, runEval("suite --worlds " + std::string(folder_ / "none")).status);
}

}  // namespace
}  // namespace headway::eval
