// SPDX-License-Identifier: BSD-3-Clause
// Runs that are killed and continued, and runs that lack disk, descriptors, memory or permissions.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/map/map_file.h>
#include <headway_test/repeats.h>
#include <headway_test/waiting.h>
#include <sys/file.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <random>
#include <thread>

#include "plain_rawlog.h"
#include "replay_run.h"

namespace headway {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

void expectRowsAreWhole(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const auto extension = entry.path().extension();
    const bool is_log = extension == ".csv" || extension == ".tum" || extension == ".txt";
    if (!is_log || entry.path().filename().string().front() == '.') continue;
    const std::string content = test::contentsOf(entry.path());
    EXPECT_TRUE(content.empty() || content.back() == '\n') << entry.path();
  }
}

class ContinueTest : public testing::Test {
 protected:
  ContinueTest() { test::writePlainRawlog(rawlog_); }

  /// Starts a replay with many checkpoints, at 0.4 times the recorded rate (3 s), and kills it.
  void killReplay(int after_ms, const std::vector<std::string>& options = {},
                  const std::string& rate = "0.4", const fs::path& awaited = {}) const {
    std::vector<std::string> words = {test::program("headway-replay"),
                                      "-q",
                                      "--snapshots",
                                      "0",
                                      "-i",
                                      rawlog_,
                                      "-o",
                                      out_.string(),
                                      "--set",
                                      "output.checkpoint_s=0.05",
                                      "--realtime",
                                      rate};
    words.insert(words.end(), options.begin(), options.end());
    killAfter(after_ms, words, awaited);
  }

  static void killAfter(int after_ms, std::vector<std::string> words,
                        const fs::path& awaited = {}) {
    const pid_t child = fork();
    if (child == 0) {
      std::vector<char*> arguments;
      for (auto& word : words) arguments.push_back(word.data());
      arguments.push_back(nullptr);
      execv(arguments[0], arguments.data());
      _exit(99);
    }
    test::waitUntil([&] { return awaited.empty() || fs::exists(awaited); });
    std::this_thread::sleep_for(std::chrono::milliseconds(after_ms));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
  }

  /// Kills a replay as soon as it has left a checkpoint.
  void killAfterACheckpoint(const std::vector<std::string>& options = {}) const {
    killReplay(0, options, "0.4", out_ / "map.headway");
    ASSERT_TRUE(fs::exists(out_ / "map.headway"));
  }

  [[nodiscard]] test::ProcessResult goOn(const std::string& options = "") const {
    return test::runProcess(test::program("headway-replay") + " -q --continue " + out_.string() +
                            " " + options);
  }

  [[nodiscard]] nlohmann::json summary() const {
    return nlohmann::json::parse(test::contentsOf(out_ / "summary.json"));
  }

  const test::TemporaryFolder folder_;
  const std::string rawlog_ = folder_ / "in.rawlog";
  const fs::path out_ = folder_ / "out";
};

TEST_F(ContinueTest, KilledRunsAreContinuedToTheResultsOfAWholeOne) {
  const auto whole = test::replay(rawlog_, folder_ / "whole", "-q --snapshots 0");
  ASSERT_EQ(0, whole.process.status);
  const auto expected = io::readTum(whole.file("trajectory.tum"));
  std::mt19937 random(22);
  std::uniform_int_distribution<int> moment(0, 1400);
  std::size_t continued = 0;
  for (int run = 0; run < 24; ++run) {
    fs::remove_all(out_);
    // Every second one after a checkpoint, however slow the machine is.
    killReplay(moment(random) / (1 + run % 2), {}, test::kSanitized ? "0.1" : "1",
               run % 2 == 0 ? fs::path() : out_ / "map.headway");
    if (!fs::exists(out_ / "replay.json")) continue;  // nothing is lost
    expectRowsAreWhole(out_);
    const auto process = goOn();
    if (process.status == 1) {  // the end was faster than the signal
      EXPECT_THAT(process.output, HasSubstr("the run has ended"));
      continue;
    }
    ASSERT_EQ(0, process.status) << process.output;
    const auto figures = summary();
    EXPECT_TRUE(figures["ended_early"].is_null());
    EXPECT_EQ(whole.summary["frames"], figures["frames"]);
    EXPECT_EQ(whole.summary["tracks_confirmed"], figures["tracks_confirmed"]);
    EXPECT_LT(test::ateRmse(expected, io::readTum(out_ / "trajectory.tum")), 0.01);
    expectRowsAreWhole(out_);
    continued += figures["continued_after"].size();
  }
  EXPECT_GT(continued, 5u) << "of 24";
}

