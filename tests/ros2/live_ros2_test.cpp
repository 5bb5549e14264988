// SPDX-License-Identifier: BSD-3-Clause
// headway-live as a node of ROS 2, beside a robot of another implementation of DDS.
#include <gmock/gmock.h>
#include <headway/core/mrpt_pose.h>
#include <headway_test/folders.h>
#include <headway_test/process.h>
#include <headway_test/waiting.h>

#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "robot.h"

namespace headway::ros2 {
namespace {

using test::FastDdsPeer;
using test::waitUntil;
using ::testing::HasSubstr;

std::string streetRawlog() { return std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/street.rawlog"; }

/// A running headway-live.
class LiveProgram {
 public:
  LiveProgram(const std::string& arguments, const test::TemporaryFolder& folder, int domain)
      : LiveProgram(arguments, folder.path().string(), domain) {}
  LiveProgram(const std::string& arguments, const std::string& folder, int domain)
      : out_(folder + "/live.txt"), end_(folder + "/live.status") {
    std::filesystem::remove(end_);
    (void)test::runProcess("( ROS_DOMAIN_ID=" + std::to_string(domain) + " " +
                           test::program("headway-live") + " " + arguments + " >" + out_ +
                           " 2>&1 & echo $! >" + folder + "/live.pid; wait $!; echo $? >" + end_ +
                           " ) >/dev/null 2>&1 & sleep 0.2");
    process_ = std::stoi(test::contentsOf(folder + "/live.pid"));
  }
  ~LiveProgram() { (void)end(SIGKILL); }
  LiveProgram(const LiveProgram&) = delete;
  LiveProgram& operator=(const LiveProgram&) = delete;

  [[nodiscard]] std::string output() const { return test::contentsOf(out_); }
  [[nodiscard]] bool hasEnded() const { return !test::contentsOf(end_).empty(); }
  /// @return exit status
  int end(int signal) {
    if (!hasEnded()) kill(process_, signal);
    (void)waitUntil([&] { return hasEnded(); });
    const std::string status = test::contentsOf(end_);
    return status.empty() ? -1 : std::stoi(status);
  }

 private:
  std::string out_, end_;
  int process_ = 0;
};

/// Everything that headway publishes, as another implementation receives it.
class Audience {
 public:
  explicit Audience(FastDdsPeer& peer) {
    using namespace nav_msgs::msg::dds_;
    using namespace sensor_msgs::msg::dds_;
    using tf2_msgs::msg::dds_::TFMessage_PubSubType;
    add<TFMessage_PubSubType>(peer, "/tf", [this](const auto& message) {
      for (const auto& transform : message.transforms()) {
        edges_.insert(transform.header().frame_id() + ">" + transform.child_frame_id());
        if (transform.child_frame_id() != "base_link") continue;
        const auto& place = transform.transform().translation();
        last_place_ = {place.x(), place.y(), place.z()};
      }
    });
    add<Odometry_PubSubType>(peer, "/headway/odometry", [this](const auto& message) {
      const Time time = message.header().stamp().sec() + 1e-9 * message.header().stamp().nanosec();
      if (!stamps_.empty() && time <= stamps_.back()) ++backward_;
      stamps_.push_back(time);
    });
    add<OccupancyGrid_PubSubType>(peer, "/map", [](const auto&) {}, {true, true, 1});
    add<OccupancyGrid_PubSubType>(peer, "/headway/local_costmap", [this](const auto& message) {
      for (const auto cell : message.data()) local_states_.insert(cell);
    });
    add<OccupancyGrid_PubSubType>(peer, "/headway/predicted_1000ms", [](const auto&) {});
    add<PointCloud2_PubSubType>(peer, "/headway/obstacles", [this](const auto& message) {
      obstacle_frame_ = message.header().frame_id();
      obstacles_ += message.width();
    });
    add<PointCloud2_PubSubType>(peer, "/headway/dense_map", [](const auto&) {});
    add<vision_msgs::msg::dds_::Detection3DArray_PubSubType>(
        peer, "/headway/detections",
        [this](const auto& message) { detections_ += message.detections().size(); });
    add<nav2_dynamic_msgs::msg::dds_::ObstacleArray_PubSubType>(
        peer, "/headway/moving_obstacles",
        [this](const auto& message) { moving_ += message.obstacles().size(); });
    add<visualization_msgs::msg::dds_::MarkerArray_PubSubType>(peer, "/headway/markers",
                                                               [](const auto&) {});
    add<diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType>(
        peer, "/diagnostics", [this](const auto& message) {
          for (const auto& line : message.status()) health_.insert(line.name());
        });
  }

  std::size_t count(const std::string& topic) {
    const std::lock_guard lock(mutex_);
    return counts_[topic];
  }
  template <typename Read>
  auto read(const Read& member) {
    const std::lock_guard lock(mutex_);
    return this->*member;
  }

  std::set<std::string> edges_, health_;
  std::set<int> local_states_;
  std::vector<Time> stamps_;
  std::size_t backward_ = 0, obstacles_ = 0, detections_ = 0, moving_ = 0;
  std::string obstacle_frame_;
  Eigen::Vector3d last_place_ = Eigen::Vector3d::Zero();

 private:
  template <typename PubSubType, typename Use>
  void add(FastDdsPeer& peer, const std::string& topic, Use use,
           const test::PeerQos& qos = {true, false, 100}) {
    readers_.push_back(peer.reader<PubSubType>(
        "rt" + topic, qos, [this, topic, use](const typename PubSubType::type& message) {
          const std::lock_guard lock(mutex_);
          ++counts_[topic];
          use(message);
        }));
  }

  std::mutex mutex_;  // guards everything above and below
  std::map<std::string, std::size_t> counts_;
  std::vector<std::unique_ptr<FastDdsPeer::Reader>> readers_;
};

class LiveRos2Test : public ::testing::Test {
 protected:
  LiveRos2Test() : domain_(test::domainOfThisTest()), peer_(domain_) {}

  std::string ini(const std::string& text) {
    const std::string path = folder_ / "ros2.ini";
    std::ofstream(path) << text;
    return path;
  }
  [[nodiscard]] std::string out() const { return (folder_ / "out"); }

  int domain_;
  test::TemporaryFolder folder_;
  FastDdsPeer peer_;
  std::atomic<bool> stop_{false};
};

TEST_F(LiveRos2Test, ARobotsTopicsBecomeResultsAsTopics) {
  test::Robot robot(peer_, streetRawlog());
  Audience audience(peer_);
  const std::string recorded = folder_ / "recorded.rawlog";
  LiveProgram live("--ros2 " +
                       ini("[ros2_publish]\nodom_base = true\nclock = true\npredicted_hz = 10\n") +
                       " --ros2-interface lo -w -o " + out() + " --record " + recorded,
                   folder_.path().string(), domain_);
  ASSERT_TRUE(waitUntil([&] { return robot.isWatched(); })) << live.output();
  EXPECT_THAT(live.output(), HasSubstr("ROS 2 domain " + std::to_string(domain_) + " on lo"));
  const std::size_t sent = robot.play(0.5, stop_);
  const auto results = [&] { return audience.count("/headway/odometry"); };
  EXPECT_TRUE(waitUntil([&] { return results() + 3 >= sent / 2; })) << live.output();
  EXPECT_TRUE(waitUntil([&] { return audience.count("/headway/dense_map") > 0; }));
  EXPECT_EQ(live.end(SIGTERM), 0) << live.output();

  for (const char* topic :
       {"/tf", "/map", "/headway/local_costmap", "/headway/predicted_1000ms", "/headway/obstacles",
        "/headway/detections", "/headway/moving_obstacles", "/headway/markers", "/diagnostics"}) {
    EXPECT_GT(audience.count(topic), 0U) << topic;
  }
  EXPECT_THAT(audience.edges_, ::testing::IsSupersetOf({"map>odom", "odom>base_link"}));
  EXPECT_EQ(audience.backward_, 0U);
  EXPECT_GT(audience.obstacles_, 0U);
  EXPECT_EQ(audience.obstacle_frame_, "base_link");
  EXPECT_THAT(audience.local_states_, ::testing::IsSupersetOf({0, 100, 255}));
  EXPECT_GT(audience.detections_, 0U);
  EXPECT_EQ(audience.detections_, audience.moving_);
  EXPECT_THAT(audience.health_, ::testing::IsSupersetOf({"headway: localisation", "headway: input",
                                                         "headway: sensor /left/image"}));
  // Stamps are those of the images: the recorded frames have the same.
  const auto frames = test::contentsOf(out() + "/trajectory_online.tum");
  EXPECT_GE(std::count(frames.begin(), frames.end(), '\n'), static_cast<long>(sent / 2));
  std::ifstream rows(out() + "/trajectory_odom.tum");
  std::set<long> times;
  Time last_time = 0.0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  for (std::string row; std::getline(rows, row);) {
    std::istringstream fields(row);
    Time time = 0.0;
    if (!(fields >> time)) continue;
    fields >> place.x() >> place.y() >> place.z();
    last_time = time;
    times.insert(std::lround(1e4 * time));
  }
  EXPECT_GT(last_time, 0.0);
  for (const Time stamp : audience.stamps_) EXPECT_EQ(times.count(std::lround(1e4 * stamp)), 1U);
  EXPECT_LT((audience.last_place_ - place).norm(), 1e-6);
  EXPECT_GT(std::filesystem::file_size(recorded), 1'000'000U);
}

TEST_F(LiveRos2Test, EitherSideIsKilledAndComesBack) {
  const std::string arguments =
      "--ros2 --left /left/image/compressed --right "
      "/right/image/compressed --ros2-interface lo -w -o " +
      out();
  auto live = std::make_unique<LiveProgram>(arguments, folder_.path().string(), domain_);
  const auto tracked = [&] { return live->output().find("tracked (") != std::string::npos; };
  for (int round = 0; round < 2; ++round) {
    FastDdsPeer peer(domain_);
    test::Robot robot(peer, streetRawlog(), true, 100.0 * round);
    ASSERT_TRUE(waitUntil([&] { return robot.isWatched(); })) << live->output();
    (void)robot.play(1.0, stop_);
    EXPECT_TRUE(waitUntil(tracked)) << live->output();
    if (round > 0) break;
    (void)live->end(SIGKILL);
    live = std::make_unique<LiveProgram>(arguments, folder_.path().string(), domain_);
    ASSERT_TRUE(waitUntil([&] { return robot.isWatched(); })) << live->output();
    (void)robot.play(1.0, stop_);
    EXPECT_TRUE(waitUntil(tracked)) << live->output();
  }
  EXPECT_EQ(live->end(SIGTERM), 0) << live->output();
}

TEST_F(LiveRos2Test, ARecordingIsPublishedWithItsClock) {
  std::ofstream(folder_ / "rawlog.ini")
      << "[CAM]\ndriver = CCameraSensor\ngrabber_type = rawlog\nrawlog_file = " << streetRawlog()
      << "\nprocess_rate = 8\npose_z = 1.65\npose_yaw = -90\npose_roll = -90\n";
  std::atomic<std::size_t> clocks{0};
  const auto clock = peer_.reader<rosgraph_msgs::msg::dds_::Clock_PubSubType>(
      "rt/clock", {}, [&](const auto&) { ++clocks; });
  Audience audience(peer_);
  LiveProgram live("--sensors " + std::string(folder_ / "rawlog.ini") + " --ros2 " +
                       ini("[ros2_publish]\nclock = true\nodom_base = true\n") +
                       " --ros2-interface lo -w -o " + out(),
                   folder_.path().string(), domain_);
  EXPECT_TRUE(waitUntil([&] {
    return clocks > 5 && audience.count("/tf") > 5 && audience.count("/headway/markers") > 5;
  })) << live.output();
  EXPECT_EQ(live.end(SIGTERM), 0) << live.output();
}

TEST_F(LiveRos2Test, ListsTopicsAndNamesMistakes) {
  test::Robot robot(peer_, streetRawlog());
  const auto run = [&](const std::string& arguments) {
    return test::runProcess("ROS_DOMAIN_ID=" + std::to_string(domain_) + " " +
                            test::program("headway-live") + " " + arguments);
  };
  const auto list = run("--ros2-list --ros2-interface lo");
  EXPECT_EQ(list.status, 0) << list.output;
  EXPECT_THAT(list.output, HasSubstr("/left/image  sensor_msgs/Image  1 publisher, reliable"));
  EXPECT_THAT(list.output, HasSubstr("<- left image"));
  const auto shipped = run("--ros2 " + std::string(HEADWAY_SOURCE_DIR) +
                           "/config/ros2.ini --ros2-list --ros2-interface lo");
  EXPECT_EQ(shipped.status, 0) << shipped.output;
  const auto unknown = run("--ros2 " + ini("[ros2]\nlefft = /x\n") + " -o " + out());
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.output, HasSubstr("lefft"));
  const auto interface = run("--ros2 --ros2-interface no_such0 -o " + out());
  EXPECT_EQ(interface.status, 1) << interface.output;
  EXPECT_THAT(interface.output, HasSubstr("no_such0"));
  EXPECT_EQ(run("--ros2-interface lo --sensors x -o " + out()).status, 2);
  EXPECT_EQ(run("--ros2 --initial-pose 1,2 --load-map x -o " + out()).status, 2);
  EXPECT_EQ(run("--ros2 --initial-pose 1,2,3 -o " + out()).status, 2);
  EXPECT_EQ(run("-o " + out()).status, 2);
}

}  // namespace
}  // namespace headway::ros2
