// SPDX-License-Identifier: BSD-3-Clause
// headway-live as a user runs it, on a camera that is a rawlog.
#include <gmock/gmock.h>
#include <headway/core/recorded_frame.h>
#include <headway_test/folders.h>
#include <headway_test/http_client.h>
#include <headway_test/process.h>
#include <headway_test/repeats.h>
#include <headway_test/waiting.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <limits>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <regex>

namespace headway::drivers {
namespace {

using ::testing::HasSubstr;

class LiveProgramTest : public ::testing::Test {
 protected:
  std::string sensors(const std::string& ini) {
    const std::string path = folder_ / "SENSORS.ini";
    std::ofstream(path) << ini;
    return path;
  }

  using Condition = std::function<bool(const std::string& output)>;

  /// Runs headway-live until its output meets the condition, a minute at most, and ends it by a
  /// signal; or to its own end.
  test::ProcessResult live(const std::string& arguments, const Condition& is_enough,
                           int signal = SIGTERM) {
    const std::string out = folder_ / "live.txt";
    const std::string end = folder_ / "live.status";
    std::filesystem::remove(end);
    const std::string pid = folder_ / "live.pid";
    (void)test::runProcess("( " + limits_ + test::program("headway-live") + " " + arguments + " >" +
                           out + " 2>&1 & echo $! >" + pid + "; wait $!; echo $? >" + end +
                           " ) >/dev/null 2>&1 & sleep 0.2");
    const int process = std::stoi(test::contentsOf(pid));
    const auto has_ended = [&] { return !test::contentsOf(end).empty(); };
    (void)test::waitUntil([&] { return has_ended() || is_enough(test::contentsOf(out)); });
    if (!has_ended()) kill(process, signal);
    (void)test::waitUntil(has_ended);
    const std::string status = test::contentsOf(end);
    return {status.empty() ? -1 : std::stoi(status), test::contentsOf(out)};
  }

  /// Frames while tracking, by the status lines.
  static int trackedFrames(const std::string& output) {
    static const std::regex line("tracked .* ([0-9]+) frames/s");
    int frames = 0;
    for (std::sregex_iterator match(output.begin(), output.end(), line), end; match != end;
         ++match) {
      frames += std::stoi((*match)[1]);
    }
    return frames;
  }

  /// After so many tracked frames.
  static Condition frames(int count) {
    return [count](const std::string& output) { return trackedFrames(output) >= count; };
  }

  /// Port of the page or of the health; 0 before it is printed.
  static int portOf(const std::string& what, const std::string& output) {
    std::smatch port;
    const std::regex line(what + ": http://127.0.0.1:([0-9]+)/");
    return std::regex_search(output, port, line) ? std::stoi(port[1]) : 0;
  }

  /// Whether a recording contains observations and was ended.
  static bool isComplete(const std::string& rawlog) {
    return std::filesystem::file_size(rawlog) > 10000 &&
           test::runProcess("gzip -t <" + rawlog).status == 0;
  }

