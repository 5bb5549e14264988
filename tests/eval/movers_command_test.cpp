// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <iomanip>
#include <nlohmann/json.hpp>

#include "run_program.h"

namespace headway::eval {
namespace {

using testing::HasSubstr;

constexpr int kFrames = 20;

/// A standing camera, a car that drives away at 5 m/s from 15 m ahead, and a replay that finds it
/// in every second frame and takes a place beside it for a moving person.
class MoversCommandTest : public testing::Test {
 protected:
  void SetUp() override {
    const std::string header =
        "frame,time,track_id,class,status,moving,x,y,z,yaw,length,width,height,vx,vy,vz,var_x,"
        "var_y,cov_xy\n";
    std::ostringstream labels, poses, online, tracks;
    for (int k = 0; k < kFrames; ++k) {
      const double z = 15.0 + 0.5 * k;
      labels << k << " 3 Car 0 1 0 500 100 600 160 1.5 1.6 4.0 0 1.75 " << z << " -1.5708\n";
      poses << "1 0 0 0 0 1 0 0 0 0 1 0\n";
      online << std::fixed << std::setprecision(6) << 0.1 * k << " 0 0 0 0 0 0 1\n";
      const auto row = [&](int id, const char* name, double x, double y, double vx) {
        tracks << k << "," << 0.1 * k << "," << id << "," << name << ",confirmed,1," << x << ","
               << y << ",-1,0,4,1.6,1.5," << vx << ",0,0,0.1,0.1,0\n";
      };
      if (k % 2 == 0) row(1, "Car", z + 0.5, 0.0, 5.0);
      if (k < 4) row(2, "Pedestrian", 9.0, 3.0, 1.5);
    }
    file("label.txt", labels.str());
    file("poses.txt", poses.str());
    file("out/trajectory_kitti.txt", poses.str());
    file("out/trajectory_online.tum", online.str());
    file("out/tracks.csv", header + tracks.str());
    file("out/tracks_smoothed.csv", header + tracks.str());
    file("out/replay.json", R"({"options": {"from_index": null}})");
    file("out/calibration.yaml",
         "image_size: [1242, 375]\nleft: [721.5, 721.5, 609.6, 172.9]\nbaseline_m: 0.54\n");
  }

  std::string file(const std::string& name, const std::string& content) {
    const auto path = folder_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << content;
    return path;
  }
  ProgramRun run(const std::string& more = "") {
    return runEval("movers --truth " + at("label.txt") + " --poses " + at("poses.txt") +
                   " --estimate " + at("out") + " " + more);
  }
  std::string at(const std::string& name) { return folder_ / name; }

  test::TemporaryFolder folder_;
};

TEST_F(MoversCommandTest, GivesTheDocumentedKeys) {
  const auto result = run("--json " + at("m.json") + " --plot " + at("m.png"));
  ASSERT_EQ(0, result.status) << result.error;
  EXPECT_THAT(result.out, HasSubstr("track 2 (Pedestrian), frames 0 to 3: 4 of 4 moving rows"));
  const auto figures = nlohmann::json::parse(contentOf(at("m.json")));
  EXPECT_EQ(kFrames, figures.at("frames"));
  EXPECT_NEAR(0.5, figures.at("all").at("recall").get<double>(), 1e-9);
  EXPECT_NEAR(10.0 / 14.0, figures.at("all").at("precision").get<double>(), 1e-9);
  EXPECT_NEAR(1.0, figures.at("classes").at("Car").at("precision_as_class").get<double>(), 1e-9);
  EXPECT_NEAR(0.0, figures.at("classes").at("Pedestrian").at("precision").get<double>(), 1e-9);
  EXPECT_EQ(20, figures.at("occlusion").at("1").at("labels"));
  EXPECT_EQ(2, figures.at("moving_tracks"));
  EXPECT_NEAR(5.0, figures.at("false_tracks_per_100_frames").get<double>(), 1e-9);
  EXPECT_EQ(1, figures.at("tracks")[0].at("id"));
  for (const char* motion : {"motion", "motion_velocity", "motion_smoothed"}) {
    EXPECT_EQ(0, figures[motion].at("frames")) << motion;  // never found in two successive frames
    EXPECT_TRUE(figures[motion].at("translation_rmse_m").is_null());
  }
  EXPECT_TRUE(figures.contains("with_coasting"));
  EXPECT_THAT(contentOf(at("m.png")), testing::StartsWith("\x89PNG"));
}

TEST_F(MoversCommandTest, OnlyTheFramesOfTheReplayAreEvaluated) {
  file("out/replay.json", R"({"options": {"from_index": 4}})");
  file("out/trajectory_kitti.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0\n");
  ASSERT_EQ(0, run("-q --json " + at("m.json")).status);
  const auto figures = nlohmann::json::parse(contentOf(at("m.json")));
  EXPECT_EQ(2, figures.at("frames"));
  EXPECT_EQ(0, figures.at("false_tracks"));
}

TEST_F(MoversCommandTest, ErrorsNameTheFile) {
  std::filesystem::remove(at("out/replay.json"));
  EXPECT_THAT(run().error, HasSubstr("replay.json: cannot be opened; is this the folder"));
  SetUp();
  file("out/trajectory_online.tum", "0 0 0 0 0 0 0 1\n");
  const auto result = run();
  EXPECT_EQ(1, result.status);
  EXPECT_THAT(result.error, HasSubstr("trajectory_online.tum: contains no pose of time 0.1"));
  SetUp();
  file("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_THAT(run().error, HasSubstr("only 1 poses are given"));
  EXPECT_EQ(2, runEval("movers --truth x").status);
  EXPECT_EQ(0, runEval("movers --help").status);
}

}  // namespace
}  // namespace headway::eval
