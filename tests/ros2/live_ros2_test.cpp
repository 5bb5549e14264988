// SPDX-License-Identifier: BSD-3-Clause
// headway-live as a node of ROS 2, beside a robot of another implementation of DDS.
#include <gmock/gmock.h>
#include <headway/core/mrpt_pose.h>
#include <headway/io/rawlog_sink.h>
#include <headway_test/folders.h>
#include <headway_test/npm_packages.h>
#include <headway_test/process.h>
#include <headway_test/repeated_corridor.h>
#include <headway_test/waiting.h>

#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>
#include <type_traits>

#include "robot.h"

namespace headway::ros2 {
namespace {

using test::FastDdsPeer;
using test::waitUntil;
using ::testing::HasSubstr;
using ::testing::Not;

std::string streetRawlog() { return std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/street.rawlog"; }

/// A program that runs beside the test, whose output is in NAME.txt.
class RunningProgram {
 public:
  RunningProgram(const std::string& command, const std::string& folder, const std::string& name)
      : out_(folder + "/" + name + ".txt"), end_(folder + "/" + name + ".status") {
    std::filesystem::remove(end_);
    const std::string id = folder + "/" + name + ".pid";
    (void)test::runProcess("( " + command + " >" + out_ + " 2>&1 & echo $! >" + id +
                           "; wait $!; echo $? >" + end_ + " ) >/dev/null 2>&1 & sleep 0.2");
    process_ = std::stoi(test::contentsOf(id));
  }
  ~RunningProgram() { (void)end(SIGKILL); }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  [[nodiscard]] std::string output() const { return test::contentsOf(out_); }
  [[nodiscard]] bool hasEnded() const { return status_ || !test::contentsOf(end_).empty(); }
  /// @return exit status
  int end(int signal) {
    if (status_) return *status_;  // another one may have the files
    if (!hasEnded()) kill(process_, signal);
    (void)waitUntil([&] { return hasEnded(); });
    const std::string status = test::contentsOf(end_);
    status_ = status.empty() ? -1 : std::stoi(status);
    return *status_;
  }

 private:
  std::string out_, end_;
  int process_ = 0;
  std::optional<int> status_;
};

/// A running headway-live.
class LiveProgram : public RunningProgram {
 public:
  LiveProgram(const std::string& arguments, const std::string& folder, int domain)
      : RunningProgram("ROS_DOMAIN_ID=" + std::to_string(domain) + " " +
                           test::program("headway-live") + " " + arguments,
                       folder, "live") {}
};

std::vector<std::string> predictedTopics() {
  std::vector<std::string> topics;
  for (const char* ms : {"500", "1000", "1500", "2000", "2500", "3000"}) {
    topics.push_back("/headway/predicted_" + std::string(ms) + "ms");
  }
  return topics;
}

template <typename Header>
Time timeOf(const Header& header) {
  return header.stamp().sec() + 1e-9 * header.stamp().nanosec();
}

template <typename Place, typename Rotation>
Pose poseOf(const Place& place, const Rotation& rotation) {
  Pose pose = Pose::Identity();
  pose.translation() << place.x(), place.y(), place.z();
  pose.linear() = Eigen::Quaterniond(rotation.w(), rotation.x(), rotation.y(), rotation.z())
                      .normalized()
                      .toRotationMatrix();
  return pose;
}

/// Between the poses around a time; nullopt outside of them.
std::optional<Pose> poseAt(const std::vector<Stamped<Pose>>& poses, Time time) {
  const auto after =
      std::find_if(poses.begin(), poses.end(), [&](const auto& pose) { return pose.time >= time; });
  if (after == poses.end()) return std::nullopt;
  if (after->time == time) return after->value;
  if (after == poses.begin()) return std::nullopt;
  const auto& before = *(after - 1);
  const double ratio = (time - before.time) / (after->time - before.time);
  Pose pose = Pose::Identity();
  pose.translation() =
      (1.0 - ratio) * before.value.translation() + ratio * after->value.translation();
  pose.linear() =
      quaternionOf(before.value).slerp(ratio, quaternionOf(after->value)).toRotationMatrix();
  return pose;
}

template <typename Message, typename = void>
struct HasHeader : std::false_type {};
template <typename Message>
struct HasHeader<Message, std::void_t<decltype(std::declval<const Message&>().header())>>
    : std::true_type {};

/// Everything that headway publishes, as another implementation receives it.
class Audience {
 public:
  explicit Audience(FastDdsPeer& peer) {
    using namespace nav_msgs::msg::dds_;
    using namespace sensor_msgs::msg::dds_;
    using tf2_msgs::msg::dds_::TFMessage_PubSubType;
    add<TFMessage_PubSubType>(peer, "/tf", [this](const auto& message) {
      for (const auto& transform : message.transforms()) {
        const std::string edge = transform.header().frame_id() + ">" + transform.child_frame_id();
        edges_.insert(edge);
        const auto& pose = transform.transform();
        transforms_[edge].push_back(
            {timeOf(transform.header()), poseOf(pose.translation(), pose.rotation())});
        if (transform.child_frame_id() != "base_link") continue;
        const auto& place = transform.transform().translation();
        last_place_ = {place.x(), place.y(), place.z()};
      }
    });
    add<Odometry_PubSubType>(peer, "/headway/odometry", [this](const auto& message) {
      const Time time = timeOf(message.header());
      if (!stamps_.empty() && time <= stamps_.back()) ++backward_;
      stamps_.push_back(time);
      const auto& pose = message.pose().pose();
      odometry_.push_back({time, poseOf(pose.position(), pose.orientation())});
    });
    add<OccupancyGrid_PubSubType>(peer, "/map", [](const auto&) {}, {true, true, 1});
    add<OccupancyGrid_PubSubType>(peer, "/headway/local_costmap", [this](const auto& message) {
      for (const auto cell : message.data()) local_states_.insert(cell);
      costmaps_[test::Results::keyOf(timeOf(message.header()))] = message;
    });
    for (const auto& topic : predictedTopics()) {
      add<OccupancyGrid_PubSubType>(peer, topic, [](const auto&) {});
    }
    add<PointCloud2_PubSubType>(peer, "/headway/obstacles", [this](const auto& message) {
      obstacles_ += message.width();
      clouds_[test::Results::keyOf(timeOf(message.header()))] = message;
      frames_.insert(test::Results::keyOf(timeOf(message.header())));
    });
    add<PointCloud2_PubSubType>(peer, "/headway/dense_map", [](const auto&) {});
    add<vision_msgs::msg::dds_::Detection3DArray_PubSubType>(
        peer, "/headway/detections",
        [this](const auto& message) { detections_ += message.detections().size(); });
    add<nav2_dynamic_msgs::msg::dds_::ObstacleArray_PubSubType>(
        peer, "/headway/moving_obstacles",
        [this](const auto& message) { moving_ += message.obstacles().size(); });
    add<visualization_msgs::msg::dds_::MarkerArray_PubSubType>(
        peer, "/headway/markers", [this](const auto& message) {
          for (const auto& marker : message.markers()) note("/headway/markers", marker.header());
        });
    add<diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType>(
        peer, "/diagnostics", [this](const auto& message) {
          for (const auto& line : message.status()) {
            health_.insert(line.name() + (line.level() == 2 ? ": error" : ""));
          }
        });
  }

  std::size_t count(const std::string& topic) {
    const std::lock_guard lock(mutex_);
    return counts_[topic];
  }
  bool isHealthy(const std::string& name) {
    const std::lock_guard lock(mutex_);
    return health_.count(name) > 0;
  }
  /// Whether its obstacles have come.
  bool hasFrame(Time time) {
    const std::lock_guard lock(mutex_);
    return frames_.count(test::Results::keyOf(time)) > 0;
  }
  /// Ends the reception.
  void close() { readers_.clear(); }

  std::set<std::string> edges_, health_;
  std::set<int> local_states_;
  std::vector<Time> stamps_;
  std::vector<Stamped<Pose>> odometry_;
  std::map<std::string, std::vector<Stamped<Pose>>> transforms_;  // by frame and child
  std::size_t backward_ = 0, obstacles_ = 0, detections_ = 0, moving_ = 0;
  std::map<std::string, std::set<std::string>> frame_ids_;  // by topic, like the stamps
  std::map<std::string, std::set<long>> image_stamps_;
  std::map<long, sensor_msgs::msg::dds_::PointCloud2_> clouds_;
  std::map<long, nav_msgs::msg::dds_::OccupancyGrid_> costmaps_;
  Eigen::Vector3d last_place_ = Eigen::Vector3d::Zero();

 private:
  template <typename Header>
  void note(const std::string& topic, const Header& header) {
    frame_ids_[topic].insert(header.frame_id());
    image_stamps_[topic].insert(test::Results::keyOf(timeOf(header)));
  }

  template <typename PubSubType, typename Use>
  void add(FastDdsPeer& peer, const std::string& topic, Use use,
           const test::PeerQos& qos = {true, false, 100}) {
    readers_.push_back(peer.reader<PubSubType>(
        "rt" + topic, qos, [this, topic, use](const typename PubSubType::type& message) {
          const std::lock_guard lock(mutex_);
          ++counts_[topic];
          if constexpr (HasHeader<typename PubSubType::type>()) note(topic, message.header());
          use(message);
        }));
  }

  std::mutex mutex_;  // guards everything above and below
  std::map<std::string, std::size_t> counts_;
  std::set<long> frames_;
  std::vector<std::unique_ptr<FastDdsPeer::Reader>> readers_;
};

/// Keeps messages of all topics as they came, as lines for decode_messages.mjs.
class Recorder {
 public:
  Recorder(FastDdsPeer& peer, const std::string& path) : lines_(path) {
    for (const auto& topic : predictedTopics()) add(peer, topic, "nav_msgs", "OccupancyGrid");
    add(peer, "/headway/local_costmap", "nav_msgs", "OccupancyGrid");
    add(peer, "/map", "nav_msgs", "OccupancyGrid", {true, true, 1});
    add(peer, "/headway/odometry", "nav_msgs", "Odometry");
    add(peer, "/headway/obstacles", "sensor_msgs", "PointCloud2");
    add(peer, "/headway/dense_map", "sensor_msgs", "PointCloud2");
    add(peer, "/headway/detections", "vision_msgs", "Detection3DArray");
    add(peer, "/headway/moving_obstacles", "nav2_dynamic_msgs", "ObstacleArray");
    add(peer, "/headway/markers", "visualization_msgs", "MarkerArray");
    add(peer, "/diagnostics", "diagnostic_msgs", "DiagnosticArray");
    add(peer, "/clock", "rosgraph_msgs", "Clock");
    add(peer, "/tf", "tf2_msgs", "TFMessage");
    add(peer, "ros_discovery_info", "rmw_dds_common", "ParticipantEntitiesInfo", {true, true, 1});
  }

  void close() {
    readers_.clear();
    lines_.close();
  }
  [[nodiscard]] const std::vector<std::string>& topics() const { return topics_; }

 private:
  void add(FastDdsPeer& peer, const std::string& topic, const std::string& package,
           const std::string& type, const test::PeerQos& qos = {true, false, 100}) {
    topics_.push_back(topic);
    readers_.push_back(peer.bytesReader(
        (topic[0] == '/' ? "rt" : "") + topic, package + "::msg::dds_::" + type + "_", qos,
        [this, topic, name = package + "/" + type](const std::string& message) {
          constexpr char kDigits[] = "0123456789abcdef";
          std::string hex;
          for (const unsigned char byte : message) hex += {kDigits[byte / 16], kDigits[byte % 16]};
          const std::lock_guard lock(mutex_);
          lines_ << R"({"topic":")" << topic << R"(","type":")" << name << R"(","cdr":")" << hex
                 << "\"}\n";
        }));
  }

  std::mutex mutex_;
  std::ofstream lines_;  // guarded by mutex_
  std::vector<std::string> topics_;
  std::vector<std::unique_ptr<FastDdsPeer::Reader>> readers_;
};

/// A robot that drives once for all tests, and what others received of it.
class RobotDriveTest : public ::testing::Test {
 protected:
  static constexpr std::size_t kFrames = 40;

