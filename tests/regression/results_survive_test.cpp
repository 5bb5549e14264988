// SPDX-License-Identifier: BSD-3-Clause
// What happens to results when programs are ended, lack disk, descriptors, memory or permissions,
// or when inputs are named as outputs.
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
#include <map>
#include <thread>

#include "plain_rawlog.h"
#include "replay_run.h"

namespace headway {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

std::map<std::string, std::string> contentsIn(const fs::path& folder) {
  std::map<std::string, std::string> contents;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_directory()) continue;
    contents[entry.path().lexically_relative(folder)] = test::contentsOf(entry.path());
  }
  return contents;
}

void expectWholeRows(const fs::path& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const auto extension = entry.path().extension();
    if (name.rfind(".partial-", 0) == 0) continue;
    if (extension != ".csv" && extension != ".tum" && extension != ".txt") continue;
    const std::string content = test::contentsOf(entry.path());
    EXPECT_TRUE(content.empty() || content.back() == '\n') << entry.path();
  }
}

/// Whether a program writes a file of the folder.
bool isBeingWritten(const fs::path& folder) {
  const auto files = fs::directory_iterator(folder);
  return std::any_of(begin(files), end(files), [](const auto& entry) {
    return entry.path().filename().string().rfind(".partial-", 0) == 0;
  });
}

class ResultsSurviveTest : public testing::Test {
 protected:
  ResultsSurviveTest() { test::writePlainRawlog(rawlog_); }

  [[nodiscard]] test::ReplayRun replay(const std::string& options = "") const {
    return test::replay(rawlog_, out_, "-q --snapshots 0 " + options);
  }

  /// Starts a program in this test's process group.
  static pid_t start(std::vector<std::string> words) {
    const pid_t child = fork();
    if (child != 0) return child;
    std::vector<char*> arguments;
    for (auto& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    execv(arguments[0], arguments.data());
    _exit(99);
  }

  [[nodiscard]] pid_t startReplay(std::vector<std::string> options) const {
    options.insert(options.begin(), {test::program("headway-replay"), "-q", "--snapshots", "0",
                                     "-i", rawlog_, "-o", out_.string()});
    return start(options);
  }

  /// Waits until the replay has written its first frame's rows.
  [[nodiscard]] bool hasBegun() const {
    return test::waitUntil(
        [&] { return !test::contentsOf(out_ / "trajectory_online.tum").empty(); });
  }

  /// Sends a signal; returns the exit status and the time until the end [s].
  static std::pair<int, double> end(pid_t child, int signal) {
    const auto sent = Clock::now();
    kill(child, signal);
    int status = 0;
    waitpid(child, &status, 0);
    const double seconds = std::chrono::duration<double>(Clock::now() - sent).count();
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, seconds};
  }

  const test::TemporaryFolder folder_;
  const std::string rawlog_ = folder_ / "in.rawlog";
  const fs::path out_ = folder_ / "out";
};

TEST_F(ResultsSurviveTest, SignalsEndAReplayThatWaitsWithItsStatusAndWholeResults) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    fs::remove_all(out_);
    const pid_t child = startReplay({"--realtime", "0.001"});  // a frame every 100 s
    EXPECT_TRUE(hasBegun());
    const auto [status, seconds] = end(child, signal);
    EXPECT_EQ(128 + signal, status);
    EXPECT_LT(seconds, 2.0) << "signal " << signal;
    EXPECT_EQ("interrupted",
              nlohmann::json::parse(test::contentsOf(out_ / "summary.json")).at("ended_early"));
    EXPECT_EQ(1u, io::readTum(out_ / "trajectory.tum").size()) << "it did not wait for the second";
    EXPECT_NO_THROW((void)map::loadMap(out_ / "map.headway"));
    EXPECT_FALSE(fs::exists(out_ / ".lock"));
  }
}

TEST_F(ResultsSurviveTest, SignalsEndOtherProgramsWithTheirStatus) {
  const std::string config = std::string(HEADWAY_SOURCE_DIR) + "/config/worlds/hall.ini";
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const pid_t child =
        start({test::program("headway-sim"), "-q", "-w", "-c", config, "-o", folder_ / "s.rawlog"});
    EXPECT_TRUE(test::waitUntil([&] { return isBeingWritten(folder_.path()); }));
    const auto [status, seconds] = end(child, signal);
    EXPECT_EQ(128 + signal, status) << "before it ends by itself";
    EXPECT_LT(seconds, 2.0) << "signal " << signal;
  }
}

