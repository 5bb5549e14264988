// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "simulated_drive.h"

namespace headway::eval {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class DenseCommandTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { drive_ = std::make_unique<SimulatedDrive>(16, "--detector none"); }
  static void TearDownTestSuite() { drive_.reset(); }

  static std::string at(const std::string& name) { return drive_->at(name); }
  static ProgramRun dense(const std::string& truth, const std::string& estimate,
                          const std::string& more = "") {
    return runEval("dense --truth " + truth + " --estimate " + estimate + " " + more);
  }
  /// A copy of the replay that a test may spoil.
  [[nodiscard]] std::string copyOfReplay() const {
    fs::create_directories(folder_ / "out");
    for (const char* name : {"map_dense.ply", "map.headway", "replay.json", "calibration.yaml"}) {
      fs::copy(fs::path(at("out")) / name, folder_ / "out");
    }
    return folder_ / "out";
  }

  static std::unique_ptr<SimulatedDrive> drive_;
  test::TemporaryFolder folder_;
};

std::unique_ptr<SimulatedDrive> DenseCommandTest::drive_;

TEST_F(DenseCommandTest, WritesTableJsonAndPicture) {
  const std::string json = folder_ / "d.json";
  const std::string plot = folder_ / "d.png";
  const auto result = dense(at("w.truth"), at("out"),
                            "--rawlog " + at("w.rawlog") + " --json " + json + " --plot " + plot);
  ASSERT_EQ(0, result.status) << result.error;
  EXPECT_THAT(result.out, HasSubstr("points where only moving objects were"));
  EXPECT_THAT(contentOf(plot), testing::StartsWith("\x89PNG"));
  const auto figures = nlohmann::json::parse(contentOf(json));
  EXPECT_GT(figures.at("points"), 1000);
  EXPECT_LT(figures.at("median_m"), 0.1);
  EXPECT_GT(figures.at("within_bar_ratio"), 0.5);
  const auto& coverage = figures.at("coverage");
  EXPECT_GT(coverage.at("surface"), 10000);
  EXPECT_GT(coverage.at("ratio"), 0.05);
  EXPECT_GT(coverage.at("matchable_covered_ratio"), coverage.at("ratio"))
      << "what stereo matches is covered more";
  std::size_t by_range = 0;
  for (const auto& range : figures.at("by_range"))
    by_range += range.at("surface").get<std::size_t>();
  EXPECT_EQ(coverage.at("surface"), by_range);
  EXPECT_GT(figures.at("mb_per_km"), 1.0);

  const auto again = dense(at("w.truth"), at("out"), "--json " + json);
  EXPECT_EQ(1, again.status);
  EXPECT_THAT(again.error, HasSubstr("exists already"));
}

TEST_F(DenseCommandTest, NamesWhatIsMissingOrDamaged) {
  const std::string copy = copyOfReplay();
  std::ofstream(copy + "/map_dense.ply") << "no points";
  EXPECT_THAT(dense(at("w.truth"), copy).error, HasSubstr("map_dense.ply: is not a binary PLY"));
  fs::remove(copy + "/map_dense.ply");
  EXPECT_THAT(dense(at("w.truth"), copy).error, HasSubstr("has the replay a dense map"));
  fs::copy(fs::path(at("out")) / "map_dense.ply", copy);
  std::ofstream(copy + "/replay.json") << "{}";
  EXPECT_THAT(dense(at("w.truth"), copy).error, HasSubstr("replay.json: is not the record"));

  const std::string truth = folder_ / "bare.truth";
  fs::create_directories(truth);
  for (const char* name : {"trajectory.tum", "objects.csv"}) {
    fs::copy(fs::path(at("w.truth")) / name, truth);
  }
  const auto bare = dense(truth, at("out"));
  EXPECT_EQ(1, bare.status);
  EXPECT_THAT(bare.error, HasSubstr("--depth --masks"));
}

TEST_F(DenseCommandTest, RequiresBothFolders) {
  EXPECT_EQ(2, runEval("dense --truth x").status);
  EXPECT_EQ(2, runEval("dense --estimate x").status);
}

}  // namespace
}  // namespace headway::eval
