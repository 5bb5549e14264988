// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "run_program.h"

namespace headway::eval {
namespace {

using testing::HasSubstr;

/// A car ahead of a still camera that drives away at 5 m/s, from z = 10 m.
std::string labels(int frames) {
  std::ostringstream rows;
  for (int k = 0; k < frames; ++k) {
    rows << k << " 3 Car 0 0 0 100 100 200 160 1.5 1.6 4.0 2 1.6 " << 10 + 0.5 * k << " -1.57\n";
  }
  return rows.str();
}

std::string kittiPoses(int frames) {
  std::string rows;
  for (int k = 0; k < frames; ++k) rows += "1 0 0 0 0 1 0 0 0 0 1 0\n";
  return rows;
}

std::string tumPoses(int frames) {
  std::ostringstream rows;
  for (int k = 0; k < frames; ++k) rows << 50 + 0.1 * k << " 0 0 0 0 0 0 1\n";
  return rows.str();
}

/// The car's true future, shifted by `lateral` metres to the left, predicted at one frame.
std::string predictionRows(int frame, double lateral, int horizons = 30) {
  std::ostringstream rows;
  for (int j = 1; j <= horizons; ++j) {
    rows << frame << "," << 50 + 0.1 * frame << ",9,Car,0,1," << 0.1 * j << ","
         << 10 + 0.5 * (frame + j) << "," << -2 + lateral << ",-0.8,1,0,1\n";
  }
  return rows.str();
}

constexpr char kHeader[] =
    "frame,time,track_id,class,mode,probability,horizon_s,x,y,z,cov_xx,cov_xy,cov_yy\n";

class PredictionsCommandTest : public testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& content) {
    const auto path = folder_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << content;
    return path;
  }
  ProgramRun run(const std::string& truth, const std::string& poses, const std::string& more) {
    return runEval("predictions --truth " + truth + " --poses " + poses + " " + more);
  }
  test::TemporaryFolder folder_;
};

TEST_F(PredictionsCommandTest, AReplaysPredictionsInTheMap) {
  const auto truth = file("a.txt", labels(80));
  const auto estimate = file("p.csv", kHeader + predictionRows(20, 0.5) + predictionRows(21, 0.5) +
                                          predictionRows(70, 0.5) + predictionRows(22, 5.0));
  for (const auto& poses : {file("k.txt", kittiPoses(80)), file("t.tum", tumPoses(80))}) {
    const std::string out = folder_ / "p.json";
    const auto result = run(truth, poses,
                            "--estimate " + estimate + " -w --json " + out + " --plot " +
                                std::string(folder_ / "p.png"));
    EXPECT_EQ(0, result.status) << result.error;
    const auto figures = nlohmann::json::parse(contentOf(out));
    EXPECT_EQ(2, figures.at("Car").at("cases"));
    EXPECT_NEAR(0.5, figures.at("Car").at("ade_m").get<double>(), 1e-6);
    EXPECT_NEAR(0.25, figures.at("all").at("nees").get<double>(), 1e-6);
    EXPECT_EQ(2, figures.at("sequences").at("a").at("all").at("cases"));
    EXPECT_THAT(result.out,
                HasSubstr("1 predictions were not evaluated: the truth ends within 3 s"));
    EXPECT_THAT(result.out, HasSubstr("1 predictions were not evaluated: no object"));
    EXPECT_THAT(contentOf(folder_ / "p.png"), testing::StartsWith("\x89PNG"));
  }
}

TEST_F(PredictionsCommandTest, PredictorsOnExactHistories) {
  file("l/0001.txt", labels(60));
  file("l/0002.txt", labels(55));
  file("p/0001.txt", kittiPoses(60));
  file("p/0002.txt", kittiPoses(55));
  const std::string out = folder_ / "p.json";
  const auto one = run(folder_ / "l", folder_ / "p", "--predictor constant_velocity --json " + out);
  EXPECT_EQ(0, one.status) << one.error;
  auto figures = nlohmann::json::parse(contentOf(out));
  EXPECT_EQ(15, figures.at("all").at("cases"));
  EXPECT_EQ(5, figures.at("sequences").at("0002").at("Car").at("cases"));
  EXPECT_NEAR(0.0, figures.at("all").at("ade_m").get<double>(), 1e-6);
  const auto all = run(folder_ / "l", folder_ / "p", "--predictor all -w --json " + out);
  EXPECT_EQ(0, all.status) << all.error;
  figures = nlohmann::json::parse(contentOf(out));
  EXPECT_EQ(15, figures.at("predictors").at("paper").at("all").at("cases"));
  EXPECT_EQ(15, figures.at("predictors").at("constant_velocity").at("Car").at("cases"));
  EXPECT_THAT(all.out, HasSubstr("ADE / FDE in m by sequence"));
}