TEST_F(ResultsSurviveTest, AKillLeavesWholeRowsAndASecondRunMayFollow) {
  for (int run = 0; run < 8; ++run) {
    fs::remove_all(out_);
    const pid_t child = startReplay({"--realtime", "0.3"});
    std::this_thread::sleep_for(std::chrono::milliseconds(250 + 300 * run));
    end(child, SIGKILL);
    if (fs::exists(out_)) expectWholeRows(out_);
  }
  EXPECT_TRUE(fs::exists(out_ / ".lock")) << "of the killed process";
  EXPECT_EQ(0, replay("-w").process.status);
}

TEST_F(ResultsSurviveTest, AKilledRunLeavesMapAndTrajectoryOfItsLastCheckpoint) {
  const pid_t child = startReplay({"--realtime", "0.4", "--set", "output.checkpoint_s=0.2"});
  EXPECT_TRUE(test::waitUntil([&] {
    return fs::exists(out_ / "summary.json") && fs::exists(out_ / "map.headway") &&
           fs::exists(out_ / "trajectory.tum") && io::readTum(out_ / "trajectory.tum").size() >= 2;
  }));
  end(child, SIGKILL);
  EXPECT_FALSE(map::loadMap(out_ / "map.headway").map.staticMap()->landmarks.empty());
  const auto summary = nlohmann::json::parse(test::contentsOf(out_ / "summary.json"));
  EXPECT_THAT(summary.at("ended_early").get<std::string>(),
              HasSubstr("killed after the checkpoint"));
  for (const char* output : {"picture.png", "report.html", "replay.html"}) {
    const auto drawn = test::runProcess(test::program("headway-render") + " -q -i " +
                                        out_.string() + " -o " + (folder_ / output).string());
    EXPECT_EQ(0, drawn.status) << drawn.output;
  }
  EXPECT_THAT(test::contentsOf(folder_ / "report.html"),
              HasSubstr("ended early: killed after the checkpoint"));
  const auto resumed =
      test::replay(rawlog_, folder_ / "resumed",
                   "-q --snapshots 0 --from-index 6 --load-map " + (out_ / "map.headway").string());
  EXPECT_EQ(0, resumed.process.status) << resumed.process.output;
  EXPECT_GT(resumed.summary.at("frames_tracked"), 4);
}

TEST_F(ResultsSurviveTest, AKillWhileReplacingLeavesTheOldResults) {
  ASSERT_EQ(0, replay().process.status);
  const auto before = contentsIn(out_);
  const pid_t child = startReplay({"-w", "--realtime", "0.001"});
  EXPECT_TRUE(test::waitUntil([&] { return fs::exists(out_ / ".lock"); }));
  std::this_thread::sleep_for(std::chrono::milliseconds(1000));
  end(child, SIGKILL);
  auto after = contentsIn(out_);
  for (const auto& [name, content] : before) EXPECT_EQ(content, after[name]) << name;
}

TEST_F(ResultsSurviveTest, NewResultsReplaceAllOldOnes) {
  ASSERT_EQ(0, test::replay(rawlog_, out_, "-q --snapshots 2").process.status);
  std::ofstream(out_ / "notes.txt") << "mine";
  ASSERT_TRUE(fs::exists(out_ / "map_grid.png"));
  ASSERT_EQ(0, replay("-w --set grid.period_s=0").process.status);
  EXPECT_FALSE(fs::exists(out_ / "map_grid.png")) << "stale";
  EXPECT_FALSE(fs::exists(out_ / "snapshots/000011.png")) << "stale";
  EXPECT_TRUE(fs::exists(out_ / "summary.json"));
  EXPECT_TRUE(fs::exists(out_ / "notes.txt"));
  EXPECT_FALSE(fs::exists(out_ / "unfinished"));
}

TEST_F(ResultsSurviveTest, EveryFileOfAReplayIsKnownAsAResult) {
  ASSERT_EQ(0, test::replay(rawlog_, out_, "-q --snapshots 2").process.status);
  ASSERT_EQ(0, test::replay(rawlog_, out_, "-q -w --snapshots 0 --to-index 2").process.status);
  const auto first = contentsIn(out_);
  ASSERT_EQ(
      0, test::replay(rawlog_, folder_ / "fresh", "-q --snapshots 0 --to-index 2").process.status);
  for (const auto& [name, content] : first) {
    EXPECT_TRUE(fs::exists(folder_ / ("fresh/" + name))) << name << " is stale";
  }
}

