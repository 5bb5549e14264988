// SPDX-License-Identifier: BSD-3-Clause
// Plays a rawlog as a robot's topics and measures how late the results come. With --alone, without
// headway-live beside it, it measures how long an image takes to a node of this process.
#include <headway/core/recorded_frame.h>
#include <headway/core/statistics.h>
#include <headway/program/command_line.h>
#include <headway/ros2/node.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <thread>

#include "messages.h"
#include "robot.h"

namespace {

using namespace headway;

struct BenchOptions {
  std::string rawlog;
  int domain = 0;
  int laps = 1;
  test::Part lap;
  bool is_alone = false;
  bool is_compressed = false;
};

/// Times from before a frame's images are sent to something with its stamp.
class Delays {
 public:
  void sent(Time stamp) {
    const std::lock_guard lock(mutex_);
    sent_[test::Results::keyOf(stamp)] = {monotonicSeconds(), std::nullopt};
  }
  void received(Time stamp) {
    const double now_s = monotonicSeconds();
    const std::lock_guard lock(mutex_);
    const auto found = sent_.find(test::Results::keyOf(stamp));
    if (found != sent_.end()) found->second.delay_ms = 1e3 * (now_s - found->second.sent_s);
  }
  /// Of images since the first that arrived: both sides had met then.
  void print(const char* what) {
    const std::lock_guard lock(mutex_);
    std::vector<double> delays_ms;
    std::size_t images = 0;
    for (const auto& [key, image] : sent_) {
      if (image.delay_ms) delays_ms.push_back(*image.delay_ms);
      if (!delays_ms.empty()) ++images;
    }
    std::sort(delays_ms.begin(), delays_ms.end());
    const auto at = [&](double ratio) {
      if (delays_ms.empty()) return std::nan("");
      const auto last = static_cast<double>(delays_ms.size() - 1);
      return delays_ms[static_cast<std::size_t>(ratio * last)];
    };
    std::printf("%s: %zu of %zu images, p50 %.2f ms, p95 %.2f ms, p99 %.2f ms\n", what,
                delays_ms.size(), images, at(0.5), at(0.95), at(0.99));
    std::fflush(stdout);
  }