TEST_F(ContinueTest, RowsAndIdsGoOnAsIfNothingHadHappened) {
  killAfterACheckpoint();
  const auto rows = io::readTrackCsv(out_ / "tracks.csv");
  ASSERT_EQ(0, goOn().status);
  const auto continued = io::readTrackCsv(out_ / "tracks.csv");
  ASSERT_GE(continued.size(), rows.size());
  for (std::size_t i = 0; i + 1 < continued.size(); ++i) {
    EXPECT_LE(continued[i].frame, continued[i + 1].frame);
    EXPECT_EQ(continued.front().track.id, continued[i].track.id) << "one pedestrian";
  }
  EXPECT_FALSE(map::loadMap(out_ / "map.headway").attachments.count("run")) << "it has ended";
  EXPECT_THAT(test::contentsOf(out_ / "report.html"), HasSubstr("continued"));
}

TEST_F(ContinueTest, ARunThatReplacesOldResultsIsContinuedAndPublished) {
  ASSERT_EQ(0, test::replay(rawlog_, out_, "-q --snapshots 0 --to-index 3").process.status);
  killReplay(0, {"-w"}, "0.4", out_ / "unfinished/map.headway");
  ASSERT_TRUE(fs::exists(out_ / "unfinished/map.headway"));
  EXPECT_EQ(4, summary()["frames"]) << "the old results remain";
  const auto process = goOn();
  ASSERT_EQ(0, process.status) << process.output;
  EXPECT_EQ(test::kPlainFrames, summary()["frames"]);
  EXPECT_FALSE(fs::exists(out_ / "unfinished"));
}

/// Killed between the renaming of its folder and that of the last file.
TEST_F(ContinueTest, ARunWhosePublicationWasKilledHasEndedAndIsPublished) {
  ASSERT_EQ(0, test::replay(rawlog_, out_, "-q --snapshots 0 --to-index 3").process.status);
  const auto whole = test::replay(rawlog_, folder_ / "whole", "-q --snapshots 0");
  ASSERT_EQ(0, whole.process.status);
  fs::rename(whole.folder, out_ / "complete");
  fs::rename(out_ / "complete/tracks.csv", out_ / "tracks.csv");
  const auto process = goOn();
  EXPECT_EQ(1, process.status);
  EXPECT_THAT(process.output, HasSubstr("the run has ended"));
  EXPECT_EQ(test::kPlainFrames, summary()["frames"]);
  EXPECT_EQ(whole.summary["frames"], summary()["frames"]);
  EXPECT_FALSE(fs::exists(out_ / "complete"));
}

/// OUTDIR may be a link to a folder, such as on another disk.
TEST_F(ContinueTest, LinkedFoldersAreWrittenContinuedAndLocked) {
  fs::create_directory(folder_ / "disk");
  fs::create_directory_symlink(folder_ / "disk", out_);
  killAfterACheckpoint();
  ASSERT_EQ(0, goOn().status);
  EXPECT_EQ(test::kPlainFrames, summary()["frames"]);
  killReplay(0, {"-w"}, "0.4", out_ / "unfinished/map.headway");
  ASSERT_EQ(0, goOn().status);
  EXPECT_TRUE(fs::is_symlink(out_));
  EXPECT_FALSE(fs::exists(folder_ / "disk/unfinished"));
  EXPECT_TRUE(fs::exists(folder_ / "disk/summary.json"));

  const int lock = open((folder_ / "disk/.lock").c_str(), O_RDWR | O_CREAT, 0600);
  ASSERT_EQ(0, flock(lock, LOCK_EX | LOCK_NB));
  const auto second = test::replay(rawlog_, out_, "-q --snapshots 0 -w");
  close(lock);
  EXPECT_EQ(1, second.process.status);
  EXPECT_THAT(second.process.output, HasSubstr("is writing its results there"));
}

TEST_F(ContinueTest, WhatCannotBeContinuedIsNamed) {
  EXPECT_THAT(goOn().output, HasSubstr("no such folder"));
  EXPECT_EQ(2, goOn("-i " + rawlog_).status);
  EXPECT_EQ(2, goOn("--set slam.window=5").status);
  EXPECT_EQ(2, goOn("--snapshots 3").status);
  EXPECT_EQ(2, goOn("--theme light").status);
  ASSERT_EQ(0, test::replay(rawlog_, out_, "-q --snapshots 0").process.status);
  const auto ended = goOn();
  EXPECT_EQ(1, ended.status);
  EXPECT_THAT(ended.output, HasSubstr("the run has ended"));
}

TEST_F(ContinueTest, AnotherRecordingAndLogsThatLackRowsAreRefused) {
  killAfterACheckpoint();
  fs::resize_file(out_ / "trajectory_online.tum", 0);
  const auto lacking = goOn();
  EXPECT_EQ(1, lacking.status);
  EXPECT_THAT(lacking.output, HasSubstr("fewer"));
  fs::remove_all(out_);
  killAfterACheckpoint();
  io::RawlogSink sink(rawlog_, io::ImageStorage::kEmbedded);
  for (int frame = 0; frame < test::kPlainFrames; ++frame) {
    const auto pair = test::plainPair(frame);
    sink.writeStereo(2000.0 + 0.1 * frame, pair.left, pair.right, io::rawFrom(test::plainCamera()));
  }
  sink.close();
  const auto other = goOn();
  EXPECT_EQ(1, other.status);
  EXPECT_THAT(other.output, HasSubstr("not the recording"));
}

