// SPDX-License-Identifier: BSD-3-Clause
// The same bytes wherever and by whomever a program is run.
#include <gmock/gmock.h>

#include <map>

#include "plain_rawlog.h"
#include "replay_run.h"

namespace headway {
namespace {

namespace fs = std::filesystem;

/// Results without times: summary and report contain those of the run.
std::map<std::string, std::string> resultsIn(const fs::path& folder) {
  std::map<std::string, std::string> results;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().lexically_relative(folder);
    if (entry.is_directory() || name == "summary.json" || name == "report.html") continue;
    results[name] = test::contentsOf(entry.path());
  }
  return results;
}

class EnvironmentTest : public testing::Test {
 protected:
  EnvironmentTest() {
    fs::create_directories(folder_ / "a b \xC3\xA9 'q'");
    test::writePlainRawlog(rawlog_);
  }

  /// Replays in a shell; returns the results.
  [[nodiscard]] std::map<std::string, std::string> replay(const std::string& before,
                                                          const std::string& out) const {
    const auto run = test::runProcess(before + " " + test::program("headway-replay") +
                                      " -q --snapshots 0 -i \"" + rawlog_ + "\" -o \"" +
                                      (folder_ / out).string() + "\"");
    EXPECT_EQ(0, run.status) << run.output;
    return resultsIn(folder_ / out);
  }

  const test::TemporaryFolder folder_;
  const std::string rawlog_ = folder_ / "a b \xC3\xA9 'q'/in \xE2\x82\xAC.rawlog";
};

TEST_F(EnvironmentTest, LocaleTimeZoneHomeAndWorkingFolderDoNotMatter) {
  const auto usual = replay("", "usual");
  EXPECT_GT(usual.size(), 10u);
  EXPECT_EQ(usual, replay("env -i LC_ALL=de_DE.UTF-8 TZ=Pacific/Chatham", "no home"));
  EXPECT_EQ(usual, replay("env -i LC_ALL=tr_TR.UTF-8 LANG=C TZ=:nowhere HOME=/nowhere", "else"));
  EXPECT_EQ(usual, replay("cd / && umask 077 &&", "from the root"));
}

TEST_F(EnvironmentTest, PathsMayContainBlanksQuotesAndUtf8) {
  const auto usual = replay("", "usual");
  EXPECT_EQ(usual, replay("", "a b \xC3\xA9 'q'/out \xE2\x82\xAC"));
}

TEST_F(EnvironmentTest, NamesThatAreNotUtf8AreNoError) {
  const std::string out = (folder_ / "out").string();
  const std::string name = folder_ / "bad\xFF.rawlog";
  fs::rename(rawlog_, name);
  const auto run = test::replay(name, out, "-q --snapshots 0");
  EXPECT_EQ(0, run.process.status) << run.process.output;
  EXPECT_TRUE(nlohmann::json::accept(test::contentsOf(out + "/replay.json")));
}

TEST_F(EnvironmentTest, NamesReachTheTerminalWithoutEscapeSequences) {
  const auto run =
      test::runProcess(test::program("headway-replay") + " -o " + (folder_ / "out").string() +
                       " -i \"$(printf 'no\\033[31mne')\"");
  EXPECT_EQ(1, run.status);
  EXPECT_EQ(std::string::npos, run.output.find('\033'));
  EXPECT_EQ(1, std::count(run.output.begin(), run.output.end(), '\n')) << run.output;
}

}  // namespace
}  // namespace headway
