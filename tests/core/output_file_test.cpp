// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/core/input_files.h>
#include <headway/core/output_file.h>
#include <headway_test/folders.h>
#include <headway_test/input_error.h>
#include <headway_test/small_disk.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>

namespace headway {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

std::string contentOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

std::vector<std::string> namesIn(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_directory()) names.push_back(entry.path().lexically_relative(folder).string());
  }
  return names;
}

/// Sets the permissions that new files lack during its lifetime.
class Umask {
 public:
  explicit Umask(mode_t mask) : before_(umask(mask)) {}
  ~Umask() { umask(before_); }

 private:
  mode_t before_;
};

/// Type and permissions of a file, links not followed.
mode_t modeOf(const fs::path& path) {
  struct stat status {};
  return lstat(path.c_str(), &status) == 0 ? status.st_mode : 0;
}

class OutputFileTest : public testing::Test {
 protected:
  const test::TemporaryFolder folder_;
  const fs::path path_ = folder_ / "a b \xC3\xA9.txt";
};

TEST_F(OutputFileTest, TheFileAppearsWhenItIsComplete) {
  OutputFile file(path_);
  file.stream() << "whole";
  EXPECT_FALSE(fs::exists(path_));
  file.commit();
  EXPECT_EQ("whole", contentOf(path_));
  EXPECT_THAT(namesIn(folder_.path()), ElementsAre(path_.filename().string()));
}

TEST_F(OutputFileTest, TheOldFileRemainsUntilThen) {
  writeFile(path_, "old");
  {
    OutputFile file(path_);
    file.stream() << "new, not committed";
  }
  EXPECT_EQ("old", contentOf(path_));
  EXPECT_THAT(namesIn(folder_.path()), ElementsAre(path_.filename().string()));
  writeFile(path_, "new");
  EXPECT_EQ("new", contentOf(path_));
}

TEST_F(OutputFileTest, IsPrivateUntilItIsComplete) {
  for (const mode_t mask : {0022, 0027, 0077, 0000}) {
    const Umask lacking(mask);
    OutputFile file(path_);
    file.stream() << "half" << std::flush;
    EXPECT_EQ(S_IFREG | 0600u, modeOf(file.temporaryPath()));
    {  // a writer that opens it by its name
      std::ofstream by_name(file.temporaryPath(), std::ios::binary);
      by_name << "whole";
    }
    EXPECT_EQ(S_IFREG | 0600u, modeOf(file.temporaryPath()));
    file.commit();
    EXPECT_EQ(S_IFREG | (0666u & ~mask), modeOf(path_)) << std::oct << mask;
  }
}

TEST_F(OutputFileTest, ALinkCannotBePlantedWhereItIsWritten) {
  writeFile(folder_ / "victim", "of another user");
  const std::string start = ".partial-" + std::to_string(getpid()) + "-";
  const fs::path planted = folder_ / (start + path_.filename().string());
  fs::create_symlink("victim", planted);
  OutputFile first(path_), second(path_);
  EXPECT_NE(planted, first.temporaryPath());
  EXPECT_NE(first.temporaryPath(), second.temporaryPath()) << "its name cannot be guessed";
  EXPECT_EQ(0u, first.temporaryPath().filename().string().rfind(start, 0));
  first.stream() << "mine";
  first.commit();
  EXPECT_EQ("of another user", contentOf(folder_ / "victim"));
  EXPECT_EQ("mine", contentOf(path_));
  EXPECT_TRUE(fs::is_symlink(planted));
  EXPECT_FALSE(fs::is_symlink(path_));
}

