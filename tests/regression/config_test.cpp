// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway_test/paths.h>

#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "replay_run.h"

namespace headway {
namespace {

const std::string kUserKeys = std::string(HEADWAY_SOURCE_DIR) + "/config/headway.ini";
const std::string kExpertKeys = std::string(HEADWAY_SOURCE_DIR) + "/config/expert.ini";

std::string dumped(const std::string& options) {
  const auto dump = test::runProcess(test::program("headway-replay") + " --dump-config " + options);
  EXPECT_EQ(0, dump.status) << dump.output;
  return dump.output;
}

TEST(ConfigTest, ShippedFilesEqualTheReplaysOutput) {
  EXPECT_TRUE(test::contentsOf(kUserKeys) == dumped(""))
      << "config/headway.ini is made by: headway-replay --dump-config > config/headway.ini";
  EXPECT_TRUE(test::contentsOf(kUserKeys) + test::contentsOf(kExpertKeys) == dumped("--expert"))
      << "config/expert.ini is what headway-replay --dump-config --expert prints after "
         "config/headway.ini";
}

TEST(ConfigTest, ShippedFilesLoadAndChangeNothing) {
  EXPECT_TRUE(dumped("--expert") == dumped("--expert -c " + kUserKeys + " -c " + kExpertKeys));
}

TEST(ConfigTest, PresetsLoadAndChangeSomething) {
  const std::filesystem::path presets = std::string(HEADWAY_SOURCE_DIR) + "/config/presets";
  std::size_t files = 0;
  for (const auto& preset : std::filesystem::directory_iterator(presets)) {
    EXPECT_FALSE(dumped("--expert") == dumped("--expert -c " + preset.path().string()))
        << preset.path();
    ++files;
  }
  EXPECT_GE(files, 1u);
}

TEST(ConfigTest, AUserFacesAboutThirtyKeys) {
  const std::string text = test::contentsOf(kUserKeys);
  std::size_t keys = 0;
  for (std::size_t at = text.find(" = "); at != std::string::npos; at = text.find(" = ", at + 1)) {
    ++keys;
  }
  EXPECT_GE(keys, 25u);
  EXPECT_LE(keys, 36u);
}

/// The parameters of the pipeline are tested in parameter_ends_test.cpp.
TEST(ConfigTest, CheckpointsAtBothEndsOfTheirRangeRun) {
  for (const char* interval : {"0", "3600"}) {
    const test::TemporaryFolder folder;
    const auto run = test::replay(
        std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/street.rawlog", folder / "out",
        "--snapshots 0 --to-index 3 --set output.checkpoint_s=" + std::string(interval));
    EXPECT_EQ(0, run.process.status) << run.process.output;
    EXPECT_EQ(4, run.summary.at("frames")) << interval;
  }
}

TEST(ConfigTest, TheThemeIsThatOfTheSnapshots) {
  const std::string street = std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/street.rawlog";
  const test::TemporaryFolder folder;
  const auto brightness = [&](const std::string& theme) {
    const auto run = test::replay(street, folder / theme,
                                  "-q --to-index 1 --detector none --snapshots 1 --theme " + theme);
    EXPECT_EQ(0, run.process.status) << run.process.output;
    for (const auto& file : std::filesystem::directory_iterator(run.file("snapshots"))) {
      return cv::mean(cv::imread(file.path().string(), cv::IMREAD_GRAYSCALE))[0];
    }
    return 0.0;
  };
  EXPECT_GT(brightness("light"), brightness("dark") + 60.0);
  EXPECT_EQ(2, test::replay(street, folder / "out", "--theme grey").process.status);
}

TEST(ConfigTest, EveryProgramHasHelpAndVersion) {
  for (const char* name : {"headway-import", "headway-export", "headway-replay", "headway-render",
                           "headway-sim", "headway-eval"}) {
    EXPECT_EQ(0, test::runProcess(test::program(name) + " --help").status) << name;
    EXPECT_EQ(0, test::runProcess(test::program(name) + " --version").status) << name;
    EXPECT_EQ(2, test::runProcess(test::program(name) + " --no-such-option").status) << name;
  }
}

}  // namespace
}  // namespace headway