  std::string limits_;  ///< commands of the shell before the program
  test::TemporaryFolder folder_;
};

TEST_F(LiveProgramTest, RunsRecordsAndEndsCleanly) {
  const std::string rawlog = std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/street.rawlog";
  const std::string ini = sensors(
      "[CAM]\ndriver = CCameraSensor\ngrabber_type = rawlog\n"
      "rawlog_file = " +
      rawlog +
      "\nprocess_rate = 8\n"
      "pose_z = 1.65\npose_yaw = -90\npose_roll = -90\n");
  const std::string out = folder_ / "out";
  const std::string recorded = out + "/live.rawlog";
  std::string health;                    // while it ran
  std::optional<test::Connection> slow;  // a client that holds the health's server
  std::future<double> closed_s;
  double signalled_s = 0.0;
  const auto isGood = [&](const std::string& output) {
    const int port = portOf("health", output);
    if (port == 0) return false;
    const auto response = test::httpGet("127.0.0.1", port, "/health");
    if (response.status == 200) health = response.body;
    if (health.empty() || trackedFrames(output) < 12) return false;
    slow.emplace("127.0.0.1", port);
    closed_s = std::async(std::launch::async, [&] {
      (void)slow->receiveAll();
      return monotonicSeconds();
    });
    signalled_s = monotonicSeconds();
    return true;
  };
  const auto run =
      live("--sensors " + ini + " -o " + out + " --health 0 --record " + recorded, isGood);
  EXPECT_LT(closed_s.get() - signalled_s, 0.5);
  EXPECT_EQ(run.status, 0) << run.output;
  EXPECT_THAT(health, HasSubstr("\"status\":\"tracked\""));
  EXPECT_THAT(health, HasSubstr("\"sensors\":[{\"name\":\"CAM\""));
  EXPECT_THAT(run.output, HasSubstr("latency"));
  EXPECT_THAT(run.output, HasSubstr("tracked"));
  const auto summary = nlohmann::json::parse(test::contentsOf(out + "/summary.json"));
  EXPECT_GE(summary.at("frames_tracked").get<int>(), 10);
  EXPECT_EQ(summary.at("ended_early"), "interrupted");
  for (const char* file : {"trajectory.tum", "trajectory_online.tum", "map.headway", "report.html",
                           "tracks.csv", "calibration.yaml"}) {
    EXPECT_FALSE(test::contentsOf(out + "/" + file).empty()) << file;
  }
  const auto replay = test::runProcess(test::program("headway-replay") + " -q -i " + recorded +
                                       " -o " + (folder_ / "again").string() + " --snapshots 0");
  EXPECT_EQ(replay.status, 0) << replay.output;
}

TEST_F(LiveProgramTest, RecordsAndWritesCheckpointsWhileConnectionsComeWithoutEnd) {
  limits_ = "ulimit -n 128; ";
  const std::string out = folder_ / "out";
  const std::string recorded = folder_ / "live.rawlog";
  const std::string ini = sensors(
      "[CAM]\ndriver = CCameraSensor\ngrabber_type = rawlog\nrawlog_file = " +
      std::string(HEADWAY_SOURCE_DIR) +
      "/rawlogs/street.rawlog\nprocess_rate = 8\npose_z = 1.65\npose_yaw = -90\npose_roll = -90\n");
  std::deque<test::Connection> clients;
  int wanted = 0;      // tracked frames
  int recordable = 0;  // observations of the camera so far
  const auto isEnough = [&](const std::string& output) {
    if (trackedFrames(output) < 4) return false;
    do clients.emplace_back("127.0.0.1", portOf("page", output));
    while (clients.size() < 200);
    if (clients.size() > 200) clients.pop_front();
    if (wanted == 0) {
      wanted = trackedFrames(output) + 8;
      std::filesystem::remove(out + "/map.headway");  // of a checkpoint: the next one comes
    }
    if (trackedFrames(output) < wanted || !std::filesystem::exists(out + "/map.headway")) {
      return false;
    }
    const auto health = test::httpGet("127.0.0.1", portOf("health", output), "/health").body;
    recordable = nlohmann::json::parse(health).at("sensors").at(0).at("observations").get<int>();
    return true;
  };
  const auto run = live("--sensors " + ini + " -o " + out + " --show 0 --health 0 --record " +
                            recorded + " --set output.checkpoint_s=0.2",
                        isEnough);
  EXPECT_EQ(0, run.status) << run.output;
  EXPECT_THAT(run.output, Not(HasSubstr("lacks")));
  const auto summaryIn = [](const std::string& folder) {
    return nlohmann::json::parse(test::contentsOf(folder + "/summary.json"));
  };
  EXPECT_GE(summaryIn(out).at("frames_tracked").get<int>(), wanted);
  const std::string again = folder_ / "again";
  const auto replay = test::runProcess(test::program("headway-replay") + " -q -i " + recorded +
                                       " -o " + again + " --snapshots 0");
  EXPECT_EQ(0, replay.status) << replay.output;
  EXPECT_GE(recordable, wanted);
  EXPECT_GE(summaryIn(again).at("frames").get<int>(), recordable);
}

TEST_F(LiveProgramTest, ARunThatWasKilledGoesOnInItsMap) {
  const std::string ini = sensors(
      "[CAM]\ndriver = CCameraSensor\ngrabber_type = rawlog\nrawlog_file = " +
      std::string(HEADWAY_SOURCE_DIR) +
      "/rawlogs/street.rawlog\nprocess_rate = 8\npose_z = 1.65\npose_yaw = -90\npose_roll = -90\n");
  const std::string before = folder_ / "before", after = folder_ / "after";
  const auto killed = live(
      "--sensors " + ini + " -o " + before + " --set output.checkpoint_s=0.2",
      [&](const std::string& output) {
        return trackedFrames(output) >= 12 && std::filesystem::exists(before + "/map.headway");
      },
      SIGKILL);
  EXPECT_EQ(128 + SIGKILL, killed.status) << killed.output;
  const auto run = live(
      "--sensors " + ini + " -o " + after + " --load-map " + before + "/map.headway", frames(8));
  EXPECT_EQ(0, run.status) << run.output;
  const auto summaryIn = [](const std::string& folder) {
    return nlohmann::json::parse(test::contentsOf(folder + "/summary.json"));
  };
  EXPECT_THAT(summaryIn(before).at("ended_early").get<std::string>(), HasSubstr("killed"));
  EXPECT_GE(summaryIn(after).at("frames_tracked").get<int>(), 8) << "re-localised in its map";
  EXPECT_GE(summaryIn(after).at("keyframes").get<int>(),
            summaryIn(before).at("keyframes").get<int>());
  EXPECT_FALSE(test::contentsOf(before + "/trajectory.tum").empty());
}

/// The robot of rawlogs/hall.rawlog by the drivers of the plug-in.
class LiveRobotTest : public LiveProgramTest {
 protected:
  static std::string section(const std::string& name, const std::string& keys) {
    const std::string hall = std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/hall";
    return "[" + name + "]\ndriver = RobotSensor\nprocess_rate = 50\nsensorLabel = " + name +
           "\ntrajectory = " + hall + ".truth/trajectory.tum\nrawlog_file = " + hall + ".rawlog\n" +
           keys;
  }