TEST_F(OutputFileTest, AFullDiskLeavesTheOldFile) {
  writeFile(path_, "old");
  const test::SmallDisk disk(1000);
  EXPECT_THAT(test::inputErrorOf([&] { writeFile(path_, std::string(100'000, 'x')); }),
              HasSubstr("check the disk space"));
  EXPECT_EQ("old", contentOf(path_));
  EXPECT_THAT(namesIn(folder_.path()), ElementsAre(path_.filename().string()));
}

TEST_F(OutputFileTest, DevicesAreWrittenDirectlyAndTheirErrorsReported) {
  EXPECT_THAT(test::inputErrorOf([&] { writeFile("/dev/full", "x"); }), HasSubstr("/dev/full"));
  fs::create_symlink("/dev/full", path_);
  EXPECT_THAT(test::inputErrorOf([&] { writeFile(path_, "x"); }), HasSubstr("/dev/full"));
  EXPECT_NO_THROW(writeFile("/dev/null", "x"));
}

TEST_F(OutputFileTest, ALinkIsKeptAndItsTargetReplaced) {
  writeFile(folder_ / "target", "old");
  fs::create_symlink("target", path_);
  writeFile(path_, "new");
  EXPECT_TRUE(fs::is_symlink(path_));
  EXPECT_EQ("new", contentOf(folder_ / "target"));
}

TEST_F(OutputFileTest, FoldersAndMissingFoldersAreErrors) {
  EXPECT_THAT(test::inputErrorOf([&] { OutputFile file(folder_.path()); }),
              HasSubstr("is a folder"));
  EXPECT_THAT(test::inputErrorOf([&] { OutputFile file(folder_ / "none/x"); }),
              HasSubstr("none/x: cannot be written: No such file"));
}

TEST_F(OutputFileTest, RowsReachTheSystemWhenTheyAreEnded) {
  GrowingFile file(path_);
  file.stream() << "1\n";
  file.endRows();
  EXPECT_EQ("1\n", contentOf(path_));
  file.stream() << "2\n";
  file.endRows();
  EXPECT_EQ("1\n2\n", contentOf(path_));
}

TEST_F(OutputFileTest, AKilledProgramLeavesWholeRows) {
  const std::string row = std::string(119, 'x') + "\n";
  for (int run = 0; run < 5; ++run) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      GrowingFile file(path_);
      while (true) {
        for (int i = 0; i < 100; ++i) file.stream() << row;
        file.endRows();
        usleep(500);
      }
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20 + 7 * run));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const std::string content = contentOf(path_);
    ASSERT_GT(content.size(), row.size());
    ASSERT_EQ(0u, content.size() % row.size()) << run;
  }
}

TEST_F(OutputFileTest, AFullDiskLeavesWholeRows) {
  GrowingFile file(path_);
  const test::SmallDisk disk(1000);
  for (int i = 0; i < 50; ++i) file.stream() << std::string(99, 'x') << "\n";
  EXPECT_THAT(test::inputErrorOf([&] { file.endRows(); }), HasSubstr("No space left"));
  EXPECT_EQ(1000u, contentOf(path_).size());
  file.stream() << std::string(99, 'y') << "\n";
  EXPECT_THAT(test::inputErrorOf([&] { file.close(); }), HasSubstr("too large"));
  EXPECT_EQ(1000u, contentOf(path_).size());
}

TEST_F(OutputFileTest, NothingWritesAFileThatIsRead) {
  const fs::path input = folder_ / "input";
  writeFile(input, "read");
  fs::create_symlink(input, folder_ / "link");
  registerInput(input);
  registerInput(folder_ / "nothing");
  for (const char* name : {"input", "link", "./input"}) {
    EXPECT_THAT(test::inputErrorOf([&] { OutputFile file(folder_ / name); }),
                HasSubstr("is an input"));
    EXPECT_THAT(test::inputErrorOf([&] { GrowingFile file(folder_ / name); }),
                HasSubstr("is an input"));
  }
  fs::create_directory(folder_ / "new");
  writeFile(folder_ / "new/input", "written");
  const auto isStale = [](const fs::path&) { return true; };
  EXPECT_THROW(replaceFiles(folder_ / "new", folder_.path(), isStale), InputError);
  fs::remove_all(folder_ / "new/input");
  writeFile(folder_ / "an old file", "");
  EXPECT_THROW(replaceFiles(folder_ / "new", folder_.path(), isStale), InputError) << "it is stale";
  EXPECT_TRUE(fs::exists(folder_ / "an old file")) << "removed before the error";
  EXPECT_EQ("read", contentOf(input));
  EXPECT_NO_THROW(writeFile(folder_ / "nothing", "written"));
}

TEST_F(OutputFileTest, FilesOfAFolderReplaceOthersAndStaleOnesVanish) {
  const fs::path from = folder_ / "new", to = folder_ / "old";
  fs::create_directories(from / "pictures");
  fs::create_directories(to / "pictures");
  for (const char* name : {"a", "pictures/1"}) writeFile(from / name, "new");
  for (const char* name : {"a", "b", "mine", "pictures/1", "pictures/2"})
    writeFile(to / name, "old");
  replaceFiles(from, to, [](const fs::path& file) { return file != "mine"; });
  EXPECT_THAT(namesIn(to), UnorderedElementsAre("a", "mine", "pictures/1"));
  EXPECT_EQ("new", contentOf(to / "a"));
  EXPECT_EQ("new", contentOf(to / "pictures/1"));
  EXPECT_EQ("old", contentOf(to / "mine"));
  EXPECT_FALSE(fs::exists(from));
}

}  // namespace
}  // namespace headway
