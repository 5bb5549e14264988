// SPDX-License-Identifier: BSD-3-Clause
// Poses between frames, transforms beside the robot's own odometry, and what is left out.
#include <gmock/gmock.h>
#include <headway/io/mrpt_time.h>
#include <headway/map/local_layer.h>
#include <headway/ros2/topic_sink.h>
#include <headway_test/waiting.h>
#include <headway_test/walking_track.h>
#include <mrpt/maps/CColouredPointsMap.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <random>
#include <set>
#include <thread>

#include "fast_dds_peer.h"

namespace headway::ros2 {
namespace {

using nav_msgs::msg::dds_::Odometry_PubSubType;
using test::FastDdsPeer;
using test::waitUntil;
using tf2_msgs::msg::dds_::TFMessage_PubSubType;

Pose planar(double x, double yaw = 0.0) {
  Pose pose = Pose::Identity();
  pose.translation().x() = x;
  pose.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return pose;
}

class TopicSinkTest : public ::testing::Test {
 protected:
  TopicSinkTest() : domain_(test::domainOfThisTest()), peer_(domain_) {
    setenv("ROS_LOCALHOST_ONLY", "1", 1);
    node_.emplace(NodeOptions{"headway", domain_, ""});
  }

  void start(const Ros2SinkParams& params, TopicSink::Hooks hooks = {}) {
    odometry_ = peer_.reader<Odometry_PubSubType>(
        "rt/headway/odometry", {true, false, 1000}, [this](const auto& message) {
          const std::lock_guard lock(mutex_);
          const auto& stamp = message.header().stamp();
          samples_.emplace_back(stamp.sec() + 1e-9 * stamp.nanosec(),
                                message.pose().pose().position().x());
          frame_ = message.header().frame_id();
          const auto& axes = message.pose().pose().orientation();
          yaw_ = 2.0 * std::atan2(axes.z(), axes.w());
        });
    transforms_ = peer_.reader<TFMessage_PubSubType>(
        "rt/tf", {true, false, 1000}, [this](const auto& message) {
          const std::lock_guard lock(mutex_);
          for (const auto& transform : message.transforms()) {
            edges_[transform.header().frame_id() + ">" + transform.child_frame_id()] =
                transform.transform().translation().x();
          }
        });
    sink_.emplace(*node_, params, std::move(hooks));
    ASSERT_TRUE(waitUntil([&] { return odometry_->matched() > 0 && transforms_->matched() > 0; }));
    Time time = 1.0;  // the writers know their readers a little later
    ASSERT_TRUE(waitUntil([&] {
      addFrame(time += 0.01, planar(0.0), planar(0.0));
      return !edges().empty() && !samples().empty();
    }));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // what is under way
    const std::lock_guard lock(mutex_);
    edges_.clear();
    samples_.clear();
  }

  void addFrame(Time time, const Pose& T_odom_robot, const Pose& T_map_odom,
                slam::TrackingStatus status = slam::TrackingStatus::kTracked, int submap = 0) {
    run::FrameResult result;
    result.update.time = time;
    result.update.camera.status = status;
    result.update.camera.submap = submap;
    result.update.camera.T_odom_robot = T_odom_robot;
    result.update.camera.T_map_odom = T_map_odom;
    result.update.camera.T_map_robot = T_map_odom * T_odom_robot;
    sink_->onLocal(time, result.update.camera, perception_.map());
    sink_->onFrame(result, perception_);
  }
  void addRate(Time time, double rate) {
    mrpt::obs::CObservationIMU imu;
    imu.timestamp = io::mrptTime(time);
    for (const auto axis : {mrpt::obs::IMU_WX, mrpt::obs::IMU_WY}) imu.set(axis, 0.0);
    imu.set(mrpt::obs::IMU_WZ, rate);
    sink_->addObservation(imu);
  }
  void addWheels(Time time, double x) {
    mrpt::obs::CObservationOdometry wheels;
    wheels.timestamp = io::mrptTime(time);
    wheels.odometry = mrpt::poses::CPose2D(x, 0.0, 0.0);
    sink_->addObservation(wheels);
  }

