// SPDX-License-Identifier: BSD-3-Clause
// Topics that another implementation publishes, as observations; and what is wrong with them.
#include <gmock/gmock.h>
#include <headway/core/mrpt_pose.h>
#include <headway/io/live_source.h>
#include <headway/io/mrpt_time.h>
#include <headway/ros2/topic_source.h>
#include <headway_test/folders.h>
#include <headway_test/waiting.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationStereoImages.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <random>
#include <thread>
#include <utility>

#include "../io/synthetic_recording.h"
#include "robot.h"
#include "stereo_writers.h"

namespace headway::ros2 {
namespace {

using test::FastDdsPeer;
using test::StereoWriters;
using test::waitUntil;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Key;
namespace dds = sensor_msgs::msg::dds_;

class TopicSourceTest : public ::testing::Test {
 protected:
  TopicSourceTest() : domain_(test::domainOfThisTest()), peer_(domain_) {
    setenv("ROS_LOCALHOST_ONLY", "1", 1);
    node_.emplace(NodeOptions{"headway", domain_, ""});
  }

  void start(const Ros2SourceParams& params = {}) {
    source_.emplace(*node_, params, TopicSourceOptions(),
                    TopicSource::Callbacks{[this](const mrpt::obs::CObservation::Ptr& observation) {
                                             const std::lock_guard lock(mutex_);
                                             ++counts_[observation->GetRuntimeClass()->className];
                                             last_[observation->GetRuntimeClass()->className] =
                                                 observation;
                                             live_.push(observation);
                                           },
                                           [this](const std::string& text) {
                                             const std::lock_guard lock(mutex_);
                                             messages_.push_back(text);
                                           },
                                           [this](const Pose& pose) {
                                             const std::lock_guard lock(mutex_);
                                             initial_pose_ = pose;
                                           }});
    source_->start();
  }

  std::size_t count(const std::string& type) {
    const std::lock_guard lock(mutex_);
    return counts_["mrpt::obs::" + type];
  }
  template <typename Observation>
  std::shared_ptr<Observation> last() {
    const std::lock_guard lock(mutex_);
    return std::dynamic_pointer_cast<Observation>(
        last_[Observation::GetRuntimeClassIdStatic().className]);
  }
  std::vector<std::string> messages() {
    const std::lock_guard lock(mutex_);
    return messages_;
  }

  bool isSaid(const std::string& part) {
    const auto all = messages();
    return std::any_of(all.begin(), all.end(),
                       [&](const auto& text) { return text.find(part) != std::string::npos; });
  }

  /// A rawlog of a camera with an inertial sensor, wheels and a laser.
  std::string rawlog(std::size_t frames) {
    const std::string path = folder_ / "robot.rawlog";
    io::RawlogSink sink(path, io::ImageStorage::kEmbedded);
    for (std::size_t i = 0; i < frames; ++i) {
      const Time time = io::test::frameTime(i);
      for (int k = 0; k < 4; ++k) {
        sink.writeImu(time - 0.08 + 0.02 * k, {0.0, 0.0, 0.1}, {0.0, 0.0, 9.81});
        sink.writeOdometry(time - 0.08 + 0.02 * k, 0.1 * static_cast<double>(i), 0.2, 0.3);
      }
      io::RecordedScan scan;
      scan.time = time - 0.01;
      scan.T_robot_laser.translation() << 0.5, 0.0, 0.2;
      scan.aperture_rad = 2.0;
      scan.max_range_m = 10.0;
      scan.ranges = {1.0F, 2.0F, 3.0F};
      sink.writeLaser(scan);
      io::RecordedGnss fix;
      fix.time = time - 0.005;
      fix.T_robot_antenna.translation() << 0.1, 0.2, 0.3;
      fix.latitude_deg = 48.5;
      fix.longitude_deg = -3.25;
      fix.altitude_m = 50.0;
      fix.satellites = 9;
      sink.writeGnss(fix);
      const auto images = io::test::wall(static_cast<int>(i));
      sink.writeStereo(time, images.left, images.right, io::rawFrom(io::test::smallCamera()));
    }
    sink.close();
    return path;
  }

