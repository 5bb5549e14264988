// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway_test/paths.h>

#include <nlohmann/json.hpp>

#include "run_program.h"

namespace headway::eval {
namespace {

using testing::HasSubstr;

/// A few turns in TUM format, shifted by `dx` and begun at `start` seconds.
std::string tumFile(double dx, double start) {
  std::ostringstream text;
  text.precision(12);
  for (int i = 0; i < 20; ++i) {
    text << start + 0.1 * i << " " << dx + i << " " << 0.05 * i * i << " 0 0 0 0 1\n";
  }
  return text.str();
}

std::string kittiFile(int rows, double step) {
  std::ostringstream text;
  for (int i = 0; i < rows; ++i)
    text << "1 0 0 " << 0.01 * i * i << " 0 1 0 0 0 0 1 " << step * i << "\n";
  return text.str();
}

class TrajectoryCommandTest : public testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& content) {
    std::ofstream(folder_ / name) << content;
    return folder_ / name;
  }
  ProgramRun run(const std::string& truth, const std::string& estimate,
                 const std::string& more = "") {
    return runEval("trajectory --truth " + truth + " --estimate " + estimate + " " + more);
  }
  test::TemporaryFolder folder_;
};

TEST_F(TrajectoryCommandTest, WritesTableJsonAndPicture) {
  const auto truth = file("truth.tum", "# t x y z qx qy qz qw\n" + tumFile(0.0, 100.0));
  const auto estimate = file("estimate.tum", tumFile(0.5, 100.001));
  const std::string json = folder_ / "e.json";
  const std::string plot = folder_ / "e.png";
  const auto aligned = run(truth, estimate, "--json " + json + " --plot " + plot);
  EXPECT_EQ(0, aligned.status) << aligned.error;
  EXPECT_THAT(aligned.out, HasSubstr("20 of 20"));
  EXPECT_NEAR(0.0, nlohmann::json::parse(contentOf(json)).at("ate_rmse_m").get<double>(), 1e-6);
  EXPECT_THAT(contentOf(plot), testing::StartsWith("\x89PNG"));

  const auto again = run(truth, estimate, "--json " + json);
  EXPECT_EQ(1, again.status);
  EXPECT_THAT(again.error, HasSubstr("exists already"));

  const auto raw = run(truth, estimate, "-q -w --align none --json " + json);
  EXPECT_EQ(0, raw.status);
  EXPECT_EQ("", raw.out);
  EXPECT_NEAR(0.5, nlohmann::json::parse(contentOf(json)).at("ate_rmse_m").get<double>(), 1e-6);
}

TEST_F(TrajectoryCommandTest, TheTruthsBodyMayHaveOtherAxes) {
  // A straight drive along x; the truth is that of the camera's optical frame.
  std::ostringstream truth, estimate;
  for (int i = 0; i < 20; ++i) {
    truth << 100 + i << " " << i << " 0 0 -0.5 0.5 -0.5 0.5\n";
    estimate << 100 + i << " " << i << " 0 0 0 0 0 1\n";
  }
  const auto optical = file("truth.tum", truth.str()), robot = file("estimate.tum", estimate.str());
  const auto asked = run(optical, robot);
  EXPECT_EQ(0, asked.status);
  EXPECT_THAT(asked.error, HasSubstr("state --truth-rotation YAW,PITCH,ROLL"));
  const std::string json = folder_ / "e.json";
  const auto stated = run(optical, robot, "--truth-rotation=-90,0,-90 --json " + json);
  EXPECT_EQ("", stated.error);
  EXPECT_THAT(stated.out, HasSubstr("-90.0,0.0,-90.0"));
  const auto figures = nlohmann::json::parse(contentOf(json));
  EXPECT_LT(figures.at("rpe_trans_rmse_m").get<double>(), 1e-6);
  EXPECT_EQ("stated", figures.at("truth_rotation"));
  for (const char* wrong : {"90,0", "a,0,0", "1,2,3,4"}) {
    EXPECT_EQ(2, run(optical, robot, std::string("--truth-rotation ") + wrong).status) << wrong;
  }
}

