// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <iomanip>
#include <nlohmann/json.hpp>

#include "run_program.h"

namespace headway::eval {
namespace {

using testing::HasSubstr;

constexpr int kPeopleFrames = 20;

/// A robot that drives at 1 m/s behind a walker 2 m ahead, in a map that is turned by 90 degrees
/// against the true one, and a replay that finds the walker in every second frame.
class PeopleCommandTest : public testing::Test {
 protected:
  void SetUp() override {
    const std::string header =
        "frame,time,track_id,class,status,moving,x,y,z,yaw,length,width,height,vx,vy,vz,var_x,"
        "var_y,cov_xy";
    std::ostringstream truth, objects, online, kitti, tracks;
    truth << std::fixed << std::setprecision(6);
    online << std::fixed << std::setprecision(6);
    for (int k = 0; k < kPeopleFrames; ++k) {
      const double time = 0.1 * k, x = 0.1 * k;
      truth << time << " " << x << " 0 0 0 0 0 1\n";
      online << time << " 0 " << x << " 0 0 0 0.70710678 0.70710678\n";
      kitti << "1 0 0 0 0 1 0 0 0 0 1 0\n";
      objects << k << "," << time << ",1,Pedestrian,confirmed,1," << x + 2.0
              << ",0,0,0,0.8,0.6,1.7,1,0,0,0,0,0,1\n";
      if (k % 2 == 0) {
        tracks << k << "," << time << ",7,Pedestrian,confirmed,1,0," << x + 2.2
               << ",0,0,0.8,0.6,1.7,0,1,0,0.1,0.1,0\n";
      }
    }
    file("w.truth/trajectory.tum", truth.str());
    file("w.truth/objects.csv", header + ",visible\n" + objects.str());
    file("out/trajectory_online.tum", online.str());
    file("out/trajectory_kitti.txt", kitti.str());
    file("out/tracks.csv", header + "\n" + tracks.str());
    file("out/replay.json", R"({"options": {"from_index": null}, "rig": {"people_to_m": 5.0}})");
    file("out/calibration.yaml",
         "image_size: [1242, 375]\nleft: [721.5, 721.5, 609.6, 172.9]\nbaseline_m: 0.54\n");
  }

  void file(const std::string& name, const std::string& content) {
    const auto path = folder_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << content;
  }
  ProgramRun run(const std::string& more = "") {
    return runEval("people " + at("out") + " --truth " + at("w.truth") + " " + more);
  }
  std::string at(const std::string& name) { return folder_ / name; }

  test::TemporaryFolder folder_;
};

TEST_F(PeopleCommandTest, GivesTheDocumentedKeys) {
  const auto result = run("--json " + at("p.json") + " --plot " + at("p.png"));
  ASSERT_EQ(0, result.status) << result.error;
  EXPECT_THAT(result.out, HasSubstr("walking, 1.5-3 m"));
  EXPECT_THAT(result.out, HasSubstr("10 confirmed rows in 20 frames, 0 false (0.0 %)"));
  EXPECT_THAT(contentOf(at("p.png")), testing::StartsWith("\x89PNG"));
  const auto figures = nlohmann::json::parse(contentOf(at("p.json")));
  const auto& walking = figures.at("walking").at("1.5-3");
  EXPECT_EQ(16, walking.at("person_frames"));
  EXPECT_EQ(8, walking.at("found"));
  EXPECT_NEAR(0.28, walking.at("interval_95")[0].get<double>(), 1e-3);
  EXPECT_EQ(1.0, walking.at("as_person_ratio"));
  EXPECT_TRUE(figures.at("standing").empty());
  EXPECT_EQ(5.0, figures.at("reach_m"));
  EXPECT_EQ(1, figures.at("moving_tracks"));
  EXPECT_TRUE(figures.at("false_moving_tracks").empty());
  EXPECT_EQ(1.0, figures.at("person_rows_right_ratio"));
}

TEST_F(PeopleCommandTest, CountsPeopleUpToTheReachAlone) {
  ASSERT_EQ(0, run("-q --reach 1.9 --json " + at("p.json")).status);
  const auto figures = nlohmann::json::parse(contentOf(at("p.json")));
  EXPECT_EQ(0, figures.at("all").at("person_frames"));
  EXPECT_TRUE(figures.at("all").at("found_ratio").is_null());
}

TEST_F(PeopleCommandTest, CountsThePeopleOfFramesInWhichTheCameraWasLost) {
  std::string online = contentOf(at("out/trajectory_online.tum"));
  const auto tenth = online.find("\n1.0") + 1;
  online.erase(tenth, online.find('\n', tenth) + 1 - tenth);
  file("out/trajectory_online.tum", online);
  const auto result = run("--json " + at("p.json"));
  ASSERT_EQ(0, result.status) << result.error;
  EXPECT_THAT(result.out, HasSubstr("9 confirmed rows in 20 frames"));
  EXPECT_THAT(result.out, HasSubstr("1 left out: the camera was lost"));
  const auto figures = nlohmann::json::parse(contentOf(at("p.json")));
  EXPECT_EQ(1, figures.at("rows_without_pose"));
  EXPECT_EQ(16, figures.at("walking").at("1.5-3").at("person_frames"));
  EXPECT_EQ(7, figures.at("walking").at("1.5-3").at("found"));
}

TEST_F(PeopleCommandTest, NamesWhatIsMissing) {
  file("w.truth/trajectory.tum", "0.0 0 0 0 0 0 0 1\n");
  EXPECT_THAT(run().error, HasSubstr("is it the truth of the replay's rawlog?"));
  file("out/replay.json", "{}");
  EXPECT_THAT(run().error, HasSubstr("states no reach of its rig for people"));
  std::filesystem::remove(folder_ / "out/replay.json");
  EXPECT_THAT(run().error, HasSubstr("is this the folder of a replay?"));
  EXPECT_EQ(2, runEval("people --truth x").status);
}

}  // namespace
}  // namespace headway::eval