  std::map<std::string, double> edges() {
    const std::lock_guard lock(mutex_);
    return edges_;
  }
  std::vector<std::pair<Time, double>> samples() {
    const std::lock_guard lock(mutex_);
    return samples_;
  }

  int domain_;
  FastDdsPeer peer_;
  std::optional<Node> node_;
  pipeline::Perception perception_{nullptr, {}};
  std::mutex mutex_;
  std::vector<std::pair<Time, double>> samples_;  // guarded by mutex_, like the members below
  std::map<std::string, double> edges_;           // x of transforms
  std::string frame_;
  double yaw_ = 0.0;
  std::unique_ptr<FastDdsPeer::Reader> odometry_, transforms_;
  std::optional<TopicSink> sink_;
};

TEST_F(TopicSinkTest, WheelsMoveTheOdometryOnBetweenFrames) {
  Ros2SinkParams params;
  params.odom_base = true;
  start(params);
  // The robot drives at 1 m/s; wheels started elsewhere, images arrive 0.1 s late.
  for (int i = 1; i <= 60; ++i) {
    const Time time = 100.0 + 0.02 * i;
    addWheels(time, 7.0 + 0.02 * i);
    if (i % 5 == 0 && i > 10) addFrame(time - 0.1, planar(0.02 * i - 0.1), planar(1.0));
  }
  ASSERT_TRUE(waitUntil([&] {
    const auto received = samples();
    return received.size() >= 45 && received.back().first > 101.19;
  })) << samples().size();
  Time last = 0.0;
  for (const auto& [time, x] : samples()) {
    EXPECT_GT(time, last);
    last = time;
    EXPECT_NEAR(x, time - 100.0, 1e-4) << time;
  }
  EXPECT_NEAR(last, 101.2, 1e-5);
  EXPECT_EQ(frame_, "odom");
  EXPECT_NEAR(edges().at("map>odom"), 1.0, 1e-12);
  EXPECT_EQ(edges().count("odom>base_link"), 1U);
}

TEST_F(TopicSinkTest, TheGyroscopeDoesAtConstantSpeed) {
  start({});
  addFrame(100.0, planar(0.0), planar(0.0));
  addFrame(100.1, planar(0.05), planar(0.0));
  for (int i = 1; i <= 10; ++i) addRate(100.1 + 0.02 * i, 0.0);
  ASSERT_TRUE(waitUntil([&] {
    const auto received = samples();
    return received.size() >= 11 && received.back().first > 100.29;
  })) << samples().size();
  EXPECT_NEAR(samples().back().first, 100.3, 1e-5);
  EXPECT_NEAR(samples().back().second, 0.15, 1e-6);
}

TEST_F(TopicSinkTest, TheGyroscopeMayBeMountedOnItsSide) {
  start({});
  addFrame(100.0, planar(0.0), planar(0.0));
  addFrame(100.1, planar(0.0), planar(0.0));
  mrpt::obs::CObservationIMU imu;
  imu.sensorPose =
      mrpt::poses::CPose3D(0.0, 0.0, 0.0, 0.0, 0.0, M_PI / 2);  // its y is the robot's z
  for (const auto axis : {mrpt::obs::IMU_WX, mrpt::obs::IMU_WZ}) imu.set(axis, 0.0);
  imu.set(mrpt::obs::IMU_WY, 0.5);
  for (int i = 1; i <= 10; ++i) {
    imu.timestamp = io::mrptTime(100.1 + 0.02 * i);
    sink_->addObservation(imu);
  }
  ASSERT_TRUE(waitUntil([&] { return !samples().empty() && samples().back().first > 100.29; }));
  const std::lock_guard lock(mutex_);
  EXPECT_NEAR(yaw_, 0.5 * 0.2, 1e-5);
}

/// At times of today, whose stamps are rounded, and with jitter.
TEST_F(TopicSinkTest, SensorsOf30HzOrMoreGiveOdometryAt30Hz) {
  start({});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-1e-3, 1e-3);
  Time begin = 1'700'000'000.0;
  const auto fewestInASecond = [&](double hz, const auto& add) {
    begin += 100.0;
    int frames = 0;
    for (int i = 0; i < 4.2 * hz; ++i) {
      const Time time = begin + i / hz + jitter(random);
      for (; begin + 0.1 * frames < time - 0.1; ++frames) {  // at 10 Hz, and as late
        addFrame(begin + 0.1 * frames, planar(0.1 * frames), planar(0.0));
      }
      add(time, time - begin);
      std::this_thread::sleep_for(std::chrono::milliseconds(3));
    }
    EXPECT_TRUE(waitUntil([&] { return samples().back().first > begin + 4.1; })) << hz;
    std::array<int, 4> counts{};
    for (const auto& [time, x] : samples()) {
      const auto second = static_cast<long>(std::floor(time - begin));
      if (second >= 0 && second < 4) ++counts.at(static_cast<std::size_t>(second));
    }
    return *std::min_element(counts.begin() + 1, counts.end());  // the first has no frame at first
  };
  for (const double hz : {32.0, 50.1, 58.0, 67.0, 100.0}) {
    EXPECT_GE(fewestInASecond(hz, [&](Time time, double x) { addWheels(time, x); }), 30) << hz;
  }
  EXPECT_GE(fewestInASecond(200.0, [&](Time time, double) { addRate(time, 0.1); }), 30);
  int samples_so_far = 0;  // wheels that are too slow for it
  EXPECT_GE(fewestInASecond(100.0,
                            [&](Time time, double x) {
                              addRate(time, 0.0);
                              if (++samples_so_far % 10 == 0) addWheels(time, x);
                            }),
            30);
  for (const auto& [time, x] : samples()) {
    if (time < begin + 1.0) continue;
    EXPECT_NEAR(x, time - begin, 0.01);
  }
}

TEST_F(TopicSinkTest, TheRobotsOwnOdometryIsCorrected) {
  TopicSink::Hooks hooks;
  std::atomic<bool> has_pause{false};
  hooks.others_odometry = [&](Time) {
    return has_pause ? std::nullopt : std::optional(planar(4.0));
  };
  start({}, hooks);
  addFrame(100.0, planar(2.0), planar(1.0));
  ASSERT_TRUE(waitUntil([&] { return edges().size() == 2; }));
  EXPECT_NEAR(edges().at("map>odom"), 1.0 + 2.0 - 4.0, 1e-12);
  EXPECT_NEAR(edges().at("map>headway_odom"), 1.0, 1e-12);
  ASSERT_TRUE(waitUntil([&] { return !samples().empty(); }));
  EXPECT_EQ(frame_, "headway_odom");
  has_pause = true;  // the correction remains
  addFrame(100.1, planar(2.0), planar(1.5));
  EXPECT_TRUE(waitUntil([&] { return edges().at("map>headway_odom") == 1.5; }));
  EXPECT_NEAR(edges().at("map>odom"), 1.0 + 2.0 - 4.0, 1e-12);
}

TEST_F(TopicSinkTest, WithoutAPlaceInTheMapThereIsNoTransformToIt) {
  Ros2SinkParams params;
  params.odom_base = true;
  start(params);
  addFrame(100.0, planar(0.0), planar(0.0), slam::TrackingStatus::kUnreliable);
  addFrame(100.1, planar(0.0), planar(0.0), slam::TrackingStatus::kTrackedInNewSubmap, 1);
  ASSERT_TRUE(waitUntil([&] { return samples().size() == 2; }));
  EXPECT_EQ(edges().count("map>odom"), 0U);
  EXPECT_EQ(edges().count("odom>base_link"), 1U);
  addFrame(100.2, planar(0.0), planar(0.0), slam::TrackingStatus::kLost);
  EXPECT_TRUE(waitUntil([&] { return edges().count("map>odom") == 1; }));
}

TEST_F(TopicSinkTest, TheRobotsFrameIsThatOfTheSensors) {
  TopicSink::Hooks hooks;
  hooks.robot_frame = [] { return std::string("base"); };
  Ros2SinkParams params;
  params.odom_base = true;
  start(params, hooks);
  addFrame(100.0, planar(0.0), planar(0.0));
  EXPECT_TRUE(waitUntil([&] { return edges().count("odom>base") == 1; }));
  EXPECT_EQ(edges().count("odom>base_link"), 0U);
}

TEST_F(TopicSinkTest, RatesAndSwitchesAreThoseOfTheParameters) {
  Ros2SinkParams params;
  params.map_odom = false;
  params.odom_base = true;
  params.tracks_hz = 2.0;
  params.markers_hz = 0.0;
  std::atomic<int> tracks{0}, markers{0};
  const auto detections = peer_.reader<vision_msgs::msg::dds_::Detection3DArray_PubSubType>(
      "rt/headway/detections", {}, [&](const auto&) { ++tracks; });
  const auto boxes = peer_.reader<visualization_msgs::msg::dds_::MarkerArray_PubSubType>(
      "rt/headway/markers", {}, [&](const auto&) { ++markers; });
  start(params);
  Time time = 100.0;
  ASSERT_TRUE(waitUntil([&] {  // until the writers know these readers, too
    addFrame(time += 1.0, planar(0.0), planar(0.0));
    return tracks > 0 && boxes->matched() > 0;
  }));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // what is under way
  tracks = 0;
  for (int i = 1; i <= 50; ++i) {  // 5 s at 10 Hz
    addFrame(time + 0.1 * i, planar(0.0), planar(0.0));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_TRUE(waitUntil([&] { return tracks >= 5; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_LE(tracks, 10);
  EXPECT_EQ(markers, 0);
  EXPECT_EQ(edges().count("map>odom"), 0U);
  EXPECT_EQ(edges().count("odom>base_link"), 1U);
}

TEST_F(TopicSinkTest, NothingIsMadeForTopicsWithoutSubscribers) {
  std::atomic<int> asked{0};
  TopicSink::Hooks hooks;
  hooks.sensors = [&] {
    ++asked;
    return std::vector<DiagnosticLine>{{DiagnosticLine::kOk, "camera", "running", {}}};
  };
  start({}, hooks);
  for (int i = 0; i < 30; ++i) addFrame(100.0 + i, planar(0.0), planar(0.0));
  EXPECT_EQ(asked, 0);
  std::multiset<std::string> lines, keys;
  const auto health = peer_.reader<diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType>(
      "rt/diagnostics", {}, [&](const auto& message) {
        const std::lock_guard lock(mutex_);
        lines.clear();
        keys.clear();
        for (const auto& line : message.status()) {
          lines.insert(line.name() + ": " + line.message());
          for (const auto& value : line.values()) keys.insert(value.key());
        }
      });
  Time time = 200.0;
  EXPECT_TRUE(waitUntil([&] {
    addFrame(time += 1.0, planar(0.0), planar(0.0));
    const std::lock_guard lock(mutex_);
    return lines.count("headway: localisation: tracked") > 0;
  }));
  const std::lock_guard lock(mutex_);
  EXPECT_THAT(lines, ::testing::UnorderedElementsAre(
                         "headway: localisation: tracked", "headway: input: no warnings",
                         "camera: running", "headway: output: all messages are taken"));
  EXPECT_THAT(keys, ::testing::IsSupersetOf({"image to results [ms]", "processing [ms]"}));
}

TEST_F(TopicSinkTest, EachTopicIsMadeForItsSubscribersAlone) {
  map::PerceptionMap map;
  map.update(std::make_shared<const map::LocalLayer>(10.0));
  map.update(mrpt::maps::COccupancyGridMap2D::Create(0.0F, 1.0F, 0.0F, 1.0F, 0.1F));
  const auto points = mrpt::maps::CColouredPointsMap::Create();
  points->insertPointRGB(1.0F, 2.0F, 3.0F, 1.0F, 0.0F, 0.2F);
  map.update(points);
  pipeline::Perception perception(nullptr, {}, map);
  Ros2SinkParams params;
  params.clock = true;
  params.odom_base = true;
  params.diagnostics_hz = 4.0;
  sink_.emplace(*node_, params);
  run::FrameResult result;
  result.update.time = 100.0;
  result.update.camera.status = slam::TrackingStatus::kTracked;
  result.update.tracks_odom = {test::walkingTrack(7, {2.0, 1.0}, {1.0, 0.0}, 0.1)};
  const auto addAll = [&] {
    result.update.time += 2.5;  // all topics are due
    addWheels(result.update.time - 0.01, 0.0);
    sink_->onLocal(result.update.time, result.update.camera, map);
    sink_->onFrame(result, perception);
  };
  for (int i = 0; i < 30; ++i) addAll();
  std::this_thread::sleep_for(std::chrono::milliseconds(1600));  // without frames, too
  EXPECT_THAT(sink_->messages(), ::testing::IsEmpty());

  std::vector<std::pair<std::string, std::string>> topics = {
      {"/tf", "tf2_msgs::msg::dds_::TFMessage_"},
      {"/clock", "rosgraph_msgs::msg::dds_::Clock_"},
      {"/map", "nav_msgs::msg::dds_::OccupancyGrid_"},
      {"/diagnostics", "diagnostic_msgs::msg::dds_::DiagnosticArray_"},
      {"/headway/odometry", "nav_msgs::msg::dds_::Odometry_"},
      {"/headway/local_costmap", "nav_msgs::msg::dds_::OccupancyGrid_"},
      {"/headway/obstacles", "sensor_msgs::msg::dds_::PointCloud2_"},
      {"/headway/dense_map", "sensor_msgs::msg::dds_::PointCloud2_"},
      {"/headway/detections", "vision_msgs::msg::dds_::Detection3DArray_"},
      {"/headway/moving_obstacles", "nav2_dynamic_msgs::msg::dds_::ObstacleArray_"},
      {"/headway/markers", "visualization_msgs::msg::dds_::MarkerArray_"}};
  for (const char* ms : {"500", "1000", "1500", "2000", "2500", "3000"}) {
    topics.emplace_back("/headway/predicted_" + std::string(ms) + "ms",
                        "nav_msgs::msg::dds_::OccupancyGrid_");
  }
  std::set<std::string> subscribed;
  for (const auto& entry : topics) {  // one after the other
    const std::string& topic = entry.first;
    const auto reader =
        peer_.bytesReader("rt" + topic, entry.second, {}, [](const std::string&) {});
    EXPECT_TRUE(waitUntil([&] {
      addAll();
      return sink_->messages().count(topic) > 0;
    })) << topic;
    for (const auto& [made, count] : sink_->messages()) {
      const bool is_subscribed = made == topic || subscribed.count(made) > 0;
      EXPECT_TRUE(is_subscribed) << made << " beside " << topic;
    }
    subscribed.insert(topic);
  }
}

TEST_F(TopicSinkTest, DiagnosticsGoOnWithoutFrames) {
  Ros2SinkParams params;
  params.diagnostics_hz = 10.0;
  TopicSink::Hooks hooks;
  hooks.sensors = [] {
    return std::vector<DiagnosticLine>{{DiagnosticLine::kError, "camera", "silent", {}}};
  };
  struct State {
    int level = 0;
    std::string text;
    Time stamp = 0.0;
  };
  std::vector<State> states;    // of the localisation
  std::set<std::string> names;  // of the newest message
  const auto health = peer_.reader<diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType>(
      "rt/diagnostics", {}, [&](const auto& message) {
        const auto& stamp = message.header().stamp();
        const auto& line = message.status().at(0);
        const std::lock_guard lock(mutex_);
        states.push_back({line.level(), line.message(), stamp.sec() + 1e-9 * stamp.nanosec()});
        names.clear();
        for (const auto& each : message.status()) names.insert(each.name());
      });
  const auto isNewest = [&](DiagnosticLine::Level level, const std::string& text) {
    const std::lock_guard lock(mutex_);
    return !states.empty() && states.back().level == level &&
           states.back().text.rfind(text, 0) == 0;
  };
  sink_.emplace(*node_, params, hooks);
  EXPECT_TRUE(waitUntil([&] { return isNewest(DiagnosticLine::kStale, "no frame yet"); }));
  Time time = 100.0;
  EXPECT_TRUE(waitUntil([&] {
    addFrame(time += 0.2, planar(0.0), planar(0.0));
    return isNewest(DiagnosticLine::kOk, "tracked");
  }));
  EXPECT_TRUE(waitUntil([&] { return isNewest(DiagnosticLine::kError, "no frame for "); }));
  const auto ageOf = [](const State& state) { return std::stod(state.text.substr(13)); };
  EXPECT_TRUE(waitUntil([&] {
    const std::lock_guard lock(mutex_);
    return ageOf(states.back()) > 1.5;
  }));
  {
    const std::lock_guard lock(mutex_);
    EXPECT_NEAR(states.back().stamp, time + ageOf(states.back()), 0.1);  // the frames' time goes on
    EXPECT_THAT(names, ::testing::UnorderedElementsAre("headway: localisation", "headway: input",
                                                       "camera", "headway: output"));
  }
  EXPECT_TRUE(waitUntil([&] {
    addFrame(time += 0.2, planar(0.0), planar(0.0));
    return isNewest(DiagnosticLine::kOk, "tracked");
  }));
}

/// As at the end of a recording that is played again and again.
TEST_F(TopicSinkTest, TheClockIsSetBackWithTheObservations) {
  std::set<int> times;
  const auto reader = peer_.reader<rosgraph_msgs::msg::dds_::Clock_PubSubType>(
      "rt/clock", {}, [&](const auto& message) {
        const std::lock_guard lock(mutex_);
        times.insert(message.clock().sec());
      });
  Ros2SinkParams params;
  params.clock = true;
  sink_.emplace(*node_, params);
  for (const int time : {100, 50, 51}) {
    EXPECT_TRUE(waitUntil([&] {
      addWheels(time, 0.0);
      addWheels(time - 0.1, 0.0);  // out of order
      const std::lock_guard lock(mutex_);
      return times.count(time) > 0;
    })) << time;
  }
  const std::lock_guard lock(mutex_);
  EXPECT_THAT(times, ::testing::ElementsAre(50, 51, 100));
}

TEST_F(TopicSinkTest, AClockThatIsSetBackIsNamed) {
  for (const Time time : {100.0, 100.1, 90.0}) {
    RecordedFrame frame;
    frame.time = time;
    frame.T_map_robot = Pose::Identity();
    (void)perception_.process(frame);
  }
  std::atomic<bool> is_named{false};
  const auto health = peer_.reader<diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType>(
      "rt/diagnostics", {}, [&](const auto& message) {
        for (const auto& line : message.status()) {
          for (const auto& value : line.values()) {
            if (line.level() == 1 && value.key() == "clock_set_back") is_named = true;
          }
        }
      });
  start({});
  Time time = 100.0;
  EXPECT_TRUE(waitUntil([&] {
    addFrame(time += 1.0, planar(0.0), planar(0.0));
    return is_named.load();
  }));
}

TEST_F(TopicSinkTest, PosesAndObstaclesDoNotWaitForObjects) {
  map::PerceptionMap map;
  map.update(std::make_shared<const map::LocalLayer>(10.0));
  std::set<long> clouds;  // by their stamps [ms]
  const auto reader = peer_.reader<sensor_msgs::msg::dds_::PointCloud2_PubSubType>(
      "rt/headway/obstacles", {}, [&](const auto& message) {
        const auto& stamp = message.header().stamp();
        const std::lock_guard lock(mutex_);
        clouds.insert(std::lround(1e3 * (stamp.sec() + 1e-9 * stamp.nanosec())));
      });
  start({});
  ASSERT_TRUE(waitUntil([&] { return reader->matched() > 0; }));
  slam::SlamUpdate camera;
  camera.status = slam::TrackingStatus::kTracked;
  Time time = 100.0;
  ASSERT_TRUE(waitUntil([&] {
    sink_->onLocal(time += 0.2, camera, map);
    const std::lock_guard lock(mutex_);
    return !clouds.empty();
  }));
  EXPECT_TRUE(waitUntil([&] { return !samples().empty() && samples().back().first >= time; }))
      << "the odometry of the frame";
}

TEST_F(TopicSinkTest, PredictedGridsShowWhereSomebodyWillBe) {
  map::PerceptionMap map;
  map.update(std::make_shared<const map::LocalLayer>(10.0));
  map.update(100.0, {test::walkingTrack(7, {2.0, 1.0}, {1.0, 0.0}, 0.1)});
  pipeline::Perception perception(nullptr, {}, map);
  using Grid = nav_msgs::msg::dds_::OccupancyGrid_PubSubType;
  std::optional<nav_msgs::msg::dds_::OccupancyGrid_> grid;
  const auto reader =
      peer_.reader<Grid>("rt/headway/predicted_1000ms", {}, [&](const auto& message) {
        const std::lock_guard lock(mutex_);
        if (!grid) grid = message;
      });
  start({});
  ASSERT_TRUE(waitUntil([&] { return reader->matched() > 0; }));
  run::FrameResult result;
  result.update.time = 100.0;
  ASSERT_TRUE(waitUntil([&] {
    result.update.time += 0.2;
    sink_->onFrame(result, perception);
    const std::lock_guard lock(mutex_);
    return grid.has_value();
  }));
  const std::lock_guard lock(mutex_);
  const auto& stamp = grid->header().stamp();
  const double now_x = 2.0 + stamp.sec() + 1e-9 * stamp.nanosec() - 100.0;
  const auto& info = grid->info();
  ASSERT_EQ(grid->data().size(), std::size_t{info.width()} * info.height());
  const auto place = [&](std::size_t cell) {
    const auto column = static_cast<double>(cell % info.width());
    const auto row = static_cast<double>(cell / info.width());
    return Eigen::Vector2d(info.origin().position().x() + info.resolution() * (column + 0.5),
                           info.origin().position().y() + info.resolution() * (row + 0.5));
  };
  std::size_t peak = 0;
  for (std::size_t i = 0; i < grid->data().size(); ++i) {
    if (grid->data()[i] > grid->data()[peak]) peak = i;
    const Eigen::Vector2d from_start = place(i) - Eigen::Vector2d(now_x, 1.0);
    if (from_start.x() < 0.2 || std::abs(from_start.y()) > 1.0) {
      EXPECT_EQ(grid->data()[i], 0) << place(i).transpose();
    }
  }
  EXPECT_GT(grid->data()[peak], 50);
  EXPECT_NEAR(place(peak).x(), now_x + 1.0, 0.3);
  EXPECT_NEAR(place(peak).y(), 1.0, 0.3);
}

}  // namespace
}  // namespace headway::ros2
