// SPDX-License-Identifier: BSD-3-Clause
// Sensors without hardware: a driver of the test's own, and MRPT's camera driver on files.
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/drivers/sensor_group.h>
#include <headway/io/live_source.h>
#include <headway/io/raw_camera.h>
#include <headway_test/folders.h>
#include <headway_test/paths.h>
#include <headway_test/waiting.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/hwdrivers/CGenericSensor.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationStereoImages.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "../io/foreign_recording.h"
#include "../io/synthetic_recording.h"

namespace headway::drivers {

/// Delivers an observation at each call: `kind` = imu, laser or odometry. After `fail_after` of
/// them it throws, after `silent_after` it delivers nothing. All block while `blocks` is set.
class TestSensor : public mrpt::hwdrivers::CGenericSensor {
  DEFINE_GENERIC_SENSOR(TestSensor)

 public:
  static inline std::atomic<bool> blocks{false};
  static inline std::atomic<int> blocked{0};  ///< drivers

  void doProcess() override {
    ++blocked;
    while (blocks) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    --blocked;
    if (count_ == fail_after_) throw std::runtime_error("the plug was pulled");
    if (count_++ >= silent_after_) return;
    mrpt::obs::CObservation::Ptr observation;
    if (kind_ == "imu") observation = mrpt::obs::CObservationIMU::Create();
    if (kind_ == "laser") observation = mrpt::obs::CObservation2DRangeScan::Create();
    if (kind_ == "odometry") observation = mrpt::obs::CObservationOdometry::Create();
    observation->timestamp = mrpt::Clock::now();
    observation->sensorLabel = m_sensorLabel;
    appendObservation(observation);
  }

 protected:
  void loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& configuration,
                                 const std::string& section) override {
    kind_ = configuration.read_string(section, "kind", "", true);
    fail_after_ = configuration.read_int(section, "fail_after", 1 << 30);
    silent_after_ = configuration.read_int(section, "silent_after", 1 << 30);
  }

 private:
  std::string kind_;
  int fail_after_ = 0;
  int silent_after_ = 0;
  int count_ = 0;
};

}  // namespace headway::drivers

IMPLEMENTS_GENERIC_SENSOR(TestSensor, headway::drivers)

namespace headway::drivers {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

/// Collects what sensors deliver.
class SensorGroupTest : public ::testing::Test {
 protected:
  SensorGroupTest() { TestSensor::doRegister(); }

  std::unique_ptr<SensorGroup> group(const std::string& ini,
                                     const SensorGroupOptions& options = {0.01, 0.1}) {
    const mrpt::config::CConfigFileMemory configuration(ini);
    return std::make_unique<SensorGroup>(
        configuration, [this](const auto& observation) { received_.push_back(observation); },
        [this](const auto& message) { messages_.push_back(message); }, options);
  }

  /// Runs the sensors until each has delivered so many observations.
  void runUntil(SensorGroup& sensors, std::size_t observations) {
    sensors.start();
    const auto done = [&] {
      for (const auto& status : sensors.status()) {
        if (status.observations < observations) return false;
      }
      return true;
    };
    EXPECT_TRUE(test::waitUntil(done)) << (messages_.empty() ? "no message" : messages_.front());
    sensors.stop();
  }

  template <typename Kind>
  std::size_t count(const std::string& label) const {
    std::size_t number = 0;
    for (const auto& observation : received_) {
      const bool is_kind = dynamic_cast<const Kind*>(observation.get()) != nullptr;
      number += is_kind && observation->sensorLabel == label ? 1 : 0;
    }
    return number;
  }

  std::string errorFor(const std::string& ini) {
    return io::test::errorOf([&] { (void)group(ini); });
  }

