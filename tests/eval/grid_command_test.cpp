// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "simulated_drive.h"

namespace headway::eval {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class GridCommandTest : public testing::Test {
 protected:
  // Images of a third of the usual size claim to see 6 m; the whole street is compared here.
  static void SetUpTestSuite() {
    drive_ = std::make_unique<SimulatedDrive>(36, "--set grid.reach=20");
  }
  static void TearDownTestSuite() { drive_.reset(); }

  static std::string at(const std::string& name) { return drive_->at(name); }
  static ProgramRun grid(const std::string& truth, const std::string& estimate,
                         const std::string& more = "") {
    return runEval("grid --truth " + truth + " --estimate " + estimate + " " + more);
  }
  /// A copy of the replay that a test may spoil.
  [[nodiscard]] std::string copyOfReplay() const {
    fs::create_directories(folder_ / "out");
    for (const char* name : {"map_grid.gridmap.gz", "calibration.yaml"}) {
      fs::copy(fs::path(at("out")) / name, folder_ / "out");
    }
    return folder_ / "out";
  }

  static std::unique_ptr<SimulatedDrive> drive_;
  test::TemporaryFolder folder_;
};

std::unique_ptr<SimulatedDrive> GridCommandTest::drive_;

TEST_F(GridCommandTest, WritesTableJsonAndPicture) {
  const std::string json = folder_ / "g.json";
  const std::string plot = folder_ / "g.png";
  const auto result = grid(at("w.truth"), at("out"), "--json " + json + " --plot " + plot);
  ASSERT_EQ(0, result.status) << result.error;
  EXPECT_THAT(result.out, HasSubstr("of these, estimated as occupied (recall)"));
  EXPECT_THAT(contentOf(plot), testing::StartsWith("\x89PNG"));
  const auto figures = nlohmann::json::parse(contentOf(json));
  EXPECT_GT(figures.at("compared"), 2000);
  EXPECT_GE(figures.at("right_ratio"), 0.95);
  EXPECT_GT(figures.at("occupied_recall"), 0.4);
  EXPECT_GT(figures.at("occupied_precision"), 0.5);
  EXPECT_LE(figures.at("ghosts"), 3);
  const auto& touch = figures.at("touch");
  EXPECT_GE(touch.at("precision").get<double>(), touch.at("strict_precision").get<double>());
  EXPECT_GT(touch.at("precision"), 0.7);
  EXPECT_EQ(touch.at("called_occupied").get<int>(),
            touch.at("right").get<int>() + touch.at("phantoms").get<int>());
  EXPECT_EQ(figures.at("found").get<int>() + figures.at("missed").get<int>(),
            figures.at("occupied"));

  const auto again = grid(at("w.truth"), at("out"), "--json " + json);
  EXPECT_EQ(1, again.status);
  EXPECT_THAT(again.error, HasSubstr("exists already"));
}

TEST_F(GridCommandTest, NamesADamagedGrid) {
  const std::string damaged = copyOfReplay();
  std::ofstream(damaged + "/map_grid.gridmap.gz") << "no grid";
  const auto result = grid(at("w.truth"), damaged);
  EXPECT_EQ(1, result.status);
  EXPECT_THAT(result.error, HasSubstr("map_grid.gridmap.gz: is not a readable occupancy grid"));

  fs::remove(damaged + "/map_grid.gridmap.gz");
  EXPECT_THAT(grid(at("w.truth"), damaged).error,
              HasSubstr("is this the output folder of a replay?"));
  EXPECT_THAT(grid(at("w.truth"), folder_ / "none").error, HasSubstr("none"));
}

TEST_F(GridCommandTest, NamesTheOptionsForAMissingDepth) {
  const std::string truth = folder_ / "bare.truth";
  fs::create_directories(truth);
  fs::copy(fs::path(at("w.truth")) / "trajectory.tum", truth);
  const auto result = grid(truth, at("out"));
  EXPECT_EQ(1, result.status);
  EXPECT_THAT(result.error, HasSubstr("--depth --masks"));
  EXPECT_THAT(grid(folder_ / "none", at("out")).error, HasSubstr("trajectory.tum"));
}

TEST_F(GridCommandTest, ACameraOfAnotherSizeIsRefused) {
  const std::string other = copyOfReplay();
  std::string calibration = contentOf(other + "/calibration.yaml");
  const auto place = calibration.find("400");
  ASSERT_NE(std::string::npos, place);
  calibration.replace(place, 3, "404");
  std::ofstream(other + "/calibration.yaml") << calibration;
  const auto result = grid(at("w.truth"), other);
  EXPECT_EQ(1, result.status);
  EXPECT_THAT(result.error, HasSubstr("size differs"));
}

TEST_F(GridCommandTest, RequiresBothFolders) {
  EXPECT_EQ(2, runEval("grid --truth x").status);
  EXPECT_EQ(2, runEval("grid --estimate x").status);
}

}  // namespace
}  // namespace headway::eval