TEST_F(ContinueTest, RunsOfPosesAndBoxesAreContinued) {
  io::RawlogSink sink(rawlog_, io::ImageStorage::kEmbedded);
  for (int frame = 0; frame < 20; ++frame) {
    Pose T_map_robot = Pose::Identity();
    T_map_robot.translation().x() = 0.1 * frame;
    sink.writePose("pose", test::plainTime(frame), T_map_robot);
    Detections detections;
    detections.time = test::plainTime(frame);
    detections.items = {test::plainDetection()};
    sink.writeDetections("detections", detections);
  }
  sink.close();
  killAfterACheckpoint();
  ASSERT_TRUE(fs::exists(out_ / "map.headway"));
  const auto process = goOn();
  ASSERT_EQ(0, process.status) << process.output;
  EXPECT_EQ(20u, io::readTum(out_ / "trajectory.tum").size());
}

/// Twenty sizes of a file system in memory, or of files where none can be mounted.
TEST_F(ContinueTest, AFullDiskOfAnySizeIsAnErrorWithWholeRows) {
  const fs::path disk = folder_ / "disk";
  fs::create_directories(disk);
  int failed = 0;
  for (int size = 1; size <= 20; ++size) {
    const std::string kilobytes = std::to_string(16 * size);
    const bool is_mounted =
        mount("tmpfs", disk.c_str(), "tmpfs", 0, ("size=" + kilobytes + "k").c_str()) == 0;
    const std::string limit = is_mounted ? "" : "ulimit -f " + kilobytes + "; ";
    const auto run = test::runProcess("bash -c '" + limit + test::program("headway-replay") +
                                      " -q --snapshots 0 -i " + rawlog_ + " -o " +
                                      (disk / "out").string() + "'");
    if (run.status != 0) {
      ++failed;
      EXPECT_EQ(1, run.status) << run.output;
      EXPECT_EQ(1, std::count(run.output.begin(), run.output.end(), '\n')) << run.output;
      if (fs::exists(disk / "out")) expectRowsAreWhole(disk / "out");
    }
    if (is_mounted) umount2(disk.c_str(), MNT_DETACH);
    fs::remove_all(disk / "out");
  }
  EXPECT_GT(failed, 3) << "sizes were too small";
}

TEST_F(ContinueTest, ThirtyFileDescriptorsAndAGigabyteAreEnough) {
  for (const std::string limit : {"ulimit -n 30", "ulimit -v 1048576"}) {
    if (test::kSanitized && limit != "ulimit -n 30") return;  // it reserves terabytes
    const auto run =
        test::runProcess("bash -c '" + limit + "; " + test::program("headway-replay") +
                         " -q -w -i " + rawlog_ + " --snapshots 0 -o " + out_.string() + "'");
    EXPECT_EQ(0, run.status) << limit << ": " << run.output;
  }
  for (const std::string kilobytes : {"150000", "200000", "250000", "300000"}) {
    const auto run = test::runProcess("bash -c 'ulimit -v " + kilobytes + "; " +
                                      test::program("headway-replay") + " -q -w -i " + rawlog_ +
                                      " --snapshots 0 -o " + out_.string() + "'");
    EXPECT_THAT(run.status, testing::AnyOf(0, 1, 127)) << kilobytes << ": " << run.output;
  }
}

/// As another user where this is root, who may write everywhere.
TEST_F(ContinueTest, FoldersWithoutPermissionAreErrorsOrNotNeeded) {
  const bool is_root = geteuid() == 0;
  const std::string user =
      is_root ? "setpriv --reuid 65534 --regid 65534 --clear-groups " : std::string();
  const fs::path locked = folder_ / "locked";
  fs::create_directories(locked);
  fs::create_directories(out_);
  fs::permissions(folder_ / ".", fs::perms(0755));
  fs::permissions(locked, fs::perms(0555));
  fs::permissions(out_, fs::perms(0777));
  const std::string replay =
      user + test::program("headway-replay") + " -q --snapshots 0 -i " + rawlog_ + " -o ";
  const auto refused = test::runProcess(replay + (locked / "out").string());
  EXPECT_EQ(1, refused.status);
  EXPECT_THAT(refused.output, HasSubstr("Permission denied"));
  const auto elsewhere =
      test::runProcess("cd " + locked.string() + " && " + replay + out_.string());
  EXPECT_EQ(0, elsewhere.status) << elsewhere.output << " without HOME, in a read-only folder";
}

}  // namespace
}  // namespace headway