TEST_F(ResultsSurviveTest, AFullDiskIsAnErrorAndLeavesTheOldResults) {
  ASSERT_EQ(0, replay().process.status);
  const auto before = contentsIn(out_);
  const std::string command = test::program("headway-replay") + " -q -w --snapshots 0 -i " +
                              rawlog_ + " -o " + out_.string();
  for (const int kilobytes : {0, 1, 2, 4, 8, 16, 32, 64, 128, 256}) {
    const auto run =
        test::runProcess("bash -c 'ulimit -f " + std::to_string(kilobytes) + "; " + command + "'");
    if (run.status == 0) break;  // enough for the largest file
    EXPECT_EQ(1, run.status) << run.output;
    EXPECT_EQ(1, std::count(run.output.begin(), run.output.end(), '\n')) << run.output;
    EXPECT_THAT(run.output, AnyOf(HasSubstr("check the disk space"), HasSubstr("too large"),
                                  HasSubstr("No space left")));
    auto after = contentsIn(out_);
    for (const auto& [name, content] : before) EXPECT_EQ(content, after[name]) << name;
    expectWholeRows(out_);
  }
}

TEST_F(ResultsSurviveTest, AnInputIsNeverAnOutput) {
  ASSERT_EQ(0, replay().process.status);
  const auto before = contentsIn(out_);
  const auto detections = (out_ / "detections.csv").string();
  for (const std::string& options :
       {"-w --detections " + detections, "-w --load-map " + (out_ / "map.headway").string()}) {
    const auto run = replay(options);
    EXPECT_EQ(1, run.process.status);
    EXPECT_THAT(run.process.output, HasSubstr("is an input"));
    EXPECT_EQ(before, contentsIn(out_));
  }
  const auto run = test::runProcess(test::program("headway-eval") + " trajectory --truth " +
                                    (out_ / "trajectory.tum").string() + " --estimate " +
                                    (out_ / "trajectory_online.tum").string() + " -w --json " +
                                    (out_ / "trajectory.tum").string());
  EXPECT_EQ(1, run.status);
  EXPECT_THAT(run.output, HasSubstr("is an input"));
  EXPECT_EQ(before, contentsIn(out_));
}

TEST_F(ResultsSurviveTest, ABadInputLeavesTheOldResults) {
  ASSERT_EQ(0, replay().process.status);
  const auto before = contentsIn(out_);
  std::ofstream(folder_ / "bad.csv") << "no detections\n";
  EXPECT_EQ(1, replay("-w --detections " + (folder_ / "bad.csv").string()).process.status);
  auto after = contentsIn(out_);
  for (const auto& [name, content] : before) EXPECT_EQ(content, after[name]) << name;
}

TEST_F(ResultsSurviveTest, AFailedImportLeavesTheOldRawlogAndItsImages) {
  const fs::path images = folder_ / "images";
  const auto import = [&](const std::string& options) {
    return test::runProcess(test::program("headway-import") + " images -q --left " +
                            (images / "left").string() + " --right " + (images / "right").string() +
                            " --calibration " + (out_ / "calibration.yaml").string() + " -o " +
                            (folder_ / "imported.rawlog").string() + " --external-images " +
                            options);
  };
  ASSERT_EQ(0, replay().process.status);
  ASSERT_EQ(0, test::runProcess(test::program("headway-export") + " kitti-odometry -q " + rawlog_ +
                                " -o " + images.string())
                   .status);
  fs::rename(images / "image_0", images / "left");
  fs::rename(images / "image_1", images / "right");
  const auto first = import("");
  ASSERT_EQ(0, first.status) << first.output;
  const auto before = contentsIn(folder_ / "imported_Images");
  const auto rawlog = test::contentsOf(folder_ / "imported.rawlog");
  EXPECT_EQ(2u * test::kPlainFrames, before.size());
  std::ofstream(images / "left/000005.png") << "broken";
  EXPECT_EQ(1, import("-w").status);
  EXPECT_EQ(before, contentsIn(folder_ / "imported_Images"));
  EXPECT_EQ(rawlog, test::contentsOf(folder_ / "imported.rawlog"));
  EXPECT_EQ(0, import("-w --to-index 3").status);
  EXPECT_EQ(8u, contentsIn(folder_ / "imported_Images").size()) << "none of the old ones";
}

