// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway_test/folders.h>
#include <headway_test/paths.h>
#include <mrpt/config/CConfigFileMemory.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "embedding_example.cpp"  // NOLINT: what the document shows is what is tested
#include "scripted_robot.h"

namespace {

std::string textOf(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(EmbeddingTest, TheDocumentShowsTheExampleAsItCompiles) {
  const std::filesystem::path project = HEADWAY_SOURCE_DIR;
  const std::string document = textOf(project / "doc/navigation.md");
  const std::string example = textOf(project / "tests/nav/embedding_example.cpp");
  ASSERT_FALSE(example.empty());
  EXPECT_NE(document.find(example.substr(example.find("#include"))), std::string::npos);
}

TEST(EmbeddingTest, TheExampleDrivesToItsGoalWhileTheMapIsFreshAndStopsWhereItIsNot) {
  const std::string path = "/usr/share/mrpt/config_files/navigation-ptgs/reactive2d_config.ini";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there: install mrpt-common";
  const mrpt::config::CConfigFileMemory settings(textOf(path));
  const headway::test::WorkingInTemporaryFolder folder;  // the navigator writes tables where it is
  mrpt::kinematics::CVehicleSimul_DiffDriven wheels;
  headway::nav::ScriptedRobot robot(wheels);
  headway::map::SharedMap map;
  headway::map::PerceptionMap perceived;
  const auto perceive = [&](double shift_s) {
    perceived.update(mrpt::Clock::nowDouble() - shift_s, {});
    map.publish(perceived);
  };
  const auto with_map_at = [&](double shift_s) {
    return [&, shift_s] {
      wheels.simulateOneTimeStep(0.1);
      perceive(shift_s);
      return wheels.getTime() < 60.0;
    };
  };
  perceive(0.0);
  EXPECT_TRUE(driveTo({4.0, 0.0, 0.0}, robot, map, settings, with_map_at(0.0)));
  perceive(0.0);
  EXPECT_FALSE(driveTo({8.0, 0.0, 0.0}, robot, map, settings, with_map_at(5.0)));
}

}  // namespace