  /// A rawlog of a depth camera at 30 Hz with an inertial sensor, wheels and a laser.
  std::string depthRawlog(const cv::Mat& depth, std::size_t pairs) {
    const auto timeOf = [](std::size_t i) { return 100.0 + static_cast<double>(i) / 30.0; };
    io::RawDepthCamera camera;
    for (io::RawCamera* lens : {&camera.color, &camera.depth}) {
      lens->width = depth.cols;
      lens->height = depth.rows;
      lens->fx = lens->fy = 500.0;
      lens->cx = 0.5 * depth.cols - 0.5;
      lens->cy = 0.5 * depth.rows - 0.5;
    }
    camera.T_robot_color.translation() << 0.2, 0.0, 1.0;
    camera.T_color_depth.translation().x() = 0.05;
    const std::string path = folder_ / "depth.rawlog";
    io::RawlogSink sink(path, io::ImageStorage::kEmbedded);
    const cv::Mat picture = io::test::wall(0, 8, depth.size()).left;
    io::RecordedScan scan;
    scan.aperture_rad = 2.0;
    scan.max_range_m = 10.0;
    scan.ranges = {1.0F, 2.0F, 3.0F};
    std::size_t pair = 0;
    for (std::size_t i = 0; pair < pairs; ++i) {  // at 200 Hz
      scan.time = 100.0 + 0.005 * static_cast<double>(i);
      sink.writeImu(scan.time, {0.0, 0.0, 0.1}, {0.0, 0.0, 9.81});
      if (i % 4 == 0) sink.writeOdometry(scan.time, 0.1, 0.2, 0.3);
      if (i % 20 == 0) sink.writeLaser(scan);
      if (scan.time + 0.005 > timeOf(pair)) sink.writeDepth(timeOf(pair++), picture, depth, camera);
    }
    sink.close();
    return path;
  }

  /// Plays a robot's rawlog until both sides know each other, and again; each sample arrives.
  ///
  /// @param frame  type of the observation of a pair of images
  void expectEverySample(const std::string& frame, test::Robot& robot, std::size_t pairs) {
    start();
    ASSERT_TRUE(waitUntil([&] { return robot.isWatched(); })) << source_->missing();
    const auto received = [&] {
      std::map<std::string, std::size_t> counts;
      for (const auto& status : source_->status()) counts[status.topic] = status.messages;
      return counts;
    };
    ASSERT_TRUE(waitUntil([&] {  // until the camera is mounted, too
      (void)robot.play(1.0, go_on_, {0, 15});
      return count(frame) > 0 && count("CObservation2DRangeScan") > 0 &&
             count("CObservationIMU") > 0 && count("CObservationOdometry") > 0;
    })) << source_->missing();
    auto before = received();
    ASSERT_TRUE(waitUntil([&] {  // what is under way
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
      const auto now = received();
      return std::exchange(before, now) == now;
    }));
    const auto sent_before = robot.sent();
    const std::size_t pairs_before = count(frame);
    std::size_t played = 0;
    const auto isNewest = [&] { return count(frame) - pairs_before >= played; };
    robot.on_frame = [&](Time) {  // at the camera's rate, unless the machine is busy
      ++played;
      EXPECT_TRUE(::testing::Test::HasFailure() || waitUntil(isNewest)) << played;
    };
    ASSERT_EQ(robot.play(1.0, go_on_), pairs);
    for (const auto& entry : robot.sent()) {
      const std::string& topic = entry.first;
      if (topic == "/tf_static") continue;  // was sent once
      const std::size_t number = entry.second - sent_before.at(topic);
      EXPECT_TRUE(waitUntil([&] { return received()[topic] - before[topic] >= number; })) << topic;
      EXPECT_EQ(received()[topic] - before[topic], number) << topic;
    }
    EXPECT_EQ(count(frame) - pairs_before, pairs);
  }

