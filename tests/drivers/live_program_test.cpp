// headway-live as a user runs it, on a camera that is a rawlog.
#include <gmock/gmock.h>
#include <headway_test/folders.h>
#include <headway_test/process.h>

#include <fstream>
#include <nlohmann/json.hpp>

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

  /// Runs headway-live and ends it by SIGTERM after so many seconds.
  test::ProcessResult live(const std::string& arguments, int seconds) {
    return test::runProcess("timeout --preserve-status -s TERM " + std::to_string(seconds) + " " +
                            test::program("headway-live") + " " + arguments);
  }

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
  const std::string recorded = folder_ / "live.rawlog";
  const auto run = live("--sensors " + ini + " -o " + out + " --record " + recorded, 9);
  EXPECT_EQ(run.status, 0) << run.output;
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

TEST_F(LiveProgramTest, NamesWhatIsWrongWithTheSensors) {
  const auto missing = live("--sensors /no/such.ini -o " + (folder_ / "out").string(), 20);
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.output, HasSubstr("/no/such.ini"));
  const auto unknown = live("--sensors " + sensors("[CAM]\ndriver = CNoSuchSensor\n") + " -o " +
                                (folder_ / "out").string(),
                            20);
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.output, HasSubstr("[CAM] driver = CNoSuchSensor"));
}

}  // namespace
}  // namespace headway::drivers
