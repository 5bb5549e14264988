// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/program/files.h>
#include <headway_test/folders.h>
#include <headway_test/input_error.h>
#include <headway_test/process.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace headway::program {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

class OutputFolderTest : public testing::Test {
 protected:
  static bool isResult(const fs::path& file) { return file.extension() == ".out"; }

  OutputFolder open(bool overwrite, const std::vector<std::string>& inputs = {}) const {
    return OutputFolder(folder_, overwrite, inputs, isResult);
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      if (!entry.is_directory()) names.push_back(entry.path().lexically_relative(folder_));
    }
    return names;
  }
  void writeOldResults() const {
    fs::create_directories(folder_);
    for (const char* name : {"a.out", "stale.out", "mine.txt"}) writeFile(folder_ / name, "old");
  }
  [[nodiscard]] std::string content(const char* name) const {
    return test::contentsOf(folder_ / name);
  }

  const test::TemporaryFolder parent_;
  const fs::path folder_ = parent_ / "sub folder/out \xC3\xA9";
};

TEST_F(OutputFolderTest, ANewFolderIsWrittenInPlace) {
  {
    const auto folder = open(false);
    EXPECT_EQ(folder_, folder.path());
    writeFile(folder.path() / "a.out", "new");
  }
  EXPECT_THAT(names(), UnorderedElementsAre("a.out"));
}

TEST_F(OutputFolderTest, OldResultsRemainUntilNewOnesAreComplete) {
  writeOldResults();
  {
    auto folder = open(true);
    writeFile(folder.path() / "a.out", "new");
    EXPECT_EQ("old", content("a.out"));
    folder.publish();
    EXPECT_EQ(folder_, folder.path());
  }
  EXPECT_EQ("new", content("a.out"));
  EXPECT_THAT(names(), UnorderedElementsAre("a.out", "mine.txt"));
}

TEST_F(OutputFolderTest, WithoutPublishingTheOldResultsRemain) {
  writeOldResults();
  {
    const auto folder = open(true);
    writeFile(folder.path() / "a.out", "new");
  }
  EXPECT_THAT(names(), UnorderedElementsAre("a.out", "stale.out", "mine.txt", "unfinished/a.out"));
  EXPECT_EQ("old", content("a.out"));
  {
    auto folder = open(true);  // the unfinished results of before are discarded
    writeFile(folder.path() / "b.out", "new");
    folder.publish();
  }
  EXPECT_THAT(names(), UnorderedElementsAre("b.out", "mine.txt"));
}

TEST_F(OutputFolderTest, APublicationThatWasKilledIsCompleted) {
  writeOldResults();
  fs::create_directories(folder_ / "complete");
  writeFile(folder_ / "complete/a.out", "newer");
  { const auto folder = open(true); }
  EXPECT_EQ("newer", content("a.out"));
  EXPECT_THAT(names(), UnorderedElementsAre("a.out", "mine.txt"));
}

TEST_F(OutputFolderTest, AFolderWithContentsRequiresOverwrite) {
  writeOldResults();
  EXPECT_THAT(test::inputErrorOf([&] { (void)open(false); }), HasSubstr("-w overwrites"));
  EXPECT_THAT(names(), UnorderedElementsAre("a.out", "stale.out", "mine.txt"));
}

TEST_F(OutputFolderTest, AnInputIsNeverAResult) {
  writeOldResults();
  writeFile(parent_ / "a.out", "of another folder");
  EXPECT_NO_THROW((void)open(
      true, {(folder_ / "mine.txt").string(), "nowhere/a.out", (parent_ / "a.out").string()}));
  fs::create_symlink(folder_ / "a.out", parent_ / "link");
  fs::create_directory_symlink(folder_, parent_ / "linked folder");
  for (const fs::path& input : {folder_ / "a.out", folder_ / "../out \xC3\xA9/a.out",
                                parent_ / "link", parent_ / "linked folder/stale.out"}) {
    EXPECT_THAT(test::inputErrorOf([&] {
                  (void)open(true, {"", input.string()});
                }),
                HasSubstr("is an input"))
        << input;
  }
  EXPECT_THAT(names(), UnorderedElementsAre("a.out", "stale.out", "mine.txt"));
}

TEST_F(OutputFolderTest, AFolderOfInputsAloneMayReceiveResults) {
  fs::create_directories(folder_);
  for (const char* name : {"in.rawlog", ".partial-1-XXXXXX-record.rawlog"}) {
    writeFile(folder_ / name, "read");
  }
  EXPECT_THROW((void)open(false), InputError);
  const auto folder = open(false, {(folder_ / "in.rawlog").string()});
  EXPECT_EQ(folder_, folder.path());
}

TEST_F(OutputFolderTest, ASecondProcessIsRefusedAndAKilledOneIsNot) {
  int ready[2];
  ASSERT_EQ(0, pipe(ready));
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const auto folder = open(false);
    (void)!write(ready[1], "x", 1);
    while (true) pause();
  }
  char byte = 0;
  ASSERT_EQ(1, read(ready[0], &byte, 1));
  EXPECT_THAT(test::inputErrorOf([&] { (void)open(true); }),
              HasSubstr("process " + std::to_string(child)));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(fs::exists(folder_ / ".lock"));
  EXPECT_NO_THROW((void)open(false));
  EXPECT_FALSE(fs::exists(folder_ / ".lock"));
}

}  // namespace
}  // namespace headway::program