  /// That of rawlogs/hall.rawlog, which the drivers do not know.
  std::string calibration() {
    const std::string path = folder_ / "calibration.yaml";
    std::ofstream(path) << "image_size: [640, 480]\nleft: [450, 450, 319.5, 239.5]\n"
                           "baseline_m: 0.05\nT_robot_cam: [0, -0.08715574, 0.9961947, 0.1, "
                           "-1, 0, 0, 0.025, 0, -0.9961947, -0.08715574, 0.3]\n";
    return path;
  }

  test::ProcessResult live(const std::string& ini, const std::string& arguments,
                           const Condition& is_enough) {
    return LiveProgramTest::live("--sensors " + sensors(ini) + " --load-plugins " + plugin_ +
                                     " --calibration " + calibration() + " " + arguments,
                                 is_enough);
  }

  const std::string plugin_ = std::string(HEADWAY_BIN_DIR) + "/libheadway_robot_sensors.so";

  nlohmann::json summary(const std::string& folder) {
    return nlohmann::json::parse(test::contentsOf(folder_ / (folder + "/summary.json")));
  }
};

TEST_F(LiveRobotTest, TwoCamerasPairByTimeWithinTheTolerance) {
  const std::string two =
      section("LEFT", "kind = left\n") + section("RIGHT", "kind = right\nlate_s = 0.004\n");
  const std::string labels = "--sensor-label LEFT,RIGHT -o ";
  const auto run = live(two, labels + (folder_ / "out").string(), frames(12));
  EXPECT_EQ(run.status, 0) << run.output;
  EXPECT_GE(summary("out").at("frames_tracked").get<int>(), 10) << run.output;
  EXPECT_NEAR(summary("out").at("calibration").at("baseline_m").get<double>(), 0.05, 1e-6);

  const auto strict = live(
      two, labels + (folder_ / "strict").string() + " --pair-tolerance 0.002",
      [](const std::string& output) { return output.find("no partner") != std::string::npos; });
  EXPECT_EQ(strict.status, 0) << strict.output;
  EXPECT_THAT(strict.output, HasSubstr("no partner of the other camera within 0.002 s"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "strict"));
}

TEST_F(LiveRobotTest, AllSensorsAreUsedRecordedAndStartedAgain) {
  const std::string all = section("LEFT", "kind = left\n") + section("RIGHT", "kind = right\n") +
                          section("WHEELS", "kind = odometry\n") + section("IMU", "kind = imu\n") +
                          section("LASER", "kind = laser\nunplug_after = 20\n");
  const std::string out = folder_ / "out";
  const std::string recorded = folder_ / "live.rawlog";
  const int wanted = test::repeats(30, 5);  // of a recording that lasts 4 s
  const auto run =
      live(all, "--sensor-label LEFT,RIGHT --record " + recorded + " -o " + out,
           [&](const std::string& output) {
             return output.find("plug") != std::string::npos && trackedFrames(output) >= wanted;
           });
  EXPECT_EQ(run.status, 0) << run.output;
  EXPECT_THAT(run.output, HasSubstr("sensor [LASER]: the plug was pulled; it is started again"));
  EXPECT_GE(summary("out").at("frames_tracked").get<int>(), wanted / 3) << run.output;
  // Of the scans, those that came before their image and whose frame has a ground scan.
  EXPECT_GE(summary("out").at("laser").at("used").get<int>(), 1) << run.output;

  const auto replay =
      test::runProcess(test::program("headway-replay") + " -q -i " + recorded + " -o " +
                       (folder_ / "again").string() + " --snapshots 0 --to-index 60");
  EXPECT_EQ(replay.status, 0) << replay.output;
  EXPECT_GE(summary("again").at("laser").at("used").get<int>(), 5);
  EXPECT_EQ(summary("again").at("observations_skipped").count("CObservationIMU"), 0u);

  const auto resumed =
      live(all,
           "--sensor-label LEFT,RIGHT --load-map " + out +
               "/map.headway --set slam.mapping=false -o " + (folder_ / "resumed").string(),
           frames(test::repeats(6, 2)));
  EXPECT_EQ(resumed.status, 0) << resumed.output;
  EXPECT_GE(summary("resumed").at("frames_tracked").get<int>(), test::repeats(5, 1))
      << resumed.output;
}

TEST_F(LiveRobotTest, ARecordingIsEndedHoweverTheRunEnds) {
  const std::string left = section("LEFT", "kind = left\n");
  const std::string recorded = folder_ / "live.rawlog";
  const std::string options = "-w -o " + (folder_ / "out").string() + " --record ";
  const auto says = [](const std::string& text) {
    return [text](const std::string& output) { return output.find(text) != std::string::npos; };
  };
  std::ofstream(recorded) << "older";
  const auto early = live(left, options + recorded, says("waiting for images; "));
  EXPECT_EQ(0, early.status) << early.output;
  EXPECT_TRUE(isComplete(recorded)) << "interrupted before the first pair";

  std::ofstream(recorded) << "older";
  const auto fault = LiveProgramTest::live(
      "--sensor-label LEFT,RIGHT --load-plugins " + plugin_ + " --sensors " +
          sensors(left + section("RIGHT", "kind = right\n")) + " " + options + recorded,
      frames(1));
  EXPECT_EQ(1, fault.status);
  EXPECT_THAT(fault.output, HasSubstr("stereo calibration: the images have none"));
  EXPECT_TRUE(isComplete(recorded)) << "ended by an error";

  const auto full = live(left, options + "/dev/full", says("/dev/full: write error"));
  EXPECT_EQ(1, full.status) << full.output;
  EXPECT_THAT(full.output, HasSubstr("/dev/full: not written completely; check the disk space"));
}

TEST_F(LiveRobotTest, ADriverThatDoesNotReturnDoesNotDelayTheEnd) {
  const std::string recorded = folder_ / "live.rawlog";
  const auto run =
      live(section("LEFT", "kind = left\n") + section("RIGHT", "kind = right\n") +
               section("IMU", "kind = imu\nstarted_with = " + (folder_ / "never").string() + "\n"),
           "--sensor-label LEFT,RIGHT --record " + recorded + " -o " + (folder_ / "out").string(),
           frames(4));
  EXPECT_EQ(0, run.status) << run.output;
  EXPECT_THAT(run.output, HasSubstr("sensor [IMU]: its driver does not return; it is left"));
  EXPECT_GE(summary("out").at("frames_tracked").get<int>(), 4) << run.output;
  EXPECT_TRUE(isComplete(recorded));
}

TEST_F(LiveRobotTest, ASignalEndsThePageWhileDriversAreConfigured) {
  const std::string go_on = folder_ / "go_on";
  std::future<double> closed_s;
  double signalled_s = 0.0;
  const auto isServed = [&](const std::string& output) {
    const int port = portOf("page", output);
    if (port == 0) return false;
    closed_s = std::async(std::launch::async, [port, go_on] {
      const bool is_closed = test::waitUntil([port] {
        try {
          test::Connection("127.0.0.1", port);
          return false;
        } catch (const std::runtime_error&) {
          return true;
        }
      });
      const double now_s = monotonicSeconds();
      std::ofstream(go_on) << "the driver";
      return is_closed ? now_s : std::numeric_limits<double>::infinity();
    });
    signalled_s = monotonicSeconds();
    return true;
  };
  const auto run = live(section("IMU", "kind = imu\nconfigured_with = " + go_on + "\n"),
                        "--show 0 -o " + (folder_ / "out").string(), isServed);
  ASSERT_TRUE(closed_s.valid()) << run.output;
  EXPECT_LT(closed_s.get() - signalled_s, 0.5);
  EXPECT_EQ(0, run.status) << run.output;
  EXPECT_THAT(run.output, HasSubstr("interrupted before the first stereo pair"));
}

TEST_F(LiveRobotTest, APluginThatCannotBeLoadedIsNamed) {
  const auto run = LiveProgramTest::live(
      "--sensors x --load-plugins /no/such.so -o " + (folder_ / "out").string(), frames(1));
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.output, HasSubstr("/no/such.so"));
}

TEST_F(LiveProgramTest, SaysAtOnceWhatIsMissing) {
  const std::string hall = std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/hall.rawlog";
  const std::string out = (folder_ / "out").string();
  ASSERT_EQ(0,
            test::runProcess(test::program("headway-export") + " kitti-odometry -q --to-index 59 " +
                             hall + " -o " + (folder_ / "kitti").string())
                .status);
  const std::string camera = "[CAM]\ndriver = CCameraSensor\nprocess_rate = 15\ngrabber_type = ";
  const std::string folder = camera + "image_dir\nimage_dir_url = " + (folder_ / "kitti").string() +
                             "\nleft_format = image_0/%06d.png\nend_index = 59\n";
  const auto uncalibrated =
      live("--sensors " + sensors(folder + "right_format = image_1/%06d.png\n") + " -o " + out,
           frames(1));
  EXPECT_EQ(1, uncalibrated.status);
  EXPECT_THAT(uncalibrated.output, HasSubstr("stereo calibration: the images have none"));
  const auto isWaiting = [](const std::string& output) {
    return output.find("waiting for images; ") != std::string::npos;
  };
  const auto single = live("--sensors " + sensors(folder) + " -o " + out, isWaiting);
  EXPECT_THAT(single.output, HasSubstr("a stereo camera gives images of two labels"));
  const auto no_rawlog = live(
      "--sensors " + sensors(camera + "rawlog\nrawlog_file = /no/such.rawlog\n") + " -o " + out,
      frames(1));
  EXPECT_EQ(1, no_rawlog.status);
  EXPECT_THAT(no_rawlog.output,
              HasSubstr("[CAM] rawlog_file = /no/such.rawlog: no such file or folder\n"));
  std::filesystem::create_directory(folder_ / "none");
  std::ofstream(folder_ / "empty.rawlog");
  std::ofstream(folder_ / "pointer.rawlog") << "version https://git-lfs.github.com/spec/v1\n";
  const std::string root = folder_.path().string() + "/";
  for (const auto& [source, fault] :
       {std::pair("rawlog\nrawlog_file = " + root + "empty.rawlog", "empty.rawlog: is empty\n"),
        {"rawlog\nrawlog_file = " + root + "pointer.rawlog", "run git lfs pull\n"},
        {"image_dir\nleft_format = %d.png\nimage_dir_url = " + root + "none",
         "none: is empty\n"}}) {
    const auto ended =
        live("--sensors " + sensors(camera + source + "\n") + " -o " + out, frames(1));
    EXPECT_EQ(1, ended.status);
    EXPECT_THAT(ended.output, HasSubstr(fault));
    EXPECT_THAT(ended.output, Not(HasSubstr("again"))) << "what does not come is not waited for";
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(LiveProgramTest, SplitsImagesThatContainBothOfAPair) {
  const std::string hall = std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/hall.rawlog";
  ASSERT_EQ(0,
            test::runProcess(test::program("headway-export") + " kitti-odometry -q --to-index 59 " +
                             hall + " -o " + (folder_ / "kitti").string())
                .status);
  std::filesystem::create_directory(folder_ / "both");
  for (int i = 0; i < 60; ++i) {
    std::array<char, 16> name{};
    std::snprintf(name.data(), name.size(), "%06d.png", i);
    cv::Mat both;
    cv::hconcat(cv::imread((folder_ / "kitti/image_0").string() + "/" + name.data()),
                cv::imread((folder_ / "kitti/image_1").string() + "/" + name.data()), both);
    cv::imwrite((folder_ / "both").string() + "/" + name.data(), both);
  }
  const std::string calibration = folder_ / "calibration.yaml";
  std::ofstream(calibration) << "image_size: [640, 480]\nleft: [450, 450, 319.5, 239.5]\n"
                                "baseline_m: 0.05\n";
  const std::string out = folder_ / "out";
  const auto run =
      live("--sensors " +
               sensors("[ZED]\ndriver = CCameraSensor\nprocess_rate = 15\n"
                       "side_by_side = true\ngrabber_type = image_dir\n"
                       "image_dir_url = " +
                       (folder_ / "both").string() + "\nleft_format = %06d.png\nend_index = 59\n") +
               " --calibration " + calibration + " -o " + out,
           frames(12));
  EXPECT_EQ(0, run.status) << run.output;
  const auto summary = nlohmann::json::parse(test::contentsOf(out + "/summary.json"));
  EXPECT_GE(summary.at("frames_tracked").get<int>(), 10) << run.output;
}

TEST_F(LiveProgramTest, NamesWhatIsWrongWithTheSensors) {
  const auto missing = live("--sensors /no/such.ini -o " + (folder_ / "out").string(), frames(1));
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.output, HasSubstr("/no/such.ini"));
  const auto unknown = live("--sensors " + sensors("[CAM]\ndriver = CNoSuchSensor\n") + " -o " +
                                (folder_ / "out").string(),
                            frames(1));
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.output, HasSubstr("[CAM] driver = CNoSuchSensor"));
}

}  // namespace
}  // namespace headway::drivers