  static void SetUpTestSuite() {
    folder_.emplace();
    const int domain = test::domainOfThisTest();
    FastDdsPeer peer(domain), other(domain);
    test::Robot robot(peer, streetRawlog());
    audience_ = std::make_unique<Audience>(peer);
    const test::Results results(peer);
    Recorder recorder(other, at("messages.txt"));
    topics_ = recorder.topics();
    std::ofstream(at("ros2.ini"))
        << "[ros2_publish]\nodom_base = true\nclock = true\npredicted_hz = 10\n";
    LiveProgram live("--ros2 " + at("ros2.ini") + " --ros2-interface lo -w -o " + at("out") +
                         " --record " + at("recorded.rawlog"),
                     folder_->path().string(), domain);
    ASSERT_TRUE(waitUntil([&] { return robot.isWatched(); })) << live.output();
    EXPECT_THAT(live.output(), HasSubstr("ROS 2 domain " + std::to_string(domain) + " on lo"));
    const std::atomic<bool> stop{false};
    robot.on_frame = [&](Time time) { results.await(time); };
    sent_ = robot.play(1.0, stop, {0, kFrames});
    EXPECT_TRUE(waitUntil([&] { return audience_->count("/headway/odometry") + 3 >= sent_ / 2; }));
    EXPECT_TRUE(waitUntil([&] { return audience_->count("/headway/dense_map") > 0; }));
    EXPECT_EQ(live.end(SIGTERM), 0) << live.output();
    audience_->close();
    recorder.close();
  }
  static void TearDownTestSuite() {
    audience_.reset();
    folder_.reset();
  }

