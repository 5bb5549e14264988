// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway_test/paths.h>

#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <regex>
#include <set>
#include <sstream>

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

/// The lines of a section.
std::string sectionOf(const std::string& text, const std::string& name) {
  const std::size_t begin = text.find("[" + name + "]");
  return begin == std::string::npos ? "" : text.substr(begin, text.find("\n[", begin) - begin);
}

/// Detectors that are left out in some frames blinded robots: people were found a sixth as often.
TEST(ConfigTest, ThePresetForSmallComputersLeavesOutNoDetection) {
  const std::string preset = std::string(HEADWAY_SOURCE_DIR) + "/config/presets/small_computer.ini";
  const std::string without = dumped("--expert"), with = dumped("--expert -c " + preset);
  EXPECT_NE(std::string::npos, sectionOf(with, "detect").find("period_s = 0"));
  EXPECT_EQ(sectionOf(without, "detect"), sectionOf(with, "detect"));
  EXPECT_NE(without, with);
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

/// Long names of the options that the sources of a program declare.
std::set<std::string> declaredOptions(const std::string& name) {
  static const std::regex declaration(
      R"re((option|flag)\([^,;]{1,80},\s*('.'|0),\s*"([a-z][a-z0-9-]*)")re");
  std::set<std::string> options;
  for (const auto& file :
       std::filesystem::directory_iterator(std::string(HEADWAY_SOURCE_DIR) + "/apps/" + name)) {
    if (file.path().extension() != ".cpp") continue;
    const std::string text = test::contentsOf(file.path());
    for (std::sregex_iterator at(text.begin(), text.end(), declaration), end; at != end; ++at) {
      options.insert((*at)[3]);
    }
  }
  return options;
}

/// Those that --help of a program and of its sub-commands shows, which completion and manual pages
/// are made from.
std::set<std::string> printedOptions(const std::string& call) {
  const std::string help = test::runProcess(call + " --help").output;
  std::set<std::string> options;
  std::istringstream lines(help);
  bool is_list = false;
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line[0] != ' ') is_list = line == "Sub-commands:";
    if (is_list && line.size() > 3 && line.compare(0, 2, "  ") == 0 && line[2] != ' ') {
      options.merge(printedOptions(call + " " + line.substr(2, line.find(' ', 2) - 2)));
    } else if (line.compare(0, 3, "  -") == 0 || line.compare(0, 8, "      --") == 0) {
      const auto from = line.find("--") + 2;
      options.insert(line.substr(from, line.find_first_of(" ,", from) - from));
    }
  }
  return options;
}

TEST(ConfigTest, EveryProgramPrintsTheOptionsThatItDeclares) {
  std::size_t programs = 0;
  for (const char* name : {"headway-import", "headway-export", "headway-replay", "headway-render",
                           "headway-sim", "headway-eval", "headway-nav", "headway-live"}) {
    if (!std::filesystem::exists(test::program(name))) continue;  // built on demand
    const auto declared = declaredOptions(name);
    EXPECT_FALSE(declared.empty()) << name;
    const auto printed = printedOptions(test::program(name));
    for (const std::string& option : declared) {
      EXPECT_EQ(1u, printed.count(option)) << name << " --" << option;
    }
    ++programs;
  }
  EXPECT_GE(programs, 6u);
}

}  // namespace
}  // namespace headway