  std::vector<mrpt::obs::CObservation::Ptr> received_;
  std::vector<std::string> messages_;
};

TEST_F(SensorGroupTest, DeliversInertialSamplesScansAndOdometry) {
  const auto sensors = group(
      "[global]\nrawlog_prefix = x\n"
      "[A]\ndriver = TestSensor\nkind = imu\nsensorLabel = imu\nprocess_rate = 200\n"
      "[B]\ndriver = TestSensor\nkind = laser\nsensorLabel = front\nprocess_rate = 100\n"
      "[C]\ndriver = TestSensor\nkind = odometry\nsensorLabel = wheels\nprocess_rate = 100\n"
      "[D]\ndriver = TestSensor\nkind = imu\nrawlog-grabber-ignore = true\n");
  runUntil(*sensors, 5);
  EXPECT_THAT(sensors->status(), SizeIs(3));
  EXPECT_GE(count<mrpt::obs::CObservationIMU>("imu"), 5u);
  EXPECT_GE(count<mrpt::obs::CObservation2DRangeScan>("front"), 5u);
  EXPECT_GE(count<mrpt::obs::CObservationOdometry>("wheels"), 5u);
  EXPECT_THAT(messages_, SizeIs(0));
}

TEST_F(SensorGroupTest, StartsASensorAgainThatFails) {
  const auto sensors =
      group("[A]\ndriver = TestSensor\nkind = imu\nfail_after = 3\nprocess_rate = 500\n");
  runUntil(*sensors, 10);
  EXPECT_GE(sensors->status().front().restarts, 3u);
  ASSERT_FALSE(messages_.empty());
  EXPECT_THAT(messages_.front(), HasSubstr("sensor [A]: the plug was pulled"));
}

TEST_F(SensorGroupTest, StartsASensorAgainThatFallsSilent) {
  const auto sensors =
      group("[A]\ndriver = TestSensor\nkind = imu\nsilent_after = 3\nprocess_rate = 500\n");
  runUntil(*sensors, 7);
  EXPECT_GE(sensors->status().front().restarts, 2u);
  ASSERT_FALSE(messages_.empty());
  EXPECT_THAT(messages_.front(), HasSubstr("no observation"));
}

TEST_F(SensorGroupTest, ADriverThatDoesNotReturnIsNamedAndNotWaitedFor) {
  auto sensors = group("[A]\ndriver = TestSensor\nkind = imu\n", {0.01, 5.0, 0.1});
  TestSensor::blocks = true;
  sensors->start();
  EXPECT_TRUE(test::waitUntil([] { return TestSensor::blocked == 1; }));
  EXPECT_FALSE(sensors->stop());
  EXPECT_FALSE(sensors->stop()) << "nor later";
  EXPECT_THAT(messages_, ElementsAre("sensor [A]: its driver does not return; it is left"));
  sensors.reset();
  TestSensor::blocks = false;
  EXPECT_TRUE(test::waitUntil([] { return TestSensor::blocked == 0; }));
  EXPECT_THAT(received_, SizeIs(0));
}

TEST_F(SensorGroupTest, MistakesOfTheConfigurationNameTheSection) {
  EXPECT_THAT(errorFor("[global]\na = 1\n"), HasSubstr("driver"));
  EXPECT_THAT(errorFor("[A]\ndriver = CNoSuchSensor\n"), HasSubstr("[A] driver = CNoSuchSensor"));
  EXPECT_THAT(errorFor("[A]\ndriver = TestSensor\n"), HasSubstr("[A] "));
}

TEST_F(SensorGroupTest, CamerasOfRawlogsArePacedByTheProcessRate) {
  const std::string rawlog = std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/street.rawlog";
  const auto sensors =
      group("[CAM]\ndriver = CCameraSensor\ngrabber_type = rawlog\nrawlog_file = " + rawlog +
                "\nprocess_rate = 20\nsensorLabel = stereo\n",
            {0.01, 5.0});
  const auto start = std::chrono::steady_clock::now();
  runUntil(*sensors, 6);
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(240));
  EXPECT_EQ(count<mrpt::obs::CObservationStereoImages>("stereo"), received_.size());
}

TEST_F(SensorGroupTest, ImagesWithoutCalibrationGetTheGivenOne) {
  const test::TemporaryFolder folder;
  constexpr int kPairs = 6;
  for (int i = 0; i < kPairs; ++i) {
    const auto wall = io::test::wall(i);
    const std::string number = std::to_string(i) + ".png";
    cv::imwrite(folder / ("left" + number), wall.left);
    cv::imwrite(folder / ("right" + number), wall.right);
  }
  const auto sensors = group(
      "[CAM]\ndriver = CCameraSensor\ngrabber_type = image_dir\nprocess_rate = 20\n"
      "image_dir_url = " +
      (folder / "").string() +
      "\nleft_format = left%d.png\nright_format = right%d.png\n"
      "start_index = 0\nend_index = 5\nsensorLabel = CAM\n");
  runUntil(*sensors, kPairs);
  io::LiveSource source;
  for (const auto& observation : received_) {
    auto& stereo = dynamic_cast<mrpt::obs::CObservationStereoImages&>(*observation);
    io::setCalibration(io::rawFrom(io::test::smallCamera()), stereo);
    source.push(observation);
  }
  source.close();
  const auto live = source.next();
  ASSERT_TRUE(live) << ::testing::PrintToString(source.skipped());
  EXPECT_NEAR(live->frame.stereo->camera->baseline_m, io::test::smallCamera().baseline_m, 1e-9);
}

}  // namespace
}  // namespace headway::drivers