 private:
  struct Image {
    double sent_s = 0.0;
    std::optional<double> delay_ms;
  };
  std::mutex mutex_;
  std::map<long, Image> sent_;
};

template <typename Header>
Time timeOf(const Header& header) {
  return header.stamp().sec() + 1e-9 * header.stamp().nanosec();
}

/// A node of this process that receives images.
class Listener {
 public:
  Listener(const BenchOptions& options, Delays& transport)
      : node_({"bench", options.domain, "lo"}) {
    std::printf("%s\n", node_.network().c_str());
    const std::string suffix = options.is_compressed ? "/compressed" : "";
    const std::string type =
        options.is_compressed ? "sensor_msgs/CompressedImage" : "sensor_msgs/Image";
    const auto time = [&](std::string_view message) {
      const auto header = bags::decodeHeader(message, bags::Encoding::kCdr);
      transport.received(1e-9 * static_cast<double>(header.time_ns));
    };
    const auto leave = [](std::string_view) {};
    node_.subscribe("/left/image" + suffix, type, {}, leave);
    node_.subscribe("/right/image" + suffix, type, {}, time);
    node_.subscribe("/color/image", type, {}, leave);
    node_.subscribe("/depth/image", type, {}, time);
    thread_ = std::thread([this] {
      while (!stop_) node_.spin(0.05);
    });
  }
  ~Listener() {
    stop_ = true;
    thread_.join();
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

 private:
  ros2::Node node_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// Subscribers of everything that headway publishes.
class Audience {
 public:
  Audience(test::FastDdsPeer& peer, Delays& obstacles, Delays& odometry) {
    using namespace nav_msgs::msg::dds_;
    using namespace sensor_msgs::msg::dds_;
    const auto leave = [](const auto&) {};
    keep(peer.reader<PointCloud2_PubSubType>(
        "rt/headway/obstacles", {true, false, 100},
        [&](const auto& message) { obstacles.received(timeOf(message.header())); }));
    keep(peer.reader<Odometry_PubSubType>(
        "rt/headway/odometry", {true, false, 1000},
        [&](const auto& message) { odometry.received(timeOf(message.header())); }));
    keep(peer.reader<OccupancyGrid_PubSubType>("rt/map", {true, true, 1}, leave));
    for (const char* name :
         {"local_costmap", "predicted_500ms", "predicted_1000ms", "predicted_1500ms",
          "predicted_2000ms", "predicted_2500ms", "predicted_3000ms"}) {
      keep(peer.reader<OccupancyGrid_PubSubType>(std::string("rt/headway/") + name, {}, leave));
    }
    keep(peer.reader<PointCloud2_PubSubType>("rt/headway/dense_map", {}, leave));
    keep(peer.reader<vision_msgs::msg::dds_::Detection3DArray_PubSubType>("rt/headway/detections",
                                                                          {}, leave));
    keep(peer.reader<nav2_dynamic_msgs::msg::dds_::ObstacleArray_PubSubType>(
        "rt/headway/moving_obstacles", {}, leave));
    keep(peer.reader<visualization_msgs::msg::dds_::MarkerArray_PubSubType>("rt/headway/markers",
                                                                            {}, leave));
    keep(peer.reader<diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType>("rt/diagnostics", {},
                                                                             leave));
    keep(
        peer.reader<tf2_msgs::msg::dds_::TFMessage_PubSubType>("rt/tf", {true, false, 100}, leave));
  }

 private:
  void keep(std::unique_ptr<test::FastDdsPeer::Reader> reader) {
    readers_.push_back(std::move(reader));
  }
  std::vector<std::unique_ptr<test::FastDdsPeer::Reader>> readers_;
};

void play(const BenchOptions& options) {
  test::FastDdsPeer peer(options.domain);
  Delays transport, obstacles, odometry;
  std::optional<Listener> listener;
  std::optional<Audience> audience;
  if (options.is_alone) listener.emplace(options, transport);
  if (!options.is_alone) audience.emplace(peer, obstacles, odometry);
  test::Robot robot(peer, options.rawlog, options.is_compressed);
  std::vector<Time> times;
  robot.before_frame = [&](Time stamp) {
    times.push_back(stamp);
    for (Delays* delays : {&transport, &obstacles, &odometry}) delays->sent(stamp);
  };
  while (!robot.isWatched()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const std::atomic<bool> stop{false};
  test::Part lap = options.lap;
  double lap_s = 0.0;
  for (int i = 0; i < options.laps; ++i) {
    const std::size_t frames = robot.play(1.0, stop, lap);
    if (i == 0 && frames > 1) {  // the next one begins a frame later
      lap_s = (times.back() - times.front()) * static_cast<double>(frames) /
              static_cast<double>(frames - 1);
    }
    lap.shift_s += lap_s;
  }
  std::this_thread::sleep_for(std::chrono::seconds(1));
  for (const auto& [topic, count] : robot.sent()) std::printf("%s %zu, ", topic.c_str(), count);
  std::printf("%zu frames\n", times.size());
  if (options.is_alone) return transport.print("image to node");
  obstacles.print("image to obstacles");
  odometry.print("image to odometry");
}

int runBench(int argc, const char* const* argv) {
  BenchOptions options;
  int first = 0, end = 0;
  program::CommandLine line("bench_ros2", "Plays a rawlog as a robot's topics of ROS 2.");
  line.option(options.rawlog, 'i', "input", "RAWLOG", "with its images inside", true);
  line.option(options.domain, 0, "domain", "N", "domain of DDS");
  line.option(options.laps, 0, "laps", "N", "how often it is played");
  line.option(first, 0, "first", "N", "first frame of a lap");
  line.option(end, 0, "end", "N", "frame behind its last one; 0: that of the rawlog");
  line.option(options.lap.shift_s, 0, "shift", "S", "added to all times [s]");
  line.flag(options.is_alone, 0, "alone", "measure the transport alone");
  line.flag(options.is_compressed, 0, "compressed", "send stereo images as JPEG");
  if (!line.parse(argc, argv)) return program::kDone;
  if (first < 0 || end < 0) throw program::UsageError("--first and --end must not be negative");
  options.lap.first = static_cast<std::size_t>(first);
  if (end > 0) options.lap.end = static_cast<std::size_t>(end);
  play(options);
  return program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return headway::program::run("bench_ros2", [&] { return runBench(argc, argv); });
}