TEST_F(PredictionsCommandTest, CoverageBySequenceClassSpeedAndRange) {
  const auto truth = file("a.txt", labels(80));
  // The car drives at 5 m/s from a range of 20.6 m.
  const auto estimate = file("p.csv", kHeader + predictionRows(20, 0.5) + predictionRows(30, 1.9) +
                                          predictionRows(40, -0.5));
  const std::string out = folder_ / "p.json";
  const auto result = run(truth, file("k.txt", kittiPoses(80)),
                          "--coverage --estimate " + estimate + " --json " + out);
  EXPECT_EQ(0, result.status) << result.error;
  EXPECT_THAT(result.out, HasSubstr("| sequence a "));
  EXPECT_THAT(result.out, HasSubstr("| Car, 4.0 to 8.0 m/s "));
  const auto groups = nlohmann::json::parse(contentOf(out)).at("groups");
  EXPECT_EQ(3, groups.at("Car, 4.0 to 8.0 m/s").at("cases"));
  EXPECT_EQ(2, groups.at("Car, 20.0 to 30.0 m").at("cases"));
  EXPECT_EQ(1, groups.at("Car, 30.0 to 50.0 m").at("cases"));
  EXPECT_EQ(3, groups.at("Car, straight on").at("cases"));
}

TEST_F(PredictionsCommandTest, CoverageOfWhoStandsAndWhoTurns) {
  std::ostringstream rows;  // one stands, one walks ahead and, from frame 40 on, to the right
  for (int k = 0; k < 80; ++k) {
    const std::string person = " Pedestrian 0 0 0 100 100 200 160 1.7 0.6 0.6 ";
    rows << k << " 4" << person << "-1 1.6 10 0\n"
         << k << " 5" << person << 1 + 0.1 * std::max(0, k - 40) << " 1.6 "
         << 10 + 0.1 * std::min(40, k) << " 0\n";
  }
  const std::string out = folder_ / "p.json";
  const auto result = run(file("a.txt", rows.str()), file("k.txt", kittiPoses(80)),
                          "--predictor constant_velocity --json " + out);
  EXPECT_EQ(0, result.status) << result.error;
  const auto groups = nlohmann::json::parse(contentOf(out)).at("groups");
  EXPECT_EQ(30, groups.at("Pedestrian, stands").at("cases"));
  EXPECT_EQ(7, groups.at("Pedestrian, turns").at("cases")) << "frames 37 to 43";
  EXPECT_EQ(23, groups.at("Pedestrian, straight on").at("cases"));
}

TEST_F(PredictionsCommandTest, FileErrorsAreOneLine) {
  const auto truth = file("a.txt", labels(80));
  const auto poses = file("k.txt", kittiPoses(80));
  const auto good = file("good.csv", kHeader + predictionRows(20, 0.5));
  const auto at_other_times = file("late.tum", "0 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n");
  const std::vector<std::tuple<std::string, std::string, std::string, std::string>> cases = {
      {truth, poses, "--estimate " + file("short.csv", kHeader + predictionRows(20, 0.5, 29)),
       "frame 20, track 9, mode 0 has 29 horizons"},
      {truth, poses, "--estimate " + file("far.csv", kHeader + predictionRows(20, 9.0)),
       "nothing to evaluate"},
      {truth, poses, "--estimate " + file("empty.csv", ""), "empty.csv"},
      {truth, file("few.txt", kittiPoses(3)), "--predictor paper", "only 3 poses are given"},
      {truth, at_other_times, "--estimate " + good, "row 20 is not the pose of frame 20"},
      {file("brief.txt", labels(40)), poses, "--predictor paper", "nothing to evaluate"},
      {folder_ / "none", poses, "--predictor paper", "no such file or folder"}};
  for (const auto& [labels_file, poses_file, more, reason] : cases) {
    const auto result = run(labels_file, poses_file, more);
    EXPECT_EQ(1, result.status) << reason;
    EXPECT_THAT(result.error, HasSubstr(reason));
    EXPECT_EQ(1, std::count(result.error.begin(), result.error.end(), '\n')) << result.error;
  }
}

TEST_F(PredictionsCommandTest, UsageErrorsHaveStatusTwo) {
  const auto truth = file("a.txt", labels(80));
  const auto poses = file("k.txt", kittiPoses(80));
  EXPECT_EQ(2, run(truth, poses, "").status);
  EXPECT_EQ(2, run(truth, poses, "--predictor paper --estimate x.csv").status);
  EXPECT_EQ(2, run(truth, poses, "--predictor crystal_ball").status);
}

TEST_F(PredictionsCommandTest, ParametersOfPredictorsCanBeSet) {
  const auto truth = file("a.txt", labels(80));
  const auto poses = file("k.txt", kittiPoses(80));
  EXPECT_EQ(1, run(truth, poses, "--predictor paper --set objects.no_such_key=1").status);
  const auto dump = run(truth, poses, "--predictor paper --dump-config");
  EXPECT_EQ(0, dump.status);
  EXPECT_THAT(dump.out, HasSubstr("[objects]"));
}

TEST_F(PredictionsCommandTest, RealSequencesHaveTheKnownCases) {
  HEADWAY_REQUIRE_DATA(data);
  const std::string out = folder_ / "p.json";
  const auto training = data / "kitti_tracking/training";
  EXPECT_EQ(0, run(training / "label_02", training / "pose_orbslam3",
                   "--predictor constant_velocity --json " + out)
                   .status);
  const auto figures = nlohmann::json::parse(contentOf(out));
  EXPECT_EQ(9849, figures.at("all").at("cases"));
  EXPECT_EQ(5925, figures.at("Car").at("cases"));
  EXPECT_EQ(2093, figures.at("Pedestrian").at("cases"));
  EXPECT_EQ(19u, figures.at("sequences").size());
}

}  // namespace
}  // namespace headway::eval