TEST_F(TrajectoryCommandTest, KittiPosesPairRowByRow) {
  const auto result =
      run(file("truth.txt", kittiFile(30, 1.0)), file("estimate.txt", kittiFile(25, 1.0)));
  EXPECT_EQ(0, result.status) << result.error;
  EXPECT_THAT(result.out, HasSubstr("25 of 25"));
}

TEST_F(TrajectoryCommandTest, InconsistentFilesAreOneLine) {
  const auto tum = file("a.tum", tumFile(0.0, 0.0));
  const auto late = file("late.tum", tumFile(0.0, 1000.0));
  const auto kitti = file("a.txt", kittiFile(30, 1.0));
  const auto empty = file("empty.tum", "# nothing\n");
  const auto not_a_number = file("nan.tum", "0 nan 0 0 0 0 0 1\n");
  const auto odd = file("odd.tum", "1 2 3\n");
  const std::vector<std::tuple<std::string, std::string, std::string>> cases = {
      {tum, late, "no estimated pose has a true pose within"},
      {kitti, tum, "KITTI poses have no times"},
      {tum, kitti, "KITTI poses have no times"},
      {tum, empty, "contains no poses"},
      {empty, tum, "contains no poses"},
      {tum, not_a_number, "nan.tum:1"},
      {tum, odd, "3 columns"},
      {tum, folder_ / "none.tum", "cannot be opened"}};
  for (const auto& [truth, estimate, reason] : cases) {
    const auto result = run(truth, estimate);
    EXPECT_EQ(1, result.status) << reason;
    EXPECT_THAT(result.error, HasSubstr(reason));
    EXPECT_EQ(1, std::count(result.error.begin(), result.error.end(), '\n')) << result.error;
  }
}

TEST_F(TrajectoryCommandTest, UsageErrorsHaveStatusTwo) {
  const auto tum = file("a.tum", tumFile(0.0, 0.0));
  EXPECT_EQ(2, runEval("").status);
  EXPECT_EQ(2, runEval("nonsense").status);
  EXPECT_EQ(2, runEval("trajectory --truth " + tum).status);
  EXPECT_EQ(2, run(tum, tum, "--align nonsense").status);
  EXPECT_EQ(2, run(tum, tum, "--format nonsense").status);
  EXPECT_EQ(2, run(tum, tum, "--segments 10,x").status);
  EXPECT_EQ(2, run(tum, tum, "--plot picture.jpg").status);
}

TEST_F(TrajectoryCommandTest, UnwritableOutputIsNamed) {
  const auto tum = file("a.tum", tumFile(0.0, 0.0));
  const auto result = run(tum, tum, "--json " + std::string(folder_ / "none") + "/e.json");
  EXPECT_EQ(1, result.status);
  EXPECT_THAT(result.error, HasSubstr("e.json: cannot be written"));
}

TEST_F(TrajectoryCommandTest, ReadsTheTruthOfARawlog) {
  const std::string rawlogs = HEADWAY_SOURCE_DIR "/rawlogs/";
  const std::string json = folder_ / "e.json";
  const auto result =
      run(rawlogs + "street.rawlog", rawlogs + "street.truth/trajectory.tum", "--json " + json);
  ASSERT_EQ(0, result.status) << result.error;
  const auto figures = nlohmann::json::parse(contentOf(json));
  EXPECT_EQ(figures.at("frames"), figures.at("frames_matched"));
  EXPECT_LT(figures.at("ate_max_m").get<double>(), 1e-4);
  EXPECT_LT(figures.at("rpe_rot_rmse_deg").get<double>(), 1e-2);
  EXPECT_EQ(1, run(rawlogs + "street.rawlog", file("k.txt", kittiFile(30, 1.0))).status);
}

TEST_F(TrajectoryCommandTest, RealTruthAgainstItselfHasNoError) {
  HEADWAY_REQUIRE_DATA(data);
  const std::string poses = data / "kitti_poses/07.txt";
  const std::string json = folder_ / "e.json";
  EXPECT_EQ(0, run(poses, poses, "--json " + json).status);
  const auto figures = nlohmann::json::parse(contentOf(json));
  EXPECT_NEAR(694.7, figures.at("path_m").get<double>(), 0.1);
  EXPECT_NEAR(0.0, figures.at("kitti_trans_percent").get<double>(), 1e-3);
}

}  // namespace
}  // namespace headway::eval
