#include <gtest/gtest.h>
#include <headway_test/paths.h>

#include "replay_run.h"

namespace headway {
namespace {

TEST(ConfigTest, theShippedConfigurationIsWhatTheReplayRunsWith) {
  const std::string shipped = std::string(HEADWAY_SOURCE_DIR) + "/config/headway.ini";
  const auto defaults = test::runProcess(test::program("headway-replay") + " --dump-config");
  ASSERT_EQ(0, defaults.status);
  EXPECT_TRUE(test::contentsOf(shipped) == defaults.output)
      << "config/headway.ini is made by: headway-replay --dump-config > config/headway.ini";
  const auto loaded =
      test::runProcess(test::program("headway-replay") + " --dump-config -c " + shipped);
  EXPECT_TRUE(defaults.output == loaded.output);
}

TEST(ConfigTest, everyProgramKnowsHelpAndVersion) {
  for (const char* name : {"headway-import", "headway-export", "headway-replay", "headway-render",
                           "headway-sim", "headway-eval"}) {
    EXPECT_EQ(0, test::runProcess(test::program(name) + " --help").status) << name;
    EXPECT_EQ(0, test::runProcess(test::program(name) + " --version").status) << name;
    EXPECT_EQ(2, test::runProcess(test::program(name) + " --no-such-option").status) << name;
  }
}

}  // namespace
}  // namespace headway