  static std::string at(const std::string& name) { return *folder_ / name; }

  static inline std::optional<test::TemporaryFolder> folder_;
  static inline std::unique_ptr<Audience> audience_;
  static inline std::vector<std::string> topics_;
  static inline std::size_t sent_ = 0;  ///< frames
};

TEST_F(RobotDriveTest, ResultsAreTopics) {
  std::vector<std::string> topics = predictedTopics();
  for (const char* topic :
       {"/tf", "/map", "/headway/local_costmap", "/headway/dense_map", "/headway/obstacles",
        "/headway/detections", "/headway/moving_obstacles", "/headway/markers", "/diagnostics"}) {
    topics.emplace_back(topic);
  }
  for (const auto& topic : topics) EXPECT_GT(audience_->count(topic), 0U) << topic;
  EXPECT_THAT(audience_->edges_, ::testing::IsSupersetOf({"map>odom", "odom>base_link"}));
  EXPECT_EQ(audience_->backward_, 0U);
  EXPECT_GT(audience_->obstacles_, 0U);
  EXPECT_THAT(audience_->local_states_, ::testing::IsSupersetOf({0, 100, 255}));
  EXPECT_GT(audience_->detections_, 0U);
  EXPECT_EQ(audience_->detections_, audience_->moving_);
  EXPECT_THAT(audience_->health_,
              ::testing::IsSupersetOf(
                  {"headway: localisation", "headway: input", "headway: sensor /left/image"}));
}

/// Those of a topic whose messages say where something is.
TEST_F(RobotDriveTest, FramesAndStampsAreRight) {
  std::set<long> images;
  std::ifstream rows(at("out/trajectory_odom.tum"));
  for (std::string row; std::getline(rows, row);) {
    if (row[0] != '#') images.insert(test::Results::keyOf(std::stod(row)));
  }
  std::map<std::string, std::string> frames = {{"/map", "map"},
                                               {"/headway/dense_map", "map"},
                                               {"/headway/odometry", "odom"},
                                               {"/headway/obstacles", "base_link"}};
  for (const char* topic : {"local_costmap", "detections", "moving_obstacles", "markers"}) {
    frames["/headway/" + std::string(topic)] = "odom";
  }
  for (const auto& topic : predictedTopics()) frames[topic] = "odom";
  for (const auto& [topic, frame] : frames) {
    EXPECT_EQ(audience_->frame_ids_[topic], std::set<std::string>{frame}) << topic;
    for (const long stamp : audience_->image_stamps_[topic]) {
      EXPECT_EQ(images.count(stamp), 1U) << topic;
    }
  }
}

/// What is blocked is at the same place by both topics, whose frames differ.
TEST_F(RobotDriveTest, ObstaclesAreWhereTheCostmapIsBlocked) {
  std::size_t points = 0;
  for (const auto& [stamp, grid] : audience_->costmaps_) {
    const auto cloud = audience_->clouds_.find(stamp);
    const auto T_odom_robot =
        poseAt(audience_->transforms_["odom>base_link"], timeOf(grid.header()));
    if (cloud == audience_->clouds_.end() || !T_odom_robot) continue;
    const auto& info = grid.info();
    for (std::size_t i = 0; i < cloud->second.width(); ++i) {
      Eigen::Vector3f point;
      std::memcpy(point.data(), &cloud->second.data()[i * cloud->second.point_step()], 12);
      const Eigen::Vector3d at = *T_odom_robot * point.cast<double>();
      const auto column =
          static_cast<int>((at.x() - info.origin().position().x()) / info.resolution());
      const auto line =
          static_cast<int>((at.y() - info.origin().position().y()) / info.resolution());
      if (column < 0 || line < 0 || column >= static_cast<int>(info.width()) ||
          line >= static_cast<int>(info.height())) {
        continue;
      }
      ++points;
      EXPECT_EQ(grid.data()[static_cast<std::size_t>(line) * info.width() +
                            static_cast<std::size_t>(column)],
                100);
    }
  }
  EXPECT_GT(points, 100U);
}

TEST_F(RobotDriveTest, StampsAreThoseOfTheImages) {
  const auto frames = test::contentsOf(at("out/trajectory_online.tum"));
  EXPECT_GE(std::count(frames.begin(), frames.end(), '\n'), static_cast<long>(sent_ / 2));
  std::ifstream rows(at("out/trajectory_odom.tum"));
  std::set<long> times;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  for (std::string row; std::getline(rows, row);) {
    std::istringstream fields(row);
    Time time = 0.0;
    if (!(fields >> time)) continue;
    fields >> place.x() >> place.y() >> place.z();
    times.insert(std::lround(1e4 * time));
  }
  EXPECT_FALSE(times.empty());
  for (const Time stamp : audience_->stamps_) EXPECT_EQ(times.count(std::lround(1e4 * stamp)), 1U);
  EXPECT_LT((audience_->last_place_ - place).norm(), 1e-6);
  // What was recorded is replayed with as many frames.
  const auto replay = test::runProcess(test::program("headway-replay") + " -q -i " +
                                       at("recorded.rawlog") + " -o " + at("replayed"));
  ASSERT_EQ(replay.status, 0) << replay.output;
  const auto live = nlohmann::json::parse(std::ifstream(at("out/summary.json")));
  const auto again = nlohmann::json::parse(std::ifstream(at("replayed/summary.json")));
  EXPECT_GE(live["frames"].get<std::size_t>(), sent_ / 2);
  EXPECT_EQ(again["frames"].get<std::size_t>(),
            live["frames"].get<std::size_t>() + live["frames_dropped_late"].get<std::size_t>());
}

/// By npm's packages: each message decodes with the published definition of its type, and encodes
/// to the same bytes.
TEST_F(RobotDriveTest, AThirdImplementationDecodesAllMessagesOfAnMcapFile) {
  const std::string missing =
      test::missingNpmPackages("tests/bags/writers", HEADWAY_NODE_DIR, "decode messages");
  if (!missing.empty()) GTEST_SKIP() << missing;
  const auto run = test::runProcess("cd " HEADWAY_NODE_DIR " && node " HEADWAY_SOURCE_DIR
                                    "/tests/ros2/decode_messages.mjs " +
                                    at("drive.mcap") + " < " + at("messages.txt"));
  ASSERT_EQ(run.status, 0) << run.output;
  const auto decoded = nlohmann::json::parse(run.output);
  for (const auto& topic : topics_) {
    ASSERT_TRUE(decoded.contains(topic)) << topic;
    EXPECT_EQ(decoded[topic]["different"], 0) << topic << ": " << decoded[topic];
  }
  EXPECT_EQ(decoded["/headway/odometry"]["messages"], audience_->count("/headway/odometry"));
  const auto& odometry = decoded["/headway/odometry"]["last"];
  EXPECT_EQ(odometry["header"]["frame_id"], "odom");
  EXPECT_EQ(odometry["child_frame_id"], "base_link");
  const auto& stamp = odometry["header"]["stamp"];
  EXPECT_NEAR(stamp["sec"].get<double>() + 1e-9 * stamp["nanosec"].get<double>(),
              audience_->stamps_.back(), 1e-6);
  const auto& map = decoded["/map"]["last"];
  EXPECT_EQ(map["header"]["frame_id"], "map");
  EXPECT_EQ(map["data"], map["info"]["width"].get<int>() * map["info"]["height"].get<int>());
  const auto& cloud = decoded["/headway/dense_map"]["last"];
  EXPECT_EQ(cloud["data"], 16 * cloud["width"].get<int>());
  EXPECT_EQ(decoded["/headway/obstacles"]["last"]["fields"][2]["name"], "z");
  EXPECT_EQ(decoded["ros_discovery_info"]["last"]["node_entities_info_seq"][0]["node_name"],
            "headway");
}

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

/// Both are programs of their own, killed while the robot drives.
TEST_F(LiveRos2Test, EitherSideIsKilledAndComesBack) {
  const std::string arguments =
      "--ros2 --left /left/image/compressed --right "
      "/right/image/compressed --ros2-interface lo -w -o " +
      out();
  const auto startRobot = [&](double shift_s) {
    return std::make_unique<RunningProgram>(std::string(HEADWAY_ROBOT) + " -i " + streetRawlog() +
                                                " --domain " + std::to_string(domain_) +
                                                " --compressed --laps 1000 --shift " +
                                                std::to_string(shift_s),
                                            folder_.path().string(), "robot");
  };
  auto live = std::make_unique<LiveProgram>(arguments, folder_.path().string(), domain_);
  // Numbers of the frames that were tracked, by the status of each second.
  const auto tracked = [&] {
    std::vector<int> frames;
    std::istringstream lines(live->output());
    for (std::string line; std::getline(lines, line);) {
      if (line.rfind("frame ", 0) != 0 || line.find(" deg, tracked") == std::string::npos) continue;
      frames.push_back(std::stoi(line.substr(6)));
    }
    return frames;
  };
  auto robot = startRobot(0.0);
  ASSERT_TRUE(waitUntil([&] { return tracked().size() >= 2; })) << live->output();
  ASSERT_FALSE(robot->hasEnded()) << robot->output();
  EXPECT_EQ(robot->end(SIGKILL), 128 + SIGKILL);
  ASSERT_TRUE(waitUntil([&] { return live->output().find("no images") != std::string::npos; }))
      << live->output();
  const int last = tracked().back();
  robot = startRobot(1000.0);
  EXPECT_TRUE(waitUntil([&] { return tracked().back() > last + 1; })) << live->output();
  EXPECT_EQ(live->end(SIGKILL), 128 + SIGKILL);
  live = std::make_unique<LiveProgram>(arguments, folder_.path().string(), domain_);
  EXPECT_TRUE(waitUntil([&] { return tracked().size() >= 2; })) << live->output();
  EXPECT_FALSE(robot->hasEnded()) << robot->output();
  EXPECT_EQ(live->end(SIGTERM), 0) << live->output();
}

TEST_F(LiveRos2Test, ARecordingIsPublishedWithItsClockBesideATopic) {
  std::ofstream(folder_ / "rawlog.ini")
      << "[CAM]\ndriver = CCameraSensor\ngrabber_type = rawlog\nrawlog_file = " << streetRawlog()
      << "\nprocess_rate = 8\npose_z = 1.65\npose_yaw = -90\npose_roll = -90\n";
  std::atomic<std::size_t> clocks{0};
  const auto clock = peer_.reader<rosgraph_msgs::msg::dds_::Clock_PubSubType>(
      "rt/clock", {}, [&](const auto& message) {
        if (message.clock().sec() < 1'750'000'000) ++clocks;  // of the recording, not of the wheels
      });
  const auto wheels = peer_.writer<nav_msgs::msg::dds_::Odometry_PubSubType>("rt/odom");
  nav_msgs::msg::dds_::Odometry_ standing;
  standing.pose().pose().orientation().w(1.0);
  Audience audience(peer_);
  LiveProgram live(
      "--sensors " + std::string(folder_ / "rawlog.ini") + " --ros2 " +
          ini("[ros2]\nodometry = /odom\n[ros2_publish]\nclock = true\nodom_base = true\n") +
          " --ros2-interface lo -w -o " + out(),
      folder_.path().string(), domain_);
  EXPECT_TRUE(waitUntil([&] {
    (void)wheels->write(&standing);
    return audience.isHealthy("headway: sensor /odom");
  })) << live.output();
  EXPECT_FALSE(audience.isHealthy("headway: sensor /odom: error"));
  EXPECT_TRUE(waitUntil([&] {  // the wheels have fallen silent
    return clocks > 5 && audience.count("/tf") > 5 && audience.count("/headway/markers") > 5 &&
           audience.isHealthy("headway: sensor CAM") &&
           audience.isHealthy("headway: sensor /odom: error");
  })) << live.output();
  EXPECT_FALSE(audience.isHealthy("headway: sensor CAM: error"));
  EXPECT_EQ(live.end(SIGTERM), 0) << live.output();
}

TEST_F(LiveRos2Test, ADepthCameraIsFollowedByItsTopics) {
  const std::string rawlog = folder_ / "hall.rawlog";
  const auto simulated =
      test::runProcess(test::program("headway-sim") + " -q -c " + std::string(HEADWAY_SOURCE_DIR) +
                       "/config/worlds/hall.ini --rig rgbd --frames 60 -o " + rawlog);
  ASSERT_EQ(simulated.status, 0) << simulated.output;
  test::Robot robot(peer_, rawlog);
  const test::Results results(peer_);
  robot.on_frame = [&](Time time) { results.await(time); };
  LiveProgram live("-q --color /color/image --depth /depth/image --ros2-interface lo -o " + out(),
                   folder_.path().string(), domain_);
  ASSERT_TRUE(waitUntil([&] { return robot.isWatched(); })) << live.output();
  EXPECT_EQ(robot.play(1.0, stop_), 60U);
  EXPECT_TRUE(waitUntil([&] { return results.stamps().size() > 30; })) << live.output();
  EXPECT_EQ(live.end(SIGTERM), 0) << live.output();
  const auto summary = nlohmann::json::parse(std::ifstream(out() + "/summary.json"));
  EXPECT_GT(summary["frames_tracked"], 30);
  EXPECT_EQ(summary["frames_tracked"], summary["frames"]);
  EXPECT_TRUE(summary["calibration"]["depth_camera"]);
  // Quiet, it still says what loses images.
  EXPECT_EQ(live.output().find("sudo sysctl -w net.core.rmem_max=") != std::string::npos,
            test::hasSmallReceiveBuffers())
      << live.output();
  EXPECT_THAT(live.output(), Not(HasSubstr("ROS 2 domain")));
}

/// With an inertial sensor, wheels that are the odometry of others, and a laser.
TEST_F(LiveRos2Test, ARobotsOwnOdometryIsCorrectedBetweenFramesToo) {
  constexpr std::size_t kFrames = 35;
  const std::string rawlog = folder_ / "hall.rawlog";
  const auto simulated = test::runProcess(
      test::program("headway-sim") + " -q -c " + std::string(HEADWAY_SOURCE_DIR) +
      "/config/worlds/hall.ini --seed 61 --rig robot --frames " + std::to_string(kFrames) + " -o " +
      rawlog +
      " --set recording.storage=embedded --set camera.width=376 --set camera.height=240 --set "
      "camera.focal_px=205 --set camera.rate_hz=10 --set camera.imu=true --set "
      "camera.odometry=true --set laser.enabled=true");
  ASSERT_EQ(simulated.status, 0) << simulated.output;
  test::Robot robot(peer_, rawlog);
  Audience audience(peer_);
  robot.on_frame = [&](Time time) {  // no machine is too slow
    for (int poll = 0; poll < 50 && !audience.hasFrame(time); ++poll) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  };
  LiveProgram live("--ros2 --ros2-interface lo -w -o " + out(), folder_.path().string(), domain_);
  ASSERT_TRUE(waitUntil([&] { return robot.isWatched(); })) << live.output();
  EXPECT_EQ(robot.play(1.0, stop_), kFrames);
  EXPECT_TRUE(waitUntil([&] {
    return audience.isHealthy("headway: sensor /imu") &&
           audience.isHealthy("headway: sensor /odom") &&
           audience.isHealthy("headway: sensor /scan");
  })) << live.output();
  EXPECT_EQ(live.end(SIGTERM), 0) << live.output();
  audience.close();

  const auto summary = nlohmann::json::parse(std::ifstream(out() + "/summary.json"));
  EXPECT_GT(summary["laser"]["used"], 0) << summary["laser"];

  // The pose in the map by the corrected odometry of the robot, by headway's, and the true one.
  std::vector<Stamped<Pose>> truth;
  std::ifstream rows(folder_ / "hall.truth/trajectory.tum");
  for (std::string row; std::getline(rows, row);) {
    std::istringstream fields(row);
    Stamped<Pose> pose{0.0, Pose::Identity()};
    Eigen::Quaterniond q;
    auto place = pose.value.translation();
    if (!(fields >> pose.time >> place.x() >> place.y() >> place.z())) continue;
    fields >> q.x() >> q.y() >> q.z() >> q.w();
    pose.value.linear() = q.toRotationMatrix();
    truth.push_back(pose);
  }
  auto& transforms = audience.transforms_;
  std::size_t compared = 0;
  double difference_m = 0.0, error_m = 0.0;
  for (const auto& [time, T_map_odom] : transforms["map>odom"]) {
    const auto T_odom_robot = poseAt(transforms["odom>base_link"], time);
    const auto T_map_own = poseAt(transforms["map>headway_odom"], time);
    const auto T_own_robot = poseAt(audience.odometry_, time);
    const auto T_map_true = poseAt(truth, time);
    if (!T_odom_robot || !T_map_own || !T_own_robot || !T_map_true) continue;
    ++compared;
    const Eigen::Vector3d place = (T_map_odom * *T_odom_robot).translation();
    difference_m =
        std::max(difference_m, (place - (*T_map_own * *T_own_robot).translation()).norm());
    error_m = std::max(error_m, (place - T_map_true->translation()).norm());
  }
  EXPECT_GT(compared, 2 * kFrames);
  EXPECT_LT(difference_m, 0.03);
  EXPECT_LT(error_m, 0.1);
  EXPECT_GT(truth.back().value.translation().norm(), 0.8);                 // it drives
  EXPECT_LE(transforms["odom>base_link"].size(), robot.sent().at("/tf"));  // headway sends none
  // At 30 Hz or more, without a gap of an image.
  const auto& stamps = audience.stamps_;
  ASSERT_GT(stamps.size(), kFrames);
  EXPECT_GE(static_cast<double>(stamps.size() - 1), 30.0 * (stamps.back() - stamps.front()));
  double gap_s = 0.0;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    gap_s = std::max(gap_s, stamps[i] - stamps[i - 1]);
  }
  EXPECT_LT(gap_s, 0.099);
  std::printf("%zu poses, %.1f Hz, difference %.4f m, error %.3f m, gap %.3f s\n", compared,
              static_cast<double>(stamps.size() - 1) / (stamps.back() - stamps.front()),
              difference_m, error_m, gap_s);
}

TEST_F(LiveRos2Test, ALoadedMapIsSearchedFirstAroundTheInitialPose) {
  const test::TexturedWorld corridor = test::repeatedCorridor();
  const auto record = [&](const std::string& path, double start_m, double step_m, int frames) {
    io::RawlogSink sink(path, io::ImageStorage::kEmbedded);
    for (int i = 0; i < frames; ++i) {
      Pose pose = Pose::Identity();
      pose.translation().x() = start_m + step_m * i;
      const auto frame = corridor.frame(static_cast<std::size_t>(i), 0.0, pose);
      sink.writeStereo(100.0 + 0.1 * i, frame.left, frame.right, io::rawFrom(*corridor.camera()));
    }
    sink.close();
  };
  record(folder_ / "drive.rawlog", 0.0, 0.15, 110);
  record(folder_ / "again.rawlog", 0.5, 0.01, 60);
  const auto mapped = test::runProcess(test::program("headway-replay") + " -q -i " +
                                       std::string(folder_ / "drive.rawlog") + " -o " +
                                       std::string(folder_ / "first"));
  ASSERT_EQ(mapped.status, 0) << mapped.output;
  test::Robot robot(peer_, folder_ / "again.rawlog");
  const auto initial = peer_.writer<geometry_msgs::msg::dds_::PoseWithCovarianceStamped_PubSubType>(
      "rt/initialpose");
  const std::string arguments =
      "--ros2 --left /left/image --right /right/image --ros2-interface "
      "lo -w -o " +
      out() + " --load-map " + std::string(folder_ / "first/map.headway");
  const auto placeOf = [&](const std::string& option, bool is_message) {
    std::filesystem::remove_all(out());
    LiveProgram live(arguments + option, folder_.path().string(), domain_);
    EXPECT_TRUE(waitUntil([&] { return robot.isWatched() && initial->matched() > 0; }));
    geometry_msgs::msg::dds_::PoseWithCovarianceStamped_ place;
    place.header().frame_id("map");
    place.pose().pose().position().x(test::kCorridorRepeat_m + 1.0);
    place.pose().pose().orientation().w(1.0);
    EXPECT_TRUE(!is_message || initial->write(&place));
    const test::Results results(peer_);
    robot.on_frame = [&](Time time) { results.await(time); };
    (void)robot.play(2.0, stop_);
    EXPECT_EQ(live.end(SIGTERM), 0) << live.output();
    EXPECT_TRUE(waitUntil([&] { return !robot.isWatched() && initial->matched() == 0; }));
    std::ifstream rows(out() + "/trajectory_online.tum");
    double place_m = std::nan("");
    for (std::string row; std::getline(rows, row);) {
      Time time = 0.0;
      std::istringstream(row) >> time >> place_m;
    }
    return place_m;
  };
  EXPECT_NEAR(placeOf(" --initial-pose 1,0,0", false), 1.0, 0.3);
  EXPECT_NEAR(placeOf(" --initial-pose 11,0,0", false), test::kCorridorRepeat_m + 1.0, 0.3);
  EXPECT_NEAR(placeOf("", true), test::kCorridorRepeat_m + 1.0, 0.3);
}

TEST_F(LiveRos2Test, TheTrajectoryIsAsGoodAsThatOfAReplay) {
  const std::string rawlog = std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/hall_loop";
  const auto errorOf = [&](const std::string& folder) {
    const auto run = test::runProcess(test::program("headway-eval") + " trajectory -q -w --truth " +
                                      rawlog + ".truth/trajectory.tum --estimate " + folder +
                                      "/trajectory.tum --json " + folder + "/error.json");
    EXPECT_EQ(run.status, 0) << run.output;
    return nlohmann::json::parse(std::ifstream(folder + "/error.json"))["ate_rmse_m"].get<double>();
  };
  const auto replay = test::runProcess(test::program("headway-replay") + " -q -i " + rawlog +
                                       ".rawlog -o " + std::string(folder_ / "replay"));
  ASSERT_EQ(replay.status, 0) << replay.output;
  test::Robot robot(peer_, rawlog + ".rawlog");
  const test::Results results(peer_);
  robot.on_frame = [&](Time time) { results.await(time); };
  LiveProgram live("--ros2 --left /left/image --right /right/image --ros2-interface lo -o " + out(),
                   folder_.path().string(), domain_);
  ASSERT_TRUE(waitUntil([&] { return robot.isWatched(); })) << live.output();
  EXPECT_EQ(robot.play(1.0, stop_), 330U);
  EXPECT_EQ(live.end(SIGTERM), 0) << live.output();
  EXPECT_GT(results.stamps().size(), 320U);  // the first ones came before both sides had met
  EXPECT_LT(errorOf(out()), 1.1 * errorOf(folder_ / "replay"));
}

TEST_F(LiveRos2Test, ListsTopicsAndNamesMistakes) {
  test::Robot robot(peer_, streetRawlog());
  const auto run = [&](const std::string& arguments) {
    return test::runProcess("ROS_DOMAIN_ID=" + std::to_string(domain_) + " " +
                            test::program("headway-live") + " " + arguments);
  };
  const auto list =
      run("--ros2 " HEADWAY_SOURCE_DIR "/config/ros2.ini --ros2-list --ros2-interface lo");
  EXPECT_EQ(list.status, 0) << list.output;
  EXPECT_THAT(list.output, HasSubstr("/left/image  sensor_msgs/Image  1 publisher, reliable"));
  EXPECT_THAT(list.output, HasSubstr("<- left image"));
  EXPECT_THAT(list.output, Not(HasSubstr("Cyclone DDS:")));  // has nothing to warn of
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