  int domain_;
  test::TemporaryFolder folder_;
  FastDdsPeer peer_;
  std::optional<Node> node_;
  std::mutex mutex_;
  std::map<std::string, std::size_t> counts_;  // guarded by mutex_, like the members below
  std::map<std::string, mrpt::obs::CObservation::Ptr> last_;
  std::vector<std::string> messages_;
  std::optional<Pose> initial_pose_;
  io::LiveSource live_;
  std::optional<TopicSource> source_;  // last, so that its thread ends first
  const std::atomic<bool> go_on_{false};
};

TEST_F(TopicSourceTest, ARobotsSensorsBecomeObservations) {
  test::Robot robot(peer_, rawlog(30));
  start();
  ASSERT_TRUE(waitUntil([&] { return robot.isWatched(); })) << source_->missing();
  EXPECT_EQ(robot.play(1.0, go_on_), 30U);
  EXPECT_TRUE(waitUntil([&] {
    const auto newest = last<mrpt::obs::CObservationStereoImages>();
    return newest && io::timeFrom(newest->timestamp) > io::test::frameTime(28) + 0.05;
  })) << source_->missing();
  EXPECT_GT(count("CObservationStereoImages"), 20U);
  const auto camera = io::test::smallCamera();
  const auto pair = last<mrpt::obs::CObservationStereoImages>();
  ASSERT_NE(pair, nullptr);
  EXPECT_NEAR(io::timeFrom(pair->timestamp), io::test::frameTime(29), 1e-6);
  EXPECT_NEAR(pair->leftCamera.fx(), camera.fx, 1e-9);
  EXPECT_NEAR(pair->rightCameraPose.x(), camera.baseline_m, 1e-9);
  const Pose mounting = fromMrpt(mrpt::poses::CPose3D(pair->cameraPose));
  EXPECT_TRUE(mounting.isApprox(camera.T_robot_cam, 1e-9));
  EXPECT_TRUE(io::test::sameImage(pair->imageLeft.asCvMatRef(), io::test::wall(29).left));
  EXPECT_GT(count("CObservationIMU"), 80U);
  EXPECT_NEAR(last<mrpt::obs::CObservationIMU>()->get(mrpt::obs::IMU_Z_ACC), 9.81, 1e-9);
  EXPECT_GT(count("CObservationOdometry"), 80U);
  EXPECT_NEAR(last<mrpt::obs::CObservationOdometry>()->odometry.phi(), 0.3, 1e-9);
  const auto scan = last<mrpt::obs::CObservation2DRangeScan>();
  ASSERT_NE(scan, nullptr);
  EXPECT_NEAR(scan->sensorPose.x(), 0.5, 1e-9);
  EXPECT_NEAR(scan->aperture, 2.0, 1e-5);
  const auto fix = last<mrpt::obs::CObservationGPS>();
  ASSERT_NE(fix, nullptr);
  EXPECT_NEAR(fix->sensorPose.y(), 0.2, 1e-9);
  const auto& position = fix->getMsgByClass<mrpt::obs::gnss::Message_NMEA_GGA>().fields;
  EXPECT_NEAR(position.latitude_degrees, 48.5, 1e-9);
  EXPECT_NEAR(position.longitude_degrees, -3.25, 1e-9);
  EXPECT_NEAR(position.altitude_meters, 50.0, 1e-9);
  // The robot's own odometry, for map -> odom.
  const auto odometry = source_->odometryAt(io::test::frameTime(29) - 0.03);
  ASSERT_TRUE(odometry);
  EXPECT_NEAR(odometry->translation().x(), 2.9, 1e-6);
  EXPECT_FALSE(source_->odometryAt(io::test::frameTime(29) + 100.0));
  EXPECT_NE(live_.camera(), nullptr);
}

/// With inertial samples at 200 Hz, wheels at 50 Hz and scans at 10 Hz.
TEST_F(TopicSourceTest, EverySampleOfADepthCameraAndItsSensorsArrives) {
  cv::Mat depth(480, 640, CV_16UC1);
  cv::randu(depth, 500, 9000);
  test::Robot robot(peer_, depthRawlog(depth, 90));
  expectEverySample("CObservation3DRangeScan", robot, 90);
  const auto newest = last<mrpt::obs::CObservation3DRangeScan>();
  EXPECT_NEAR(io::timeFrom(newest->timestamp), 100.0 + 89.0 / 30.0, 1e-6);
  ASSERT_EQ(newest->rangeImage.rows(), depth.rows);
  EXPECT_EQ(newest->rangeUnits * newest->rangeImage(100, 200),
            1e-3F * depth.at<std::uint16_t>(100, 200));
  const Pose T_robot_depth = fromMrpt(newest->sensorPose);
  EXPECT_NEAR(T_robot_depth.translation().y(), -0.05, 1e-9);  // right of the colour image
  EXPECT_NEAR(T_robot_depth.translation().z(), 1.0, 1e-9);
  EXPECT_NEAR(newest->cameraParamsIntensity.fx(), 500.0, 1e-9);
}

TEST_F(TopicSourceTest, EveryCompressedSampleOfADepthCameraArrives) {
  cv::Mat depth(120, 160, CV_16UC1);
  cv::randu(depth, 500, 9000);
  test::Robot robot(peer_, depthRawlog(depth, 30), true);
  expectEverySample("CObservation3DRangeScan", robot, 30);
  EXPECT_GT(robot.sent().at("/depth/image/compressedDepth"), 30U);
  const auto newest = last<mrpt::obs::CObservation3DRangeScan>();
  ASSERT_EQ(newest->rangeImage.rows(), depth.rows);
  EXPECT_EQ(newest->rangeUnits * newest->rangeImage(20, 30),
            1e-3F * depth.at<std::uint16_t>(20, 30));
}

/// 752x480 at 10 Hz, with the same other sensors.
TEST_F(TopicSourceTest, EverySampleOfAStereoCameraAndItsSensorsArrives) {
  const cv::Size size(752, 480);
  StereoCamera camera = io::test::smallCamera();
  camera.width = size.width;
  camera.height = size.height;
  constexpr std::size_t kPairs = 40;
  const std::string path = folder_ / "stereo.rawlog";
  io::RawlogSink sink(path, io::ImageStorage::kEmbedded);
  const auto images = io::test::wall(0, 8, size);
  io::RecordedScan scan;
  scan.aperture_rad = 2.0;
  scan.max_range_m = 10.0;
  scan.ranges = {1.0F, 2.0F, 3.0F};
  for (std::size_t i = 0; i < 20 * kPairs; ++i) {  // at 200 Hz
    scan.time = 100.0 + 0.005 * static_cast<double>(i);
    sink.writeImu(scan.time, {0.0, 0.0, 0.1}, {0.0, 0.0, 9.81});
    if (i % 4 == 0) sink.writeOdometry(scan.time, 0.1, 0.2, 0.3);
    if (i % 20 == 5) sink.writeLaser(scan);
    if (i % 20 == 10) sink.writeStereo(scan.time, images.left, images.right, io::rawFrom(camera));
  }
  sink.close();
  test::Robot robot(peer_, path);
  expectEverySample("CObservationStereoImages", robot, kPairs);
  const auto newest = last<mrpt::obs::CObservationStereoImages>();
  ASSERT_NE(newest, nullptr);
  EXPECT_TRUE(io::test::sameImage(newest->imageRight.asCvMatRef(), images.right));
}

TEST_F(TopicSourceTest, EverySampleThatIsSentWithBestEffortArrives) {
  test::Robot robot(peer_, rawlog(40), false, 0.0, false);
  expectEverySample("CObservationStereoImages", robot, 40);
  EXPECT_GT(count("CObservationGPS"), 0U);
}

TEST_F(TopicSourceTest, ALaterPublisherMayBeLessReliableAndIsNamed) {
  test::Robot robot(peer_, rawlog(20));
  start();
  ASSERT_TRUE(waitUntil([&] { return robot.isWatched(); }));
  ASSERT_TRUE(waitUntil([&] {
    (void)robot.play(2.0, go_on_);
    return count("CObservationIMU") > 0 && count("CObservationOdometry") > 0;
  }));
  FastDdsPeer other(domain_);
  const auto odometry = other.writer<nav_msgs::msg::dds_::Odometry_PubSubType>("rt/a_odom");
  const auto fix = other.writer<dds::NavSatFix_PubSubType>("rt/a_fix");
  const auto imu = other.writer<dds::Imu_PubSubType>("rt/imu", {false});
  EXPECT_TRUE(waitUntil([&] { return isSaid("/imu is not published as reliably as before"); }));
  EXPECT_TRUE(isSaid("/imu has 2 publishers"));
  dds::Imu_ sample;
  sample.header().frame_id("imu");
  sample.angular_velocity().x(7.0);
  EXPECT_TRUE(waitUntil([&] {
    (void)imu->write(&sample);
    return last<mrpt::obs::CObservationIMU>()->get(mrpt::obs::IMU_WX) == 7.0;
  }));
  const std::size_t before = count("CObservationIMU");
  EXPECT_TRUE(waitUntil([&] {  // the first one is still read
    (void)robot.play(2.0, go_on_);
    return last<mrpt::obs::CObservationIMU>()->get(mrpt::obs::IMU_WX) == 0.0;
  }));
  EXPECT_GT(count("CObservationIMU"), before);
  for (const auto& status : source_->status()) {  // sensors that were chosen are not replaced
    EXPECT_NE(status.topic, "/a_odom");
    EXPECT_NE(status.topic, "/a_fix");
  }
  EXPECT_FALSE(isSaid("/tf has"));
}

TEST_F(TopicSourceTest, ARobotThatIsRestartedOrSetBackIsReadAgain) {
  const std::string path = rawlog(25);
  start();
  for (const double shift_s : {0.0, 60.0, -20.0}) {
    FastDdsPeer peer(domain_);
    test::Robot robot(peer, path, true, shift_s);
    ASSERT_TRUE(waitUntil([&] { return robot.isWatched(); })) << source_->missing();
    (void)robot.play(2.0, go_on_);
    EXPECT_TRUE(waitUntil([&] {
      const auto pair = last<mrpt::obs::CObservationStereoImages>();
      return pair &&
             std::abs(io::timeFrom(pair->timestamp) - io::test::frameTime(23) - shift_s) < 0.15;
    })) << shift_s;
    const Time newest = io::test::frameTime(24) + shift_s - 0.03;
    EXPECT_TRUE(waitUntil([&] { return source_->odometryAt(newest).has_value(); })) << shift_s;
  }
}

TEST_F(TopicSourceTest, MalformedMessagesAreCountedAndNamedAndOthersStillUsed) {
  test::Robot robot(peer_, rawlog(20));
  start();
  ASSERT_TRUE(waitUntil([&] { return robot.isWatched(); }));
  const std::vector<std::pair<std::string, std::string>> topics = {
      {"/left/image", "sensor_msgs::msg::dds_::Image_"},
      {"/left/camera_info", "sensor_msgs::msg::dds_::CameraInfo_"},
      {"/imu", "sensor_msgs::msg::dds_::Imu_"},
      {"/odom", "nav_msgs::msg::dds_::Odometry_"},
      {"/scan", "sensor_msgs::msg::dds_::LaserScan_"},
      {"/tf", "tf2_msgs::msg::dds_::TFMessage_"}};
  std::mt19937 random(7);
  const auto randomBytes = [&] {
    std::string bytes(4 + random() % 300, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    return bytes;
  };
  using Writers = std::vector<std::unique_ptr<FastDdsPeer::Writer>>;
  const auto addWriters = [&](FastDdsPeer& peer, Writers& writers) {
    for (const auto& [topic, type] : topics) {
      writers.push_back(peer.bytesWriter("rt" + topic, type));
    }
    return waitUntil([&] {
      return std::all_of(writers.begin(), writers.end(),
                         [](const auto& writer) { return writer->matched() > 0; });
    });
  };
  // Without a header of CDR: Cyclone DDS drops them.
  FastDdsPeer other(domain_);
  Writers headless;
  ASSERT_TRUE(addWriters(other, headless));
  EXPECT_TRUE(waitUntil([&] { return isSaid("/left/image has 2 publishers"); }));
  for (std::size_t i = 0; i < 2500; ++i) {
    std::string bytes = randomBytes();
    (void)headless[i % headless.size()]->write(&bytes);
  }
  // CDR with any contents, some of absurd sizes. Writers keep 10: they wait for their reader.
  FastDdsPeer another(domain_);
  Writers writers;
  ASSERT_TRUE(addWriters(another, writers));
  const auto received = [&] {
    std::size_t count = 0;
    for (const auto& status : source_->status()) count += status.messages;
    return count;
  };
  const auto write = [&](std::size_t i) {
    std::string bytes = randomBytes().replace(0, 4, std::string("\0\1\0\0", 4));
    if (i % 7 == 0) bytes.replace(4, 12, std::string(12, '\xFF'));
    (void)writers[i % writers.size()]->write(&bytes);
    return received();
  };
  for (std::size_t i = 0; i < writers.size(); ++i) {  // until they know each other
    const auto before = received();
    ASSERT_TRUE(waitUntil([&] { return write(i) > before; }));
  }
  const std::size_t before = received();
  constexpr std::size_t kMessages = 7500;
  for (std::size_t i = 0; i < kMessages; i += 30) {
    for (std::size_t k = 0; k < 30; ++k) (void)write(i + k);
    ASSERT_TRUE(waitUntil([&] { return received() >= before + i + 30; })) << i;
  }
  (void)robot.play(1.0, go_on_);
  EXPECT_TRUE(waitUntil([&] {
    const auto pair = last<mrpt::obs::CObservationStereoImages>();
    return pair && io::timeFrom(pair->timestamp) > io::test::frameTime(17);
  })) << source_->missing();
  const auto skipped = source_->skipped();
  for (const auto& type : {"Image", "CameraInfo", "Imu", "LaserScan"}) {
    EXPECT_THAT(skipped, Contains(Key("unreadable_sensor_msgs/" + std::string(type))));
  }
  EXPECT_THAT(skipped, Contains(Key("unreadable_nav_msgs/Odometry")));
  EXPECT_THAT(skipped, Contains(Key("unreadable_tf2_msgs/TFMessage")));
  std::size_t unreadable = 0;
  for (const auto& [reason, number] : skipped) unreadable += reason[0] == 'u' ? number : 0;
  EXPECT_GE(unreadable, kMessages);
  EXPECT_THAT(messages(), Contains(HasSubstr("unreadable_sensor_msgs/Image (/left/image: ")));
  EXPECT_LT(messages().size(), 60U);  // not one for each
}

TEST_F(TopicSourceTest, OddValuesTypesAndTimesAreNamed) {
  test::Robot robot(peer_, rawlog(10));
  start();
  ASSERT_TRUE(waitUntil([&] { return robot.isWatched(); }));
  (void)robot.play(1.0, go_on_);
  ASSERT_TRUE(waitUntil([&] { return source_->missing().empty(); })) << source_->missing();
  FastDdsPeer other(domain_);
  const auto text = other.bytesWriter("rt/left/image", "std_msgs::msg::dds_::String_");
  const auto imu = other.writer<dds::Imu_PubSubType>("rt/imu");
  const auto image = other.writer<dds::Image_PubSubType>("rt/right/image");
  const auto scan = other.writer<dds::LaserScan_PubSubType>("rt/scan");
  const auto odometry = other.writer<nav_msgs::msg::dds_::Odometry_PubSubType>("rt/odom");
  const auto tf = other.writer<tf2_msgs::msg::dds_::TFMessage_PubSubType>("rt/tf");
  const auto initial = other.writer<geometry_msgs::msg::dds_::PoseWithCovarianceStamped_PubSubType>(
      "rt/initialpose");
  const auto fix = other.writer<dds::NavSatFix_PubSubType>("rt/fix");
  // Each until it is counted: both sides keep the newest messages alone.
  const auto isCounted = [&](const std::string& reason, const auto& write) {
    return waitUntil([&] {
      write();
      return source_->skipped().count(reason) > 0;
    });
  };
  dds::Imu_ sample;
  sample.header().frame_id("imu");
  sample.angular_velocity().x(std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(isCounted("imu_not_finite", [&] { imu->write(&sample); }));
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  sample.angular_velocity().x(7.0);  // of a gyroscope alone
  sample.linear_acceleration().x(kNan);
  sample.linear_acceleration_covariance()[0] = -1.0;
  EXPECT_TRUE(waitUntil([&] {
    (void)imu->write(&sample);
    const auto newest = last<mrpt::obs::CObservationIMU>();
    return newest && newest->get(mrpt::obs::IMU_WX) == 7.0 && !newest->has(mrpt::obs::IMU_X_ACC);
  }));
  nav_msgs::msg::dds_::Odometry_ pose;
  pose.pose().pose().orientation().w(kNan);
  EXPECT_TRUE(isCounted("unreadable_nav_msgs/Odometry", [&] { odometry->write(&pose); }));
  tf2_msgs::msg::dds_::TFMessage_ transforms;
  transforms.transforms().resize(1);
  transforms.transforms()[0].transform().rotation().w(1.0);
  transforms.transforms()[0].transform().translation().y(kNan);
  EXPECT_TRUE(isCounted("unreadable_tf2_msgs/TFMessage", [&] { tf->write(&transforms); }));
  geometry_msgs::msg::dds_::PoseWithCovarianceStamped_ start_pose;
  start_pose.header().frame_id("map");
  start_pose.pose().pose().orientation().w(1.0);
  start_pose.pose().pose().position().x(kNan);
  EXPECT_TRUE(isCounted("unreadable_geometry_msgs/PoseWithCovarianceStamped",
                        [&] { initial->write(&start_pose); }));
  dds::NavSatFix_ position;
  position.header().frame_id("gnss");
  position.latitude(kNan);
  EXPECT_TRUE(isCounted("gnss_no_position", [&] { fix->write(&position); }));
  EXPECT_TRUE(isSaid("gnss_no_position (/fix)"));
  dds::Image_ picture;
  const auto setSize = [&](std::uint32_t width, std::uint32_t height) {
    picture.width(width);
    picture.height(height);
    picture.step(width);
    picture.data().resize(std::size_t{width} * height);
  };
  picture.encoding("mono8");
  setSize(64, 48);
  EXPECT_TRUE(isCounted("image_size", [&] { image->write(&picture); }));
  setSize(160, 120);
  picture.header().stamp().sec(900);
  EXPECT_TRUE(isCounted("unpaired_image", [&] {  // without images of the left camera
    picture.header().stamp().sec(picture.header().stamp().sec() + 1);
    image->write(&picture);
  }));
  picture.encoding("16SC3");
  EXPECT_TRUE(isCounted("image_encoding_16SC3", [&] { image->write(&picture); }));
  picture.encoding("mono8");
  picture.width(4'000'000'000);
  EXPECT_TRUE(isCounted("broken_image", [&] { image->write(&picture); }));
  dds::LaserScan_ rays;
  rays.header().frame_id("laser");
  rays.angle_increment(std::numeric_limits<float>::infinity());
  rays.ranges().resize(3);
  EXPECT_TRUE(isCounted("broken_scan", [&] { scan->write(&rays); }));
  EXPECT_TRUE(
      waitUntil([&] { return isSaid("/left/image is published as std_msgs/String, too"); }));
}

/// Before both are usable; base_frame waits for tf.
TEST_F(TopicSourceTest, TransformsAndCalibrationMayComeLateOrWrongAtFirst) {
  Ros2SourceParams params;
  params.base_frame = "base_link";
  StereoWriters camera(peer_);
  start(params);
  const auto isMissing = [&](const std::string& part) {
    return waitUntil([&] {
      camera.write(0.0);
      return source_->missing().find(part) != std::string::npos;
    });
  };
  EXPECT_TRUE(isMissing("[ros2] base_frame = base_link: tf does not connect it with 'left'"))
      << source_->missing();
  camera.mount();
  EXPECT_TRUE(isMissing("the camera was not calibrated (K is zero)")) << source_->missing();
  camera.info.k()[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(waitUntil([&] {
    camera.write(0.0);
    const std::string missing = source_->missing();
    return missing.find("/camera_info: ") != std::string::npos &&
           missing.find("zero") == std::string::npos;
  })) << source_->missing();
  EXPECT_EQ(count("CObservationStereoImages"), 0U);
  camera.setFocal(50.0);
  EXPECT_TRUE(waitUntil([&] {
    camera.write(0.1);
    return count("CObservationStereoImages") > 0;
  })) << source_->missing();
  EXPECT_EQ(source_->missing(), "");
  const auto pair = last<mrpt::obs::CObservationStereoImages>();
  ASSERT_NE(pair, nullptr);
  EXPECT_EQ(pair->leftCamera.fx(), 50.0);
  EXPECT_NEAR(pair->rightCameraPose.x(), 0.1, 1e-9);
  EXPECT_NEAR(pair->cameraPose.x(), 0.25, 1e-9);
  EXPECT_FALSE(isSaid("only now"));
  EXPECT_FALSE(isSaid("not what it was"));
  camera.setFocal(60.0);  // of a driver that was restarted
  EXPECT_TRUE(waitUntil([&] {
    camera.write(0.1);
    return isSaid("/left/camera_info is not what it was at the start, which is still used");
  }));
}

TEST_F(TopicSourceTest, TransformsThatComeTooLateAreNamed) {
  StereoWriters camera(peer_);
  camera.setFocal(50.0);
  start();
  EXPECT_TRUE(waitUntil([&] {
    camera.write(0.1);
    return count("CObservationStereoImages") > 0;
  })) << source_->missing();
  EXPECT_TRUE(isSaid("the mounting of the camera is unknown"));
  EXPECT_TRUE(isSaid("([ros2] base_frame = FRAME)"));
  EXPECT_FALSE(isSaid("tf mounts the camera"));
  camera.mount();
  EXPECT_TRUE(waitUntil([&] { return isSaid("tf mounts the camera on base_link only now"); }));
}

TEST_F(TopicSourceTest, TheRobotsFrameIsThatWhichCarriesTheCamera) {
  StereoWriters camera(peer_);
  camera.setFocal(50.0);
  start();
  EXPECT_EQ(source_->robotFrame(), "base_link");
  EXPECT_TRUE(waitUntil([&] {
    camera.mount("base", true);
    camera.write(0.1);
    return count("CObservationStereoImages") > 0 && source_->robotFrame() == "base";
  })) << source_->missing();
  EXPECT_TRUE(waitUntil([&] {
    camera.mount("base", true);
    const auto odometry = source_->odometryAt(100.0);
    return odometry && odometry->translation().x() == 5.0;
  }));
}

TEST_F(TopicSourceTest, OfASensorInTwoTopicsZerosOfTheOtherHalfAreNoMeasurement) {
  StereoWriters camera(peer_);
  camera.setFocal(50.0);
  camera.mount();
  using ImuType = sensor_msgs::msg::dds_::Imu_PubSubType;
  const auto gyro = peer_.writer<ImuType>("rt/imu/gyro/sample");
  const auto accel = peer_.writer<ImuType>("rt/imu/accel/sample");
  start();
  const auto isReceived = [&](FastDdsPeer::Writer& writer, const auto& has) {
    sensor_msgs::msg::dds_::Imu_ message;
    message.header().frame_id("left");
    if (&writer == gyro.get()) message.angular_velocity().z(0.3);
    if (&writer == accel.get()) message.linear_acceleration().z(9.81);
    return waitUntil([&] {
      camera.write(0.1);
      EXPECT_TRUE(writer.write(&message));
      const auto sample = last<mrpt::obs::CObservationIMU>();
      return sample && has(*sample);
    });
  };
  using mrpt::obs::IMU_WZ, mrpt::obs::IMU_Z_ACC;
  EXPECT_TRUE(isReceived(*gyro, [](const auto& s) { return s.has(IMU_WZ) && !s.has(IMU_Z_ACC); }));
  EXPECT_TRUE(isReceived(*accel, [](const auto& s) { return s.has(IMU_Z_ACC) && !s.has(IMU_WZ); }));
}

/// A camera on a joint; that the robot drives is no reason.
TEST_F(TopicSourceTest, AMountingThatMovesIsNamed) {
  StereoWriters camera(peer_);
  camera.setFocal(50.0);
  camera.mount("mast");
  const auto tf = peer_.writer<tf2_msgs::msg::dds_::TFMessage_PubSubType>("rt/tf");
  tf2_msgs::msg::dds_::TFMessage_ message;
  message.transforms().resize(2);
  auto& driving = message.transforms()[0];
  driving.header().frame_id("odom");
  driving.child_frame_id("base_link");
  driving.transform().rotation().w(1.0);
  auto& joint = message.transforms()[1];
  joint.header().frame_id("base_link");
  joint.child_frame_id("mast");
  joint.transform().rotation().w(1.0);
  Ros2SourceParams params;
  params.base_frame = "base_link";
  start(params);
  const auto write = [&] {
    driving.transform().translation().x(driving.transform().translation().x() + 0.1);
    (void)tf->write(&message);
    camera.write(0.1);
  };
  ASSERT_TRUE(waitUntil([&] {
    write();
    return count("CObservationStereoImages") > 5;
  })) << source_->missing();
  EXPECT_FALSE(isSaid("moves"));
  joint.transform().translation().z(0.5);
  EXPECT_TRUE(waitUntil([&] {
    write();
    return isSaid("the mounting of left moves by that of mast: it is taken as at the start");
  }));
}

/// Even if another program publishes transforms that are not kept, before.
TEST_F(TopicSourceTest, TransformsThatWereSentBeforeAreReadBesideLooserPublishers) {
  using Transforms = tf2_msgs::msg::dds_::TFMessage_PubSubType;
  const auto loose = peer_.writer<Transforms>("rt/tf_static", {true, false, 1});
  Ros2SourceParams params;
  params.base_frame = "base_link";
  start(params);
  EXPECT_TRUE(waitUntil([&] { return isSaid("/tf_static is not published as reliably"); }));
  tf2_msgs::msg::dds_::TFMessage_ message;
  EXPECT_TRUE(waitUntil([&] {
    (void)loose->write(&message);
    const auto topics = source_->status();
    return std::any_of(topics.begin(), topics.end(), [](const auto& topic) {
      return topic.topic == "/tf_static" && topic.messages > 0;
    });
  }));
  FastDdsPeer later(domain_);
  StereoWriters camera(later);
  camera.setFocal(50.0);
  camera.mount();  // before the node knows of it
  EXPECT_TRUE(waitUntil([&] {
    camera.write(0.1);
    return count("CObservationStereoImages") > 0;
  })) << source_->missing();
}

TEST_F(TopicSourceTest, ReasonsThatMessagesInventAreBounded) {
  test::Robot robot(peer_, rawlog(3));
  start();
  ASSERT_TRUE(waitUntil([&] { return robot.isWatched(); }));
  const auto image = peer_.writer<dds::Image_PubSubType>("rt/left/image");
  dds::Image_ picture;
  picture.height(48);
  picture.width(64);
  picture.step(64);
  picture.data().resize(64UL * 48UL);
  std::size_t written = 0;
  ASSERT_TRUE(waitUntil([&] {
    for (int i = 0; i < 5; ++i) {  // fewer than both sides keep
      picture.encoding(std::to_string(++written) + std::string(10000, 'x'));
      image->write(&picture);
    }
    const auto skipped = source_->skipped();
    const auto others = skipped.find("other_reasons");
    return others != skipped.end() && others->second > 100;
  }));
  std::size_t bytes = 0;
  const auto skipped = source_->skipped();
  for (const auto& [reason, count] : skipped) bytes += reason.size();
  EXPECT_LT(bytes, 50000U);
  EXPECT_LT(skipped.size(), 250U);
  EXPECT_LT(messages().size(), 250U);
}

TEST_F(TopicSourceTest, TheInitialPoseIsPassedOn) {
  start();
  const auto writer = peer_.writer<geometry_msgs::msg::dds_::PoseWithCovarianceStamped_PubSubType>(
      "rt/initialpose");
  ASSERT_TRUE(waitUntil([&] { return writer->matched() > 0; }));
  geometry_msgs::msg::dds_::PoseWithCovarianceStamped_ pose;
  pose.pose().pose().position().x(3.0);
  pose.pose().pose().orientation().z(std::sqrt(0.5));
  pose.pose().pose().orientation().w(std::sqrt(0.5));
  pose.header().frame_id("odom");
  ASSERT_TRUE(waitUntil([&] {
    (void)writer->write(&pose);
    return source_->skipped().count("initial_pose_not_in_frame_map") > 0;
  }));
  EXPECT_TRUE(isSaid("initial_pose_not_in_frame_map (in \"odom\")"));
  EXPECT_FALSE(initial_pose_.has_value());
  pose.header().frame_id("/map");  // as older programs write it
  ASSERT_TRUE(waitUntil([&] {      // until the subscription knows of the publication, too
    (void)writer->write(&pose);
    const std::lock_guard lock(mutex_);
    return initial_pose_.has_value();
  }));
  EXPECT_NEAR(initial_pose_->translation().x(), 3.0, 1e-12);
  EXPECT_NEAR(yawOf(*initial_pose_), M_PI / 2, 1e-9);
}

/// The node goes on without it; what comes then is of nobody.
TEST_F(TopicSourceTest, ASourceThatEndsIsNotCalledAnyMore) {
  const auto writer = peer_.writer<tf2_msgs::msg::dds_::TFMessage_PubSubType>("rt/tf");
  tf2_msgs::msg::dds_::TFMessage_ message;
  for (int i = 0; i < 2; ++i) {
    start();
    EXPECT_TRUE(waitUntil([&] {
      (void)writer->write(&message);
      const auto topics = source_->status();
      return std::any_of(topics.begin(), topics.end(),
                         [](const auto& topic) { return topic.messages > 0; });
    }));
    source_.reset();
    EXPECT_TRUE(writer->write(&message));
    EXPECT_THAT(listOfTopics(*node_, {}), HasSubstr("/tf  tf2_msgs/TFMessage"));
  }
}

TEST_F(TopicSourceTest, TheListSaysWhatTopicsAreUsedFor) {
  test::Robot robot(peer_, rawlog(3));
  const auto other = peer_.writer<nav_msgs::msg::dds_::Odometry_PubSubType>("rt/headway/odometry");
  Ros2SourceParams params;
  params.odometry = "/headway/odometry";
  EXPECT_THAT(listOfTopics(*node_, params), HasSubstr("1 publisher, reliable  <- odometry"));
  const std::string list = listOfTopics(*node_, {});
  EXPECT_THAT(list, HasSubstr("/headway/odometry  nav_msgs/Odometry  1 publisher, reliable\n"));
  EXPECT_THAT(list, HasSubstr("/odom  nav_msgs/Odometry  1 publisher, reliable  <- odometry"));
  EXPECT_THAT(list, HasSubstr("/left/image  sensor_msgs/Image  1 publisher, reliable  <- left"));
  EXPECT_THAT(list, HasSubstr("/imu  sensor_msgs/Imu  1 publisher, reliable  <- inertial samples"));
  EXPECT_THAT(list, HasSubstr("/scan  sensor_msgs/LaserScan"));
}

}  // namespace
}  // namespace headway::ros2