TEST_F(ResultsSurviveTest, TwoRunsIntoOneFolderAreRefused) {
  const pid_t child = startReplay({"--realtime", "0.001"});
  EXPECT_TRUE(hasBegun());
  const auto second = replay("-w");
  EXPECT_EQ(1, second.process.status);
  EXPECT_THAT(second.process.output, HasSubstr("process " + std::to_string(child)));
  EXPECT_EQ(143, end(child, SIGTERM).first);
}

/// Killed between the renaming of its folder and that of the last file.
TEST_F(ResultsSurviveTest, APublicationThatWasKilledIsSaidAndCompletedByTheNextRun) {
  ASSERT_EQ(0, replay("--to-index 3").process.status);
  const auto whole = test::replay(rawlog_, folder_ / "whole", "-q --snapshots 0");
  ASSERT_EQ(0, whole.process.status);
  fs::rename(whole.folder, out_ / "complete");
  fs::rename(out_ / "complete/tracks.csv", out_ / "tracks.csv");
  const auto page = test::runProcess(test::program("headway-render") + " -q -i " + out_.string() +
                                     " -o " + (folder_ / "report.html").string());
  EXPECT_EQ(1, page.status);
  EXPECT_THAT(page.output, HasSubstr("contains results of two runs"));
  const pid_t child = startReplay({"-w", "--realtime", "0.001"});
  EXPECT_TRUE(test::waitUntil([&] { return fs::exists(out_ / "unfinished/replay.json"); }));
  end(child, SIGKILL);
  EXPECT_EQ(test::kPlainFrames,
            nlohmann::json::parse(test::contentsOf(out_ / "summary.json")).at("frames"));
  EXPECT_FALSE(fs::exists(out_ / "complete"));
}

/// OUTDIR may be a link to a folder, such as on another disk.
TEST_F(ResultsSurviveTest, LinkedFoldersAreWrittenAndLocked) {
  fs::create_directory(folder_ / "disk");
  fs::create_directory_symlink(folder_ / "disk", out_);
  ASSERT_EQ(0, replay("--to-index 3").process.status);
  ASSERT_EQ(0, replay("-w").process.status);
  EXPECT_TRUE(fs::is_symlink(out_));
  EXPECT_FALSE(fs::exists(folder_ / "disk/unfinished"));
  EXPECT_EQ(test::kPlainFrames,
            nlohmann::json::parse(test::contentsOf(folder_ / "disk/summary.json")).at("frames"));

  const int lock = open((folder_ / "disk/.lock").c_str(), O_RDWR | O_CREAT, 0600);
  ASSERT_EQ(0, flock(lock, LOCK_EX | LOCK_NB));
  const auto second = replay("-w");
  close(lock);
  EXPECT_EQ(1, second.process.status);
  EXPECT_THAT(second.process.output, HasSubstr("is writing its results there"));
}

TEST_F(ResultsSurviveTest, AKilledRunOfPosesAndBoxesLeavesItsTrajectory) {
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
  const pid_t child = startReplay({"--realtime", "0.4", "--set", "output.checkpoint_s=0.2"});
  EXPECT_TRUE(test::waitUntil([&] { return fs::exists(out_ / "summary.json"); }));
  end(child, SIGKILL);
  const auto path = io::readTum(out_ / "trajectory.tum");
  ASSERT_FALSE(path.empty());
  const auto last = static_cast<double>(path.size() - 1);
  EXPECT_NEAR(0.1 * last, path.back().value.translation().x(), 1e-6);
  expectWholeRows(out_);
}

TEST_F(ResultsSurviveTest, ThereIsNoOptionToContinue) {
  const auto run =
      test::runProcess(test::program("headway-replay") + " -q --continue " + out_.string());
  EXPECT_EQ(2, run.status) << run.output;
}

/// Twenty sizes of a file system in memory, or of files where none can be mounted.
TEST_F(ResultsSurviveTest, AFullDiskOfAnySizeIsAnErrorWithWholeRows) {
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
      if (fs::exists(disk / "out")) expectWholeRows(disk / "out");
    }
    if (is_mounted) umount2(disk.c_str(), MNT_DETACH);
    fs::remove_all(disk / "out");
  }
  EXPECT_GT(failed, 3) << "sizes were too small";
}

TEST_F(ResultsSurviveTest, ThirtyFileDescriptorsAndAGigabyteAreEnough) {
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
TEST_F(ResultsSurviveTest, FoldersWithoutPermissionAreErrorsOrNotNeeded) {
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
